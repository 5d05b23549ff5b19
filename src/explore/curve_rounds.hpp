/// Curves in two parameters, after the diagram over one: every special point with a curve is followed in both
/// directions in the rectangle, unless a curve that is there passes through it. Those without are listed with the
/// reason. At grazing points with xi_n = 0 the orbits with one impact in n returns are followed over the first
/// parameter, on both sides along the grazing curve; their special points have curves, too. A contact on a curve has
/// its grazing curve. At points of codimension two the curves that begin there are followed, and both Hopf curves
/// through HH.
///
/// Rounds of jobs, as in explorer.hpp.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "explore/curve_catalogue.hpp"
#include "explore/explored_diagram.hpp"
#include "run/run_remarks.hpp"

namespace tchat {

class CurveRounds {
 public:
  /// What an exploration is asked and has. All must outlive this.
  struct Context {
    const ExploreRequest& request;
    const ExplorationCommands& commands;
    const HybridSystem& system;
    JobRunner& runner;
    ExploredDiagram& diagram;  ///< the curves found are entered at its labels
    std::function<bool()> goes_on;
    std::function<void(const std::string&)> show;
    std::function<std::string()> next_name;  ///< of a branch
  };
  /// `par`: those of the diagram over one. Throws UserError as CurveCommands does.
  CurveRounds(const Context& context, const ParameterVector& par);

  void follow();
  const ExploredCurves& curves() const { return curves_; }

 private:
  /// A label with its orbit.
  struct Labelled {
    int label = 0;
    std::string type;
    NextStart start;
    std::vector<int> xi_zeros;
    double first = 0.0, second = 0.0;
    CurvePoint point;
    bool is_admissible = true;
    bool is_section_tangent = false;
  };
  /// A job with what it is to find: a curve, or a slice.
  struct Candidate {
    bool is_slice = false;
    std::function<CommandJob(const std::string&)> make;  ///< its job, for files of this name
    ExploredCurve curve;
    ExploredBranch slice;
    CurvePoint start;       ///< of a curve
    std::string owner;      ///< the branch, slice or curve that it is from
    int label = 0;          ///< of the owner
    int returns = 1;        ///< of a slice: one impact in so many
    bool is_alone = false;  ///< then the only one of its kind that may end there
    std::string why_none;   ///< no command follows it
    const CommandJob& job() const { return is_slice ? slice.job : curve.job; }
    const std::string& name() const { return job().name; }
  };
  using Candidates = std::vector<Candidate>;
  struct RunFiles;

  CurveColumns columns() const;
  RunFiles files_of(const std::string& name) const;
  std::vector<Labelled> labels_of(const RunFiles& files) const;
  /// The curve that is there and passes through the start of a candidate; "" without one.
  std::string known_curve(const Candidate& candidate) const;
  std::string curve_that_ends(const Candidate& candidate) const;
  std::string curve_again(const Candidate& candidate, const std::vector<CurveSection>& sections) const;
  void set_curve(const Candidate& candidate, const std::string& curve);

  void add_curves(const ExploredBranch& branch, Candidates& next);
  /// Without its job.
  Candidate candidate_at(const RunFiles& files, const Labelled& label, bool has_returns,
                         const CurveCommand& command) const;
  /// The curve through a label, to `next`, or to those without a command.
  void add_curve(const RunFiles& files, const Labelled& label, bool has_returns, Candidates& next);
  /// Those that begin at a label.
  void add_born_curves(const RunFiles& files, const Labelled& label, bool has_returns, Candidates& next) const;
  void add_slices(const ExploredCurve& curve, const Labelled& label, Candidates& next) const;
  void name(Candidate& candidate);
  Candidates run(const Candidates& round);
  bool is_left();
  void take_curve(const Candidate& candidate, Candidates& next);
  void take_slice(const Candidate& candidate, Candidates& next);
  void describe(ExploredCurve& curve) const;
  CurveEnd end_of(const ExploredCurve& curve, const PointSection& section, const std::string& stopped) const;
  /// Labels that no command follows may be on a curve nevertheless.
  void settle_unfollowed();
  void join();
  void name_label(const JoinedPoint& joint, JoinedCurve& member) const;
  bool is_at(const JoinedPoint& joint, double first, double second) const;
  void join_label(const ExploredCurve& curve, const CurveSection& section, std::size_t point);

  Context context_;
  CurveCommands commands_;
  CurveCatalogue catalogue_;
  ExploredCurves curves_;
  Candidates unfollowed_;
  int named_ = 0;  // curves that have a name
};

}  // namespace tchat
