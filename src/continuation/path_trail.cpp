#include "continuation/path_trail.hpp"

#include <algorithm>
#include <cmath>

#include "bvp/mesh_adaptation.hpp"
#include "continuation/path_follower.hpp"
#include "linear_algebra/array_kernel.hpp"

namespace tchat {

namespace {

/// Points nearer to each other than this share of the step, or of their distance, tell their own errors.
constexpr double apart = 0.3;
/// Least cosine between the tangents of two points on a graph over one of them.
constexpr double least_cosine = 0.5;
/// The first term may change the step by this share of its length, each further one be this share of the last.
constexpr double falling = 0.5;
/// Terms below this are rounding.
constexpr double negligible_term = 1e-14;

constexpr int most_inputs = 2 * PathTrail::most;
/// A vector as a combination of w and w' at the points of the trail.
using Combination = std::array<double, most_inputs>;

struct Place {
  int mark;
  double s;
  double cosine;  // of the tangents there and here
};

std::size_t entry(int i) { return static_cast<std::size_t>(i); }

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

/// <dual, place - x>.
double distance_along(const OrbitVector& dual, const OrbitVector& place, const Orbit& x, const std::vector<int>& free) {
  double sum =
      array_functions().dot_difference(dual.states.data(), place.states.data(), x.states.data(), dual.states.size());
  for (int s = 0; s < x.shape.segments; ++s) sum += dual.durations(s) * (place.durations(s) - x.duration(s));
  for (std::size_t g = 0; g < free.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    sum += dual.globals(i) * (place.globals(i) - x.par(free[g] - 1));
  }
  return sum;
}

/// The points that can be used, the nearest first; how many.
int useful_places(const PathPoint& from, double ds, const std::vector<int>& free,
                  std::array<Place, PathTrail::most>& places) {
  int count = 0;
  const PathTrail& trail = from.trail;
  for (int k = 0; k < trail.count(); ++k) {
    const double s = distance_along(from.dual, trail.mark(k).place, from.orbit, free);
    const double cosine = dot(from.dual, trail.mark(k).tangent);
    bool useful = std::isfinite(s) && cosine > least_cosine && std::abs(s) > apart * std::abs(ds);
    for (int l = 0; l < count && useful; ++l) {
      const double other = places[entry(l)].s;
      useful = std::abs(s - other) > apart * std::max(std::abs(ds), std::min(std::abs(s), std::abs(other)));
    }
    if (useful) places[entry(count++)] = {k, s, cosine};
  }
  std::sort(places.begin(), places.begin() + count,
            [](const Place& a, const Place& b) { return std::abs(a.s) < std::abs(b.s); });
  return count;
}

/// Has the duration of segment s not changed? One that is kept (durations of boundary values) has no equation for its
/// value, its change is zero: what extrapolation makes of rounding would never be corrected, and grow. It is the only
/// unknown of that kind. The duration of an equilibrium has a value, 0; phases, of smooth segments and of tori, are
/// compared with the point that the step goes from, whatever is predicted; the parameter of an unfolding follows
/// from equations that have values; monitors keep values; parameters that are not free are copied.
bool is_constant(const PathPoint& from, int s) {
  constexpr double no_change = 1e-10;  // along the tangents, of unit length
  bool constant = std::abs(from.tangent.durations(s)) <= no_change;
  for (int k = 0; k < from.trail.count(); ++k)
    constant = constant && std::abs(from.trail.mark(k).tangent.durations(s)) <= no_change;
  return constant;
}

/// The divided differences f[z_0 .. z_i] of w on the nodes 0, 0, s_1, s_1, ...: those of the inputs w(s_1), w'(s_1),
/// ...
void divide_differences(const std::array<Place, PathTrail::most>& places, int count,
                        std::array<Combination, most_inputs + 2>& differences) {
  const auto node = [&](int i) { return i < 2 ? 0.0 : places[entry(i / 2 - 1)].s; };
  const int nodes = 2 + 2 * count;
  for (int i = 0; i < nodes; ++i) {
    differences[entry(i)].fill(0.0);
    if (i >= 2) differences[entry(i)][entry(2 * (i / 2 - 1))] = 1.0;
  }
  for (int level = 1; level < nodes; ++level)
    for (int i = nodes - 1; i >= level; --i) {
      Combination& here = differences[entry(i)];
      if (level == 1 && i % 2 == 1) {
        here.fill(0.0);
        if (i >= 2) here[entry(2 * (i / 2 - 1) + 1)] = 1.0;
        continue;
      }
      const Combination& before = differences[entry(i - 1)];
      const double width = node(i) - node(i - level);
      for (std::size_t k = 0; k < here.size(); ++k) here[k] = (here[k] - before[k]) / width;
    }
}

/// The sum of the inputs with these weights.
void combine(const PathPoint& from, const std::array<Place, PathTrail::most>& places, int count,
             const Combination& weights, const std::vector<int>& free, OrbitVector& sum) {
  double here = 0.0;
  double along = 0.0;
  for (int k = 0; k < count; ++k) {
    here -= weights[entry(2 * k)];
    along -= weights[entry(2 * k)] * places[entry(k)].s + weights[entry(2 * k + 1)];
  }
  std::array<const double*, most_inputs + 2> arrays{from.orbit.states.data(), from.tangent.states.data()};
  std::array<double, most_inputs + 2> factors{here, along};
  sum.durations = along * from.tangent.durations;
  sum.globals = along * from.tangent.globals;
  for (int s = 0; s < from.orbit.shape.segments; ++s) sum.durations(s) += here * from.orbit.duration(s);
  for (std::size_t g = 0; g < free.size(); ++g)
    sum.globals(static_cast<Eigen::Index>(g)) += here * from.orbit.par(free[g] - 1);
  for (int k = 0; k < count; ++k) {
    const PathTrail::Mark& mark = from.trail.mark(places[entry(k)].mark);
    const double of_place = weights[entry(2 * k)];
    const double of_tangent = weights[entry(2 * k + 1)] / places[entry(k)].cosine;
    arrays[entry(2 * k + 2)] = mark.place.states.data(), factors[entry(2 * k + 2)] = of_place;
    arrays[entry(2 * k + 3)] = mark.tangent.states.data(), factors[entry(2 * k + 3)] = of_tangent;
    sum.durations += of_place * mark.place.durations + of_tangent * mark.tangent.durations;
    sum.globals += of_place * mark.place.globals + of_tangent * mark.tangent.globals;
  }
  array_functions().combine(arrays.data(), factors.data(), 2 * count + 2, sum.states.data(), sum.states.size());
}

}  // namespace

PathTrail::PathTrail(const OrbitShape& shape, int global_count) : mesh_(index(shape.intervals + 1)) {
  for (Mark& mark : marks_) mark = {OrbitVector(shape, global_count), OrbitVector(shape, global_count)};
}

void PathTrail::follow(const PathPoint& from, const std::vector<int>& free_parameters) {
  mesh_ = from.orbit.mesh;
  const bool same_mesh = from.trail.mesh_ == from.orbit.mesh;
  count_ = 1;
  for (int k = 0; same_mesh && k < std::min(from.trail.count_, most - 1); ++k) {
    Mark& mark = marks_[index(count_++)];
    const Mark& other = from.trail.marks_[index(k)];
    mark.place.states = other.place.states;
    mark.place.durations = other.place.durations;
    mark.place.globals = other.place.globals;
    mark.tangent.states = other.tangent.states;
    mark.tangent.durations = other.tangent.durations;
    mark.tangent.globals = other.tangent.globals;
  }
  copy(from, free_parameters, marks_.front());
}

void PathTrail::add(const PathPoint& point, const std::vector<int>& free_parameters) {
  if (count_ > 0 && mesh_ != point.orbit.mesh) clear();
  mesh_ = point.orbit.mesh;
  count_ = std::min(count_ + 1, most);
  std::rotate(marks_.begin(), marks_.begin() + count_ - 1, marks_.begin() + count_);
  copy(point, free_parameters, marks_.front());
}

void PathTrail::change_mesh(const std::vector<double>& mesh, const MeshTransfer& transfer) {
  for (int k = 0; k < count_; ++k) {
    Mark& mark = marks_[index(k)];
    mark.place.states = transfer(mark.place.states);
    mark.tangent.states = transfer(mark.tangent.states);
  }
  mesh_ = mesh;
}

TrailTerms add_trail(const PathPoint& from, double ds, const std::vector<int>& free_parameters, Orbit& x,
                     OrbitVector& term) {
  if (from.trail.empty() || from.trail.mesh() != from.orbit.mesh) return {};
  std::array<Place, PathTrail::most> places{};
  const int count = useful_places(from, ds, free_parameters, places);
  std::array<Combination, most_inputs + 2> differences;
  divide_differences(places, count, differences);
  const double largest = largest_state(from.orbit);
  double last = std::abs(ds) * change_by(from.tangent, from.orbit, free_parameters, largest).larger();
  TrailTerms terms;
  double product = ds * ds;  // of ds minus the nodes so far
  for (int k = 0; k < count; ++k) {
    const double to_node = ds - places[entry(k)].s;
    Combination weights;
    for (std::size_t i = 0; i < weights.size(); ++i)
      weights[i] = product * (differences[entry(2 * k + 2)][i] + to_node * differences[entry(2 * k + 3)][i]);
    combine(from, places, k + 1, weights, free_parameters, term);
    for (int s = 0; s < from.orbit.shape.segments; ++s)
      if (is_constant(from, s)) term.durations(s) = 0.0;
    const double size = change_by(term, from.orbit, free_parameters, largest).larger();
    if (!(size <= falling * last)) break;
    advance(x, 1.0, term, free_parameters);
    terms.change += size;
    terms.error = std::max(size * (size / last), negligible_term);
    if (size <= negligible_term) break;
    last = size;
    product *= to_node * to_node;
  }
  return terms;
}

}  // namespace tchat
