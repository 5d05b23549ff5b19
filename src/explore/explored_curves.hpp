/// What `tchat explore` finds in two parameters: curves of special points, where they end, and the points of
/// codimension two that they have in common.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "explore/explored_diagram.hpp"

namespace tchat {

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
  std::string name;    ///< of its files in the folder
  std::string kind;    ///< LP, PD, ..., GR
  std::string parent;  ///< the branch, slice or curve whose label it is from
  std::string origin;  ///< "PD 3 of a2"
  double first_from = 0.0, first_to = 0.0, second_from = 0.0, second_to = 0.0;
  int points = 0, inadmissible = 0;
  bool has_returns = false;  ///< from a slice, or a branch that has
  std::vector<std::string> signatures;
  std::vector<CurveEnd> ends;
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
  std::map<std::string, std::vector<std::string>> without;  ///< by reason, labels that no curve follows: "BP 2 of a1"
  std::vector<std::string> again;                           ///< "a2_LP4_curve: a1_LP3_curve again"
  std::vector<std::string> failures;                        ///< commands that failed, with their last message
  int left = 0;                                             ///< curves and slices beyond the budget
  int budget = 0;
};

/// "alpha 1 to 5, omega 1.4 to 2.4"
std::string range_text(const ExploredCurves& all, const ExploredCurve& curve);

/// Curves, slices and codimension-two points, for people; "" where no second parameter was asked for.
std::string curves_text(const ExploredCurves& curves);
/// The same as members of an object in JSON, each with a comma and a newline before it; "" likewise.
std::string curves_json(const ExploredCurves& curves);
/// All jobs that made files of curves and slices.
std::vector<const CommandJob*> curve_jobs(const ExploredCurves& curves);

}  // namespace tchat
