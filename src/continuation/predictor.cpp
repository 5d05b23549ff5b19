#include "continuation/predictor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/levels.hpp"
#include "continuation/path_follower.hpp"
#include "linear/array_kernel.hpp"

namespace tchat {

void Predictor::accepted(const PathPoint& from, const std::vector<int>& free_parameters, PathPoint& to) const {
  to.trail.follow(from, free_parameters);
}

bool Predictor::rejected(const Prediction& prediction, double correction) const {
  // Smaller changes than this lead to no other branch.
  constexpr double small_change = level::located;
  constexpr double largest_share = 0.5;
  return !(correction <= std::max(largest_share * prediction.change, small_change));
}

std::unique_ptr<Predictor> make_predictor(const DefiningSystem& system) {
  return std::make_unique<HermitePredictor>(system);
}

namespace {

/// Points nearer to each other than this share of the step, or of their distance, tell their own errors.
constexpr double apart = 0.3;
/// Least cosine between the tangents of two points on a graph over one of them.
constexpr double least_cosine = 0.5;
/// The first term may change the step by this share of its length, each further one be this share of the last.
constexpr double falling = 0.5;
/// Terms below this are rounding.
constexpr double negligible_term = level::rounding;

constexpr int most_inputs = 2 * PathTrail::most;
/// A vector as a combination of w and w' at the points of the trail.
using Combination = std::array<double, most_inputs>;

struct Place {
  int mark;
  double s;
  double cosine;  // of the tangents there and here
};

std::size_t entry(int i) { return static_cast<std::size_t>(i); }

/// <from.dual, place - from> of all points, and the cosines of the tangents there with from's.
void project(const PathPoint& from, const std::vector<int>& free, std::array<double, PathTrail::most>& distances,
             std::array<double, PathTrail::most>& cosines) {
  const PathTrail& trail = from.trail;
  const Orbit& x = from.orbit;
  std::array<const double*, PathTrail::most> places{};
  std::array<const double*, PathTrail::most> tangents{};
  for (int k = 0; k < trail.count(); ++k) {
    places[entry(k)] = trail.mark(k).place.states.data();
    tangents[entry(k)] = trail.mark(k).tangent.states.data();
  }
  array_functions().project(from.dual.states.data(), x.states.data(), places.data(), tangents.data(), trail.count(),
                            distances.data(), cosines.data(), x.states.size());
  for (int k = 0; k < trail.count(); ++k) {
    const PathTrail::Mark& mark = trail.mark(k);
    double& distance = distances[entry(k)];
    for (int s = 0; s < x.shape.segments; ++s)
      distance += from.dual.durations(s) * (mark.place.durations(s) - x.duration(s));
    for (std::size_t g = 0; g < free.size(); ++g) {
      const auto number = static_cast<Eigen::Index>(g);
      distance += from.dual.globals(number) * (mark.place.globals(number) - x.par(free[g] - 1));
    }
    cosines[entry(k)] += from.dual.durations.dot(mark.tangent.durations) + from.dual.globals.dot(mark.tangent.globals);
  }
}

/// The points that can be used, the nearest first; how many.
int useful_places(const PathPoint& from, double ds, const std::vector<int>& free,
                  std::array<Place, PathTrail::most>& places) {
  int count = 0;
  std::array<double, PathTrail::most> distances{};
  std::array<double, PathTrail::most> cosines{};
  project(from, free, distances, cosines);
  for (int k = 0; k < from.trail.count(); ++k) {
    const double s = distances[entry(k)];
    const double cosine = cosines[entry(k)];
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
  constexpr double no_change = level::converged;  // along the tangents, of unit length
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

/// What a term is a sum of, at the points of the trail that it uses: from's orbit, its tangent, then place and tangent
/// of one point after the other.
constexpr std::size_t most_sources = most_inputs + 2;
static_assert(PathTrail::most == most_pairs);
using Weights = std::array<double, most_sources>;

void add(const Weights& term, Weights& sum) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += term[i];
}

void add_tangent(double ds, Weights& sum) {
  sum[0] += 1.0;
  sum[1] += ds;
}

class Sources {
 public:
  Sources(const PathPoint& from, const std::array<Place, PathTrail::most>& places, int count,
          const DefiningSystem& system)
      : from_(from), places_(places), count_(count), system_(system), free_(system.free_parameters()) {
    states_[0] = from.orbit.states.data();
    states_[1] = from.tangent.states.data();
    for (int k = 0; k < count; ++k) {
      states_[entry(2 * k + 2)] = mark(k).place.states.data();
      states_[entry(2 * k + 3)] = mark(k).tangent.states.data();
    }
  }

  /// Those of the sources, given those of w and w'.
  Weights weights(const Combination& combination) const {
    Weights weights{};
    for (int k = 0; k < count_; ++k) {
      const double of_place = combination[entry(2 * k)];
      const double of_slope = combination[entry(2 * k + 1)];
      weights[0] -= of_place;
      weights[1] -= of_place * places_[entry(k)].s + of_slope;
      weights[entry(2 * k + 2)] = of_place;
      weights[entry(2 * k + 3)] = of_slope / places_[entry(k)].cosine;
    }
    return weights;
  }

  double duration(const Weights& weights, int s) const {
    if (is_constant(from_, s)) return 0.0;
    double sum = weights[0] * from_.orbit.duration(s) + weights[1] * from_.tangent.durations(s);
    for (int k = 0; k < count_; ++k)
      sum += weights[entry(2 * k + 2)] * mark(k).place.durations(s) +
             weights[entry(2 * k + 3)] * mark(k).tangent.durations(s);
    return sum;
  }
  double global(const Weights& weights, std::size_t g) const {
    const auto i = static_cast<Eigen::Index>(g);
    double sum = weights[0] * from_.orbit.par(free_[g] - 1) + weights[1] * from_.tangent.globals(i);
    for (int k = 0; k < count_; ++k)
      sum +=
          weights[entry(2 * k + 2)] * mark(k).place.globals(i) + weights[entry(2 * k + 3)] * mark(k).tangent.globals(i);
    return sum;
  }

  /// As OrbitChange::larger() measures it.
  double size(const Weights& weights, const ArrayRange& states, double largest_state) const {
    if (!states.finite) return std::numeric_limits<double>::quiet_NaN();
    double result = states.largest / (1.0 + largest_state);
    const double time = time_size(system_, from_.orbit);
    for (int s = 0; s < from_.orbit.shape.segments; ++s)
      if (const double change = std::abs(duration(weights, s)); change > 0.0)
        result = std::max(result, change / (time + std::abs(from_.orbit.duration(s))));
    for (std::size_t g = 0; g < free_.size(); ++g)
      result =
          std::max(result, std::abs(global(weights, g)) / parameter_size(system_, from_.orbit, static_cast<int>(g)));
    return result;
  }

  /// The states of `x` become those of from + ds from.tangent + the sum with these weights.
  void put_states(double ds, Weights weights, Orbit& x) const {
    add_tangent(ds, weights);
    array_functions().combine(states_.data(), weights.data(), 2 * count_ + 2, x.states.data(), x.states.size());
  }
  /// The same for the sum of all terms, and their ranges on the way.
  void measure_and_put_states(double ds, const std::array<Weights, PathTrail::most>& terms, ArrayRange* ranges,
                              Orbit& x) const {
    Weights sum{};
    for (int k = 0; k < count_; ++k) add(terms[entry(k)], sum);
    add_tangent(ds, sum);
    x.states.resize(from_.orbit.states.rows(), from_.orbit.states.cols());
    array_functions().ranges_of_sums(states_.data(), terms.front().data(), count_, ranges, sum.data(), x.states.data(),
                                     x.states.size());
  }
  /// And what else an orbit has.
  void put_rest(double ds, const Weights& weights, Orbit& x) const {
    x.shape = from_.orbit.shape;
    x.mesh = from_.orbit.mesh;
    x.par = from_.orbit.par;
    for (int s = 0; s < x.shape.segments; ++s) x.duration(s) += ds * from_.tangent.durations(s) + duration(weights, s);
    for (std::size_t g = 0; g < free_.size(); ++g)
      x.par(free_[g] - 1) += ds * from_.tangent.globals(static_cast<Eigen::Index>(g)) + global(weights, g);
  }

 private:
  const PathTrail::Mark& mark(int k) const { return from_.trail.mark(places_[entry(k)].mark); }

  const PathPoint& from_;
  const std::array<Place, PathTrail::most>& places_;
  int count_;
  const DefiningSystem& system_;
  const std::vector<int>& free_;
  std::array<const double*, most_sources> states_{};
};

}  // namespace

Prediction HermitePredictor::predict(const PathPoint& from, double ds, Orbit& x) const {
  if (from.trail.empty() || from.trail.mesh() != from.orbit.mesh) return {};
  std::array<Place, PathTrail::most> places{};
  const int count = useful_places(from, ds, system_.free_parameters(), places);
  if (count == 0) return {};
  std::array<Combination, most_inputs + 2> differences;
  divide_differences(places, count, differences);

  const Sources sources(from, places, count, system_);
  std::array<Weights, PathTrail::most> weights{};  // term by term
  double product = ds * ds;                        // of ds minus the nodes so far
  for (int k = 0; k < count; ++k) {
    const double to_node = ds - places[entry(k)].s;
    Combination combination{};
    for (std::size_t i = 0; i < entry(2 * k + 2); ++i)
      combination[i] = product * (differences[entry(2 * k + 2)][i] + to_node * differences[entry(2 * k + 3)][i]);
    weights[entry(k)] = sources.weights(combination);
    product *= to_node * to_node;
  }
  std::array<ArrayRange, 2 + PathTrail::most> ranges;
  sources.measure_and_put_states(ds, weights, ranges.data(), x);  // all terms are of use, nearly always

  const double largest = ranges[0].largest;
  double last = std::abs(ds) * change_by(system_, from.tangent, from.orbit, ranges[1], largest).larger();
  Prediction terms;
  Weights sum{};
  int used = 0;
  for (int k = 0; k < count; ++k) {
    const Weights& term = weights[entry(k)];
    const double size = sources.size(term, ranges[entry(2 + k)], largest);
    if (!(size <= falling * last)) break;
    add(term, sum);
    used = k + 1;
    terms.change += size;
    terms.error = std::max(size * (size / last), negligible_term);
    if (size <= negligible_term) break;
    last = size;
  }
  if (used < count && used > 0) sources.put_states(ds, sum, x);
  if (used > 0) sources.put_rest(ds, sum, x);
  return terms;
}

}  // namespace tchat
