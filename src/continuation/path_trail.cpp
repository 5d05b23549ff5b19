#include "continuation/path_trail.hpp"

#include <algorithm>
#include <cassert>

#include "continuation/path_follower.hpp"
#include "orbit/mesh_adaptation.hpp"

namespace tchat {

namespace {

void copy(const PathPoint& point, const std::vector<int>& free, PathTrail::Mark& mark) {
  mark.place.states = point.orbit.states;
  mark.place.durations.resize(point.tangent.durations.size());
  mark.place.globals.resize(point.tangent.globals.size());
  for (int s = 0; s < point.orbit.shape.segments; ++s) mark.place.durations(s) = point.orbit.duration(s);
  for (std::size_t g = 0; g < free.size(); ++g)
    mark.place.globals(static_cast<Eigen::Index>(g)) = point.orbit.par(free[g] - 1);
  mark.tangent.states = point.tangent.states;
  mark.tangent.durations = point.tangent.durations;
  mark.tangent.globals = point.tangent.globals;
}

}  // namespace

PathTrail::PathTrail(const OrbitShape& shape, int global_count) : mesh_(index(shape.mesh_points())) {
  const OrbitVector zero(shape, global_count);
  for (const std::size_t k : {0U, 1U}) own_[k] = std::make_shared<Mark>(Mark{zero, zero});
}

/// Space is not shared.
PathTrail::PathTrail(const PathTrail& other) : marks_(other.marks_), count_(other.count_), mesh_(other.mesh_) {
  for (const std::size_t k : {0U, 1U})
    if (other.own_[k]) own_[k] = std::make_shared<Mark>(*other.own_[k]);
}

PathTrail& PathTrail::operator=(const PathTrail& other) {
  if (this == &other) return *this;
  marks_ = other.marks_;
  count_ = other.count_;
  mesh_ = other.mesh_;
  return *this;
}

std::shared_ptr<PathTrail::Mark> PathTrail::unused_mark() {
  const auto unused = [](const std::shared_ptr<Mark>& mark) { return mark == nullptr || mark.use_count() == 1; };
  const auto found = std::find_if(own_.begin(), own_.end(), unused);
  std::shared_ptr<Mark>& mark = found != own_.end() ? *found : own_.front();
  if (found == own_.end() || mark == nullptr) mark = std::make_shared<Mark>();
  return mark;
}

void PathTrail::clear() {
  marks_.fill(nullptr);
  count_ = 0;
}

void PathTrail::follow(const PathPoint& from, const std::vector<int>& free_parameters) {
  assert(this != &from.trail);
  mesh_ = from.orbit.mesh;
  marks_.fill(nullptr);
  count_ = from.trail.mesh_ == from.orbit.mesh ? std::min(from.trail.count_ + 1, most) : 1;
  std::copy_n(from.trail.marks_.begin(), count_ - 1, marks_.begin() + 1);
  const std::shared_ptr<Mark> newest = unused_mark();
  copy(from, free_parameters, *newest);
  marks_.front() = newest;
}

void PathTrail::add(const PathPoint& point, const std::vector<int>& free_parameters) {
  if (count_ > 0 && mesh_ != point.orbit.mesh) clear();
  mesh_ = point.orbit.mesh;
  count_ = std::min(count_ + 1, most);
  std::copy_backward(marks_.begin(), marks_.begin() + count_ - 1, marks_.begin() + count_);
  const std::shared_ptr<Mark> newest = unused_mark();
  copy(point, free_parameters, *newest);
  marks_.front() = newest;
}

void PathTrail::change_mesh(const std::vector<double>& mesh, const MeshTransfer& transfer) {
  for (int k = 0; k < count_; ++k) {
    const std::shared_ptr<Mark> moved = unused_mark();
    const Mark& old = mark(k);
    transfer(old.place.states, moved->place.states);
    transfer(old.tangent.states, moved->tangent.states);
    moved->place.durations = old.place.durations;
    moved->place.globals = old.place.globals;
    moved->tangent.durations = old.tangent.durations;
    moved->tangent.globals = old.tangent.globals;
    marks_[index(k)] = moved;
  }
  mesh_ = mesh;
}

}  // namespace tchat
