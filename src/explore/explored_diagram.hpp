/// The results of `tchat explore`: branches, and curves in two parameters.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "explore/exploration_commands.hpp"
#include "files/diagnostics_file.hpp"
#include "files/point_file_reader.hpp"
#include "files/table_writer.hpp"

namespace tchat {

// Lists in JSON.

/// `text` gives the JSON of an element.
template <class List, class Text>
std::string json_list(const List& list, const Text& text) {
  std::string result;
  for (const auto& one : list) result += (result.empty() ? "" : ", ") + text(one);
  return "[" + result + "]";
}

inline std::string json_list(const std::vector<std::string>& texts) {
  return json_list(texts, [](const std::string& text) { return json_value(text); });
}

// What `tchat explore` finds: branches with what each came from, orbits that lead to branches that are there, what is
// left, and how much of a sweep lies on branches.

/// A labelled point of a branch.
struct ExploredLabel {
  int label = 0;
  std::string type;  ///< GR, PD, ...
  double parameter = 0.0;
  std::string leads_to;  ///< the branch that the switch there follows; "" without one
  std::string remark;    ///< why there is none, where one was tried or left out
  std::string curve;     ///< the curve in two parameters through it; "" without one
};

struct ExploredBranch {
  std::string name;            ///< of its files in the folder
  std::string parent;          ///< "" for an attractor
  std::string origin;          ///< "attractor 2 at alpha = 3.05", "PD 4"
  std::string mirror_of = {};  ///< a branch whose orbits, reflected, are those of this one; "" where none is known
  int doublings = 0;
  bool has_returns = false;     ///< one impact in several returns to grazing, or from such a branch
  double from = 0.0, to = 0.0;  ///< range of the parameter
  int points = 0, inadmissible = 0;
  std::vector<std::string> signatures;
  std::vector<RecordedEnd> ends;   ///< why each direction ended
  std::vector<RecordedLoss> lost;  ///< special points that may be missing
  std::vector<ExploredLabel> labels;
  CommandJob job;
};

/// An attractor of the sweep that lies on no branch.
struct UnexplainedAttractor {
  std::string attractor;  ///< "a3": attractor 3 of the sweep; "s2": of the further starts
  std::string kind;
  double first = 0.0, last = 0.0;  ///< values at which it is
  int count = 0;
  Command command;       ///< that shows it at the first value
  int segments = 0;      ///< of a periodic one: more than --segments are not followed
  std::string leads_to;  ///< the branch that a start on it has led to nevertheless
};

struct ExploredDiagram {
  std::string parameter;
  std::vector<CommandJob> first_jobs;  ///< the sweep
  std::string quantity;                ///< along the picture's y-axis; "": that of tchat plot
  std::vector<CommandJob> last_jobs;   ///< picture and page
  std::vector<ExploredBranch> branches;
  std::vector<std::string> joins;     ///< "b4 (PD 3 of b1 at ...): b2 again"
  std::vector<std::string> failures;  ///< commands that failed, with their messages
  std::vector<UnexplainedAttractor> unexplained;
  int periodic = 0, at_rest = 0, on_branches = 0;  ///< attractors over all values and starts
  int on_several = 0;                              ///< periodic ones that more than one branch may have
  std::map<std::string, int> others;               ///< motions of other kinds: chaotic, ...
  bool complete = true;                            ///< false: interrupted
  std::map<std::string, int> left;  ///< what a budget left: how many labels and attractors were not followed
};

/// The signatures of the sections of a p-file, each once.
std::vector<std::string> signatures_of(const PointFile& points);
/// Sets signatures and range of a branch from its p-file. Points that a clipped run has beyond `range` do not count.
void describe_points(const PointFile& points, const SweptRange& range, ExploredBranch& branch);

/// "GR 2 at 3.035 -> b2"
std::string label_text(const ExploredLabel& label);
std::string branch_json(const ExploredBranch& branch);

/// The tree of branches, coverage and what is left, for people.
std::string tree_text(const ExploredDiagram& diagram);
/// The same as JSON. `further`: members of the object, each with a comma and a newline before it.
std::string tree_json(const ExploredDiagram& diagram, const std::string& further = "");
/// All that make its files, each after those that make its inputs.
std::vector<CommandJob> jobs_of(const ExploredDiagram& diagram);

// What `tchat explore` finds in two parameters: curves of special points, where they end, and the points of
// codimension two that they have in common.

/// A labelled point of a curve.
struct CurveLabel {
  int label = 0;
  std::string type;  ///< CP, R2, XI, GR, ...
  double first = 0.0, second = 0.0;
  std::string detail;                 ///< which functions vanish there
  std::vector<std::string> leads_to;  ///< curves and slices that start there
};

struct CurveEnd {
  double first = 0.0, second = 0.0;
  std::string reason;
};

struct ExploredCurve {
  std::string name;      ///< of its files in the folder
  std::string kind;      ///< LP, PD, ..., GR
  std::string parent;    ///< the branch, slice or curve whose label it is from
  std::string origin;    ///< "PD 3 of b2"
  bool is_born = false;  ///< it begins there, and does not pass through
  double first_from = 0.0, first_to = 0.0, second_from = 0.0, second_to = 0.0;
  int points = 0, inadmissible = 0;
  bool has_returns = false;  ///< from a slice, or a branch that has
  std::vector<std::string> signatures;
  std::vector<CurveEnd> ends;
  std::vector<RecordedLoss> lost;
  std::vector<CurveLabel> labels;
  CommandJob job;
};

/// A curve at a point that it shares with others.
struct JoinedCurve {
  std::string curve;
  int label = 0;  ///< 0 where the curve has none there
  std::string type;
  bool is_end = false;
};
struct JoinedPoint {
  double first = 0.0, second = 0.0;
  std::vector<JoinedCurve> curves;
};

struct ExploredCurves {
  std::string first, second;  ///< names of the parameters; no `second`: no curves were asked for
  std::vector<ExploredCurve> curves;
  std::vector<ExploredBranch> slices;  ///< branches over `first` that start beside a point of a grazing curve
  std::vector<JoinedPoint> joints;
  std::map<std::string, std::vector<std::string>> without;  ///< by reason, labels that no curve follows: "BP 2 of b1"
  std::vector<std::string> again;                           ///< "c4 (LP 4 of b2): c1 again"
  std::vector<std::string> failures;                        ///< commands that failed, with their last message
  int left = 0;                                             ///< curves and slices beyond the budget
  int budget = 0;
};

/// "PD curve from PD 3 of b2", "LP curve born at GPD 4 of c1"
std::string origin_text(const ExploredCurve& curve);
/// "alpha 1 to 5, omega 1.4 to 2.4"
std::string range_text(const ExploredCurves& all, const ExploredCurve& curve);

/// Curves, slices and codimension-two points, for people; "" where no second parameter was asked for.
std::string curves_text(const ExploredCurves& curves);
/// The same as members of an object in JSON, each with a comma and a newline before it; "" likewise.
std::string curves_json(const ExploredCurves& curves);
/// All jobs that made files of curves and slices.
std::vector<const CommandJob*> curve_jobs(const ExploredCurves& curves);

}  // namespace tchat
