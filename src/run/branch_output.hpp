/// What a run writes of its branch: the p-, q- and d-file and the table on the screen.
#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "continuation/branch.hpp"
#include "files/point_file.hpp"
#include "files/run_files.hpp"

namespace tchat {

// What a run writes of its branch, one class for each format: the p-, q- and d-file and the table on the screen.
//
// BranchWriter gives every point to all outputs in their order. A new format is a class of its own and a line in
// branch_outputs().

/// The part of a branch that continues in one direction.
struct BranchSection {
  const HybridSystem& system;
  RunSettings settings;  ///< with the sign that DS has in this section
  std::vector<int> active_parameters;
  int curve_type = 0;  ///< tens digit of type numbers on two-parameter curves
  int branch = 1;      ///< counts sections
  ProblemNames names;
  std::vector<PointColumn> columns;
  std::vector<NewtonIteration> start_correction = {};  ///< the iterations that led to the first point
};

/// A point of the branch and what all formats show of it.
struct RecordedPoint {
  const BranchPoint& of_branch;
  const PointLine& line;
  const PointLine& shown;           ///< the same for the screen: parameters that are rounding of zero are 0
  std::string unknown_multipliers;  ///< "" when all multipliers are known
};

class BranchOutput {
 public:
  virtual ~BranchOutput() = default;
  /// The section has changed: its points follow, if there are any.
  virtual void begin_section() {}
  virtual void point(const RecordedPoint& point) = 0;
  /// The step that is tried next from the last point.
  virtual void next_step(int /*point_number*/, double /*ds*/) {}
  /// About the point that is being computed, for the record.
  virtual void note(int /*point_number*/, const std::string& /*text*/) {}
  virtual void lost(const LostPoint& /*point*/) {}
  /// For the user to see at once.
  virtual void message(const std::string& /*text*/) {}
  virtual void end_section() {}
  /// Why the section has no further points: a word and a text for people.
  virtual void branch_end(std::string_view /*reason*/, const std::string& /*text*/) {}
};

/// The outputs of a run, in the order in which they get a point. `files` are open. `screen` may be null (quiet);
/// `terminal`, which may be null, shows where the branch is while no line of the table is due. All arguments must
/// outlive the outputs.
std::vector<std::unique_ptr<BranchOutput>> branch_outputs(const BranchSection& section, RunFiles& files,
                                                          std::ostream* screen, std::ostream* terminal);

// The p-, q- and d-file of a run as outputs of its branch.

std::unique_ptr<BranchOutput> point_file_output(const BranchSection& section, RunFiles& files);
std::unique_ptr<BranchOutput> solution_file_output(const BranchSection& section, RunFiles& files);
std::unique_ptr<BranchOutput> diagnostics_file_output(const BranchSection& section, RunFiles& files);

/// `terminal` may be null: nothing shows where the branch is between the lines of the table.
std::unique_ptr<BranchOutput> screen_output(const BranchSection& section, std::ostream& screen, std::ostream* terminal);

}  // namespace tchat
