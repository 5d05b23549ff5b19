/// Hands the points of a branch to its outputs, and summarises the branch at the end of the run.
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "continuation/branch.hpp"
#include "files/point_file.hpp"
#include "files/run_files.hpp"
#include "run/branch_output.hpp"

namespace tchat {

// Hands a branch to its outputs as it grows: numbers and names its labels, computes the columns of its points.

class BranchWriter final : public BranchSink {
 public:
  struct Setup {
    RunSettings settings;
    std::vector<int> active_parameters;
    int curve_type = 0;  ///< tens digit of type numbers on two-parameter curves
    int last_label = 0;
    Eigen::VectorXd units = {};            ///< of the states of points, in those of `system`; none: all are 1
    Eigen::VectorXd parameter_sizes = {};  ///< of PAR(1), ..., as far as they are known: HybridSystem::parameter_size()
  };

  /// Arguments: see branch_outputs().
  BranchWriter(const HybridSystem& system, const CollocationRule& rule, const Setup& setup, RunFiles& files,
               std::ostream* screen, std::ostream* terminal = nullptr);
  BranchWriter(const BranchWriter&) = delete;
  BranchWriter& operator=(const BranchWriter&) = delete;
  ~BranchWriter() override = default;

  /// Points that follow belong to a section of their own, number `branch`, in the direction of `step` (DS).
  /// `correction` are the iterations that led to its first point.
  void begin_section(int branch, double step, std::vector<NewtonIteration> correction);
  /// Records why the section has no further points, and ends it.
  void end_section(const BranchSummary& summary);
  void point(const BranchPoint& point) override;
  void next_step(int point_number, double ds) override;
  void note(int point_number, const std::string& text) override;
  void starts_at_zero(const std::string& name) override;
  void passed(const LostPoint& point) override;
  void lost(const LostPoint& point) override;
  /// From this point the branch is continued with a finer mesh, or could not be.
  void mesh_changed(int point_number, double parameter, const std::string& text);

  struct Labelled {
    int label;
    std::string type;
    std::string place;  ///< "alpha = 3.1", with the other free parameters that are no durations
    std::string description;
    int number = 0;  ///< of the type, without the tens digit of a curve
    UserPointKind kind = {};
  };
  /// The labels written so far, in order.
  const std::vector<Labelled>& labels() const { return labels_; }

 private:
  ParameterVector output_parameters(const Orbit& x) const;
  void find_column_values(const BranchPoint& point);
  double column_value(const PointColumn& column, const BranchPoint& point) const;
  std::string place(const PointLine& line) const;
  double shown_value(const PointLine& line, std::size_t column) const;
  void write(const BranchPoint& point);
  bool shown_stable(const BranchPoint& point);
  void report_unknown_user_values(const PointLine& line);
  void show_message(const std::string& text);
  std::string principal_name() const { return shown_name(section_.columns.front()); }

  const CollocationRule& rule_;
  PointLine line_;                   // of the last point
  PointLine shown_ = {};             // with 0 for what is rounding of it
  std::vector<double> user_values_;  // its user functions
  RunFiles& files_;
  BranchSection section_;
  std::vector<std::unique_ptr<BranchOutput>> outputs_;
  Eigen::VectorXd weights_;
  std::vector<Labelled> labels_;
  int last_label_;
  Eigen::VectorXd units_;
  bool last_stable_ = false;
  Eigen::VectorXd parameter_sizes_;
  std::vector<double> largest_values_;  // of each column, so far
  std::set<int> reported_user_functions_;
};

/// "bound", "points", "closed", ...: the reason in d-files, and in what reads them.
std::string_view end_word(EndReason reason);

// The paragraph that ends a run: how many points, which are special, why it stopped, how accurate it is.

/// The command that most users give next at a label, or "".
using NextCommand = std::function<std::string(const BranchWriter::Labelled&)>;

/// `output` is O of p.O; `parameter` the name of ICP(1). Several lines, each with its newline. The first label of each
/// type is followed by its next command.
std::string summary_text(const BranchSummary& summary, const std::vector<BranchWriter::Labelled>& labels,
                         const std::string& parameter, const std::string& output, const NextCommand& next);

}  // namespace tchat
