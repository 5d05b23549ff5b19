/// Known curves in two parameters, and the commands that compute more of them.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "explore/exploration_commands.hpp"
#include "explore/orbit_catalogue.hpp"
#include "files/point_file_reader.hpp"
#include "model/parameter_vector.hpp"

namespace tchat {

// The curves in two parameters that are there, and which of them pass through a point.
//
// A point is a place (P, Q), each in units of its range, with the numbers of its orbit: period, mean and largest value
// of each state; of an equilibrium 0 and twice each state. Two curves of one kind whose points have these in common,
// up to the error of interpolation, are one curve. The numbers do not depend on where an orbit is cut, nor on how
// often. A branch point of an orbit of doubled period is on the curve of period doublings, and the end of a branch
// whose orbits shrink is on that of Hopf bifurcations.

struct CurvePoint {
  Eigen::Vector2d place = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::VectorXd numbers;  ///< period (0 for equilibria), then the monitors that there are, by pairs: mean, largest
  bool has_shrunk = false;  ///< an orbit that is all but an equilibrium
};

/// The points of one direction of a curve.
struct CurveSection {
  std::string curve;
  std::string kind;  ///< LP, PD, ..., GR
  std::vector<CurvePoint> points;
  std::vector<int> labels;  ///< of each point; 0 without
};

/// Which columns of p-files have what a point consists of.
struct CurveColumns {
  std::string second;  ///< the name of Q; P is in the first column
  std::vector<std::string> monitors;
  Eigen::Vector2d widths;  ///< of the ranges of P and Q
};

/// The sections of a p-file. Without a column of Q, in files of branches, the second coordinate of each place is NaN.
std::vector<CurveSection> curve_sections(const std::string& curve, const std::string& kind, const PointFile& file,
                                         const CurveColumns& columns);

class CurveCatalogue {
 public:
  void add(CurveSection section) { sections_.push_back(std::move(section)); }
  const std::vector<CurveSection>& sections() const { return sections_; }

  /// The curve that all of `section` is on but its beginning; "" where there is none.
  std::string curve_of(const CurveSection& section) const;
  /// The curve of this kind through a point; "" where there is none. PD of an orbit is BP of the doubled one.
  std::string curve_at(const std::string& kind, const CurvePoint& point) const;
  /// Names of all curves with the orbit of a point there, or with one that this orbit repeats, or that repeats it,
  /// whatever their kinds.
  std::vector<std::string> curves_through(const CurvePoint& point) const;

 private:
  std::vector<CurveSection> sections_;
};

/// A labelled point of grazing orbits where xi_n = 0.
struct ResonantPoint {
  std::string curve;
  int label = 0;
  int returns = 1;  ///< n
};

class CurveCommands {
 public:
  /// `commands` must outlive this; `par` are the parameters of the diagram over one. Throws UserError where --and has
  /// no range, or not one of a parameter, or one without the value at which the diagram is.
  CurveCommands(const ExploreRequest& request, const ExplorationCommands& commands, const HybridSystem& system,
                const ParameterVector& par);

  /// Of Q; its `parameter` is the name.
  const SweptRange& second() const { return second_; }
  /// Of Q in PAR.
  int second_index() const { return index_; }
  /// The largest n of the points with xi_n = 0 that are used.
  int returns() const { return returns_; }
  /// By the commands of a CurveCommand (run/run_remarks.hpp), from a label of the files `source`, in both directions.
  /// `rests`: of equilibria, which have no monitors.
  CommandJob curve(const std::string& name, const Commands& commands, const std::string& source, bool rests) const;
  /// Beside a point of a grazing curve, in the direction of `sign` along it: orbits with one impact in n returns over
  /// P.
  CommandJob slice(const std::string& name, const ResonantPoint& at, int sign) const;

 private:
  std::string free_parameters(bool rests) const;
  double largest_step() const;
  int most_points() const;

  const ExplorationCommands& commands_;
  int returns_;
  SweptRange second_;
  int index_ = 0;
};

}  // namespace tchat
