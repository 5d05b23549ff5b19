/// Where a branch has come from: the points before a path point, for predictors that use them.
///
/// A trail is a value that belongs to its point. Trial steps that fail leave no trace in it.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "orbit/orbit.hpp"

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
  // Space for the points that this trail adds or moves to another mesh, made when it is needed: the first to be in no
  // trail is the next to be used. Two take turns where two points follow each other by turns; a point that is kept on
  // its old mesh has the moved one's marks twice.
  std::array<std::shared_ptr<Mark>, static_cast<std::size_t>(2 * most + 2)> own_;
  int count_ = 0;
  std::vector<double> mesh_;
};

}  // namespace tchat
