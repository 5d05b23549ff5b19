/// Where a branch has come from, and what this says of the next point: a predictor of higher order.
///
/// Near a point A with unit tangent v the branch is the graph y(s) = A + s v + w(s) over its tangent, <v, w> = 0,
/// w(0) = w'(0) = 0. Of an earlier point B with unit tangent t
///
///     s_B = <v, B - A>,    w(s_B) = B - A - s_B v,    w'(s_B) = t / <v, t> - v
///
/// are known without error but that of the points, so that Hermite's interpolation through K of them predicts the point
/// at s = ds with an error of order ds^(2K + 2), in the plane <v, y - A> = ds that Newton's method corrects in. In
/// Newton's form each point adds a term to the prediction along the tangent. The terms are added while they fall; where
/// the first one is no small change of the step, the branch bends too much, and nothing is added.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "bvp/orbit.hpp"

namespace tchat {

struct PathPoint;
class MeshTransfer;

class PathTrail {
 public:
  static constexpr int most = 3;

  PathTrail() = default;
  /// With space for the points that it will add itself; empty.
  PathTrail(const OrbitShape& shape, int global_count);
  PathTrail(const PathTrail& other);
  PathTrail& operator=(const PathTrail& other);
  PathTrail(PathTrail&&) = default;
  PathTrail& operator=(PathTrail&&) = default;
  ~PathTrail() = default;

  bool empty() const { return count_ == 0; }
  void clear();

  /// The trail of a point that was reached from this one: its trail and itself.
  void follow(const PathPoint& from, const std::vector<int>& free_parameters);
  /// The same points, and this one, which lies beside or ahead of the point that the trail belongs to.
  void add(const PathPoint& point, const std::vector<int>& free_parameters);

  /// Moves all points.
  void change_mesh(const std::vector<double>& mesh, const MeshTransfer& transfer);

  /// A point as a vector, and its unit tangent.
  struct Mark {
    OrbitVector place;
    OrbitVector tangent;
  };
  int count() const { return count_; }
  const Mark& mark(int k) const { return *marks_[index(k)]; }  ///< the newest is number 0
  const std::vector<double>& mesh() const { return mesh_; }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  std::shared_ptr<Mark> unused_mark();

  std::array<std::shared_ptr<const Mark>, most> marks_;  // shared with the trails of other points
  // Space for the points that this trail adds: two take turns where two points follow each other by turns. The first
  // to be in no trail is the next to be used.
  std::array<std::shared_ptr<Mark>, 2> own_;
  int count_ = 0;
  std::vector<double> mesh_;
};

/// What the points of a trail change of a prediction, and about how far it then is from the branch (as OrbitChange); 0
/// when there is no term.
struct TrailTerms {
  double change = 0.0;
  double error = 0.0;
};

/// `x` becomes from + ds from.tangent with the terms of from's trail; without a term its states are of no use.
TrailTerms predict(const PathPoint& from, double ds, const std::vector<int>& free_parameters, Orbit& x);

}  // namespace tchat
