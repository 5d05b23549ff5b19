/// Writes a branch as it grows: p-, q- and d-file and the table on the screen.
#pragma once

#include <map>
#include <ostream>
#include <set>
#include <vector>

#include "continuation/branch.hpp"
#include "files/point_columns.hpp"
#include "files/point_file.hpp"
#include "files/run_files.hpp"
#include "setup/progress_line.hpp"

namespace tchat {

class BranchWriter final : public BranchSink {
 public:
  struct Setup {
    RunSettings settings;
    std::vector<int> active_parameters;
    int curve_type = 0;  ///< tens digit of type numbers on two-parameter curves
    int branch = 1;
    int last_label = 0;
  };

  /// `files` are open; `screen` may be null (quiet). `terminal`, which may be null, shows where the branch is while no
  /// line of the table is due.
  BranchWriter(const HybridSystem& system, const CollocationRule& rule, Setup setup, RunFiles& files,
               std::ostream* screen, std::ostream* terminal = nullptr);

  struct Section {
    int branch = 1;                           ///< counts sections that continue in other directions
    double step = 0.0;                        ///< DS, with its sign in this section
    std::vector<NewtonIteration> correction;  ///< how Newton came to the first point
  };
  /// Points that follow belong to a section of their own; its header is written with the first of them, for AUTO's
  /// reader refuses a header without points.
  void begin_section(Section section);
  void point(const BranchPoint& point) override;
  /// Nothing of the line that shows where the branch is stays on the terminal.
  void clear_progress() { progress_.clear(); }
  void next_step(int point_number, double ds) override;
  void note(int point_number, const std::string& text) override;
  void starts_at_zero(const std::string& name) override;
  void passed(const LostPoint& point) override;
  void lost(const LostPoint& point) override;
  /// The branch goes on from this point with a finer mesh, or could not.
  void mesh_changed(int point_number, double parameter, const std::string& text);

  struct Labelled {
    int label;
    std::string type;
    std::string place;  ///< "alpha = 3.1", with the other free parameters that are no durations
    std::string description;
  };
  /// The labels written so far, in order.
  const std::vector<Labelled>& labels() const { return labels_; }
  int last_label() const { return setup_.last_label; }

 private:
  ParameterVector output_parameters(const Orbit& x) const;
  std::vector<double> column_values(const BranchPoint& point) const;
  std::string place(const PointLine& line) const;
  bool shown_stable(const BranchPoint& point);
  void show(const BranchPoint& point, const PointLine& line);
  void show_contact(const BranchPoint& point);
  void report_unknown_user_values(const PointLine& line);
  void write_diagnostics(const BranchPoint& point, const PointLine& line);
  void write_solution(const BranchPoint& point, const PointLine& line);

  const HybridSystem& system_;
  const CollocationRule& rule_;
  Setup setup_;
  RunFiles& files_;
  std::ostream* screen_;
  ProgressLine progress_;
  ProblemNames names_;
  std::vector<PointColumn> columns_;
  Eigen::VectorXd weights_;
  std::vector<Labelled> labels_;
  std::vector<NewtonIteration> start_correction_;  // how Newton came to the section's first point
  std::string header_;                             // of the section, until it is written
  bool has_points_ = false;                        // the section
  bool last_admissible_ = true;
  bool last_stable_ = false;
  bool contact_shown_ = false;
  std::set<int> told_user_functions_;
};

}  // namespace tchat
