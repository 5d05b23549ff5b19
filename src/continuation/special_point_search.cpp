#include "continuation/special_point_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "special_points/bifurcation_tests.hpp"

namespace tchat {

namespace {

/// Functions that have fallen to this share of their change over the step vanish together with the one located.
constexpr double together = 1e-5;
/// An oscillating function is followed when it misses its extrapolation by no more than this share of its size.
constexpr double unexpected = 0.3;
/// It may have changed sign twice when the parabola through its values falls below this share of those at the ends.
constexpr double dip = 0.25;
/// To find where a function has the sign that it brought into the step.
constexpr int most_halvings = 12;
constexpr std::size_t history_length = 12;

struct Node {
  double at;
  double value;
};

/// The last node with the last one before it that is at least `spacing` away, and so on; at most `most`, latest first.
std::vector<Node> apart(const std::vector<Node>& nodes, double spacing, std::size_t most) {
  std::vector<Node> chosen;
  for (auto node = nodes.rbegin(); node != nodes.rend() && chosen.size() < most; ++node)
    if (chosen.empty() || std::abs(node->at - chosen.back().at) >= spacing) chosen.push_back(*node);
  return chosen;
}

/// Value at `at` of the parabola through the last point and two earlier ones at least `spacing` apart (the line when
/// there is only one such point); nothing when there is none.
std::optional<double> extrapolate(const std::vector<Node>& nodes, double at, double spacing) {
  const std::vector<Node> chosen = apart(nodes, spacing, 3);
  if (chosen.size() < 2) return std::nullopt;
  double result = 0.0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    double weight = 1.0;
    for (std::size_t k = 0; k < chosen.size(); ++k)
      if (k != i) weight *= (at - chosen[k].at) / (chosen[i].at - chosen[k].at);
    result += weight * chosen[i].value;
  }
  return result;
}

/// Does the parabola through the last two values and the new one turn back between the last one and the new one, of
/// the same sign, near zero or beyond it?
bool turns_at_zero(const std::vector<Node>& nodes, const Node& next, double spacing) {
  const std::vector<Node> past = apart(nodes, spacing, 2);
  if (past.size() < 2 || !(past[0].value * next.value > 0.0)) return false;
  // Newton's form on past[0], next, past[1] in t = at - past[0].at.
  const double length = next.at - past[0].at;
  const double slope = (next.value - past[0].value) / length;
  const double before = (past[0].value - past[1].value) / (past[0].at - past[1].at);
  const double curvature = (slope - before) / (next.at - past[1].at);
  const double turn = 0.5 * (length - slope / curvature);
  if (!(turn > 0.0 && turn < length)) return false;
  const double value = past[0].value + slope * turn + curvature * turn * (turn - length);
  const double sign = next.value > 0.0 ? 1.0 : -1.0;
  return sign * value < dip * std::min(std::abs(past[0].value), std::abs(next.value));
}

/// A multiplier +1 where the bordered determinant changes sign is a branch point, no grazing-fold.
bool is_the_same(const SpecialPoint& special, const SpecialPoint& other) {
  return special.type == PointType::branch_point && other.kind.kind == UserPointKind::grazing_codimension_two &&
         other.kind.index == 1;
}

/// What to add to the description "KIND: WHAT" for a further one, without repeating an equal KIND.
std::string joined(const std::string& description, const std::string& further) {
  const std::size_t kind = further.find(": ");
  if (kind != std::string::npos && description.compare(0, kind + 2, further, 0, kind + 2) == 0)
    return ", " + further.substr(kind + 2);
  return "; " + further;
}

}  // namespace

SpecialPointSearch::SpecialPointSearch(PathFollower& follower, const DefiningSystem& system,
                                       std::vector<std::unique_ptr<TestFunction>> tests,
                                       const LocationSettings& settings)
    : follower_(follower),
      system_(system),
      tests_(std::move(tests)),
      settings_(settings),
      floquet_(follower.condensed().shape()),
      signs_(tests_.size(), 0) {
  data_.transversalities.resize(static_cast<std::size_t>(system.segments()));
  data_.values.resize(tests_.size());
  data_.zero_levels.resize(tests_.size());
  data_.signs.resize(tests_.size());
}

TestedPoint SpecialPointSearch::tested(const PathPoint& at) const {
  return {at.orbit, at.tangent, follower_.condensed(), data_.multipliers, data_.transversalities, data_.determinant};
}

void SpecialPointSearch::evaluate(const PathPoint& at) {
  if (settings_.multipliers) data_.multipliers = floquet_.compute(follower_.condensed(), at.orbit);
  for (int s = 0; s < system_.segments(); ++s)
    data_.transversalities[static_cast<std::size_t>(s)] = transversality(system_, at.orbit, s);
  const CondensedSystem::Determinant determinant = follower_.condensed().determinant();
  if (!determinant_unit_) determinant_unit_ = determinant.log2_size;
  data_.determinant =
      determinant.sign * std::exp2(std::clamp(determinant.log2_size - *determinant_unit_, -1000.0, 1000.0));
  const TestedPoint point = tested(at);
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    data_.values[i] = tests_[i]->value(point);
    data_.zero_levels[i] = tests_[i]->zero_level(point);
    data_.signs[i] = sign_at(point, i);
  }
}

int SpecialPointSearch::sign_at(const TestedPoint& point, std::size_t test) const {
  const std::optional<double>& value = data_.values[test];
  if (!value) return tests_[test]->sign_where_undefined(point);
  if (!(std::abs(*value) > data_.zero_levels[test])) return 0;
  return *value > 0.0 ? 1 : -1;
}

void SpecialPointSearch::begin(const PathPoint& start) {
  follower_.linearize_at(start);
  determinant_unit_.reset();
  evaluate(start);
  signs_ = data_.signs;
  history_.clear();
  remember(0.0);
}

void SpecialPointSearch::remember(double ds) {
  const double arclength = history_.empty() ? 0.0 : history_.back().arclength + std::abs(ds);
  if (history_.size() == history_length) history_.erase(history_.begin());
  history_.push_back({arclength, data_.values});
}

bool SpecialPointSearch::resolved(const PathPoint& next, double ds) {
  const auto oscillates = [](const auto& test) { return test->oscillates(); };
  if (std::none_of(tests_.begin(), tests_.end(), oscillates)) return true;
  evaluate(next);
  const double at = history_.back().arclength + std::abs(ds);
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    if (!tests_[i]->oscillates() || !data_.values[i]) continue;
    std::vector<Node> nodes;
    double size = std::abs(*data_.values[i]);
    for (const Past& past : history_) {
      if (!past.values[i]) continue;
      nodes.push_back({past.arclength, *past.values[i]});
      size = std::max(size, std::abs(*past.values[i]));
    }
    const std::optional<double> expected = extrapolate(nodes, at, 0.2 * std::abs(ds));
    if (expected && std::abs(*expected - *data_.values[i]) > unexpected * size) return false;
    if (turns_at_zero(nodes, {at, *data_.values[i]}, 0.2 * std::abs(ds))) return false;
  }
  return true;
}

/// Test functions that had a sign at the start of the step and have another, or none, at its end.
std::vector<std::size_t> SpecialPointSearch::changed(const PointData& end) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (end.values[i] && signs_[i] != 0 && end.signs[i] != signs_[i]) result.push_back(i);
  return result;
}

std::optional<SpecialPoint> SpecialPointSearch::advance(const PathPoint& here, PathPoint& next, double& ds,
                                                        NewtonResult& newton, const Note& note) {
  evaluate(next);
  const PointData end = data_;
  const OrbitVector end_tangent = next.tangent;
  const double whole = ds;
  std::optional<Zero> first;
  bool moved = false;
  const double negligible = 10.0 * settings_.tolerance;
  for (const std::size_t i : changed(end)) {
    const bool at_end = end.signs[i] == 0;
    const Zero zero = at_end ? Zero{i, ds, true} : locate(i, here, next, ds, *end.values[i]);
    moved = moved || !at_end;
    if (!zero.converged)
      note(fmt::format("Possible special point: {} changes sign, but no zero of it was located", tests_[i]->name()));
    else if (std::abs(zero.ds) > negligible && (!first || std::abs(zero.ds) < std::abs(first->ds)))
      first = zero;
  }
  if (moved) {
    // Trial steps have moved `next`: compute it again, where the branch goes on.
    const double length = first ? first->ds : ds;
    newton = follower_.step(here, length, next);
    if (!newton.converged() && first) {
      note(fmt::format("Possible special point: {}, dropped for want of convergence", tests_[first->test]->name()));
      first.reset();
      newton = follower_.step(here, ds, next);
    } else {
      ds = length;
    }
    evaluate(next);
  }
  std::optional<SpecialPoint> special;
  if (first) special = classify(*first, next, end);
  if (special && special->type == PointType::branch_point) {
    // The null space has two dimensions there: go on along the tangents of the ends of the step, which are certain.
    const double share = end.signs[first->test] == 0 ? 0.0 : first->ds / whole;
    next.tangent = here.tangent;
    next.tangent.scale(1.0 - share);
    next.tangent.states += share * end_tangent.states;
    next.tangent.durations += share * end_tangent.durations;
    next.tangent.globals += share * end_tangent.globals;
    follower_.renormalise(next);
  }
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (!first || i != first->test)
      if (data_.signs[i] != 0) signs_[i] = data_.signs[i];
  remember(ds);
  return special;
}

/// Between the start of the step, evaluated again with the border and the mesh of the trial steps, and its end. At a
/// zero located before, or where it is undefined, the function lacks the sign that the branch had there: the point
/// where it has it is found by bisection.
SpecialPointSearch::Zero SpecialPointSearch::locate(std::size_t test, const PathPoint& here, PathPoint& trial,
                                                    double ds, double end_value) {
  const auto arrive = [&](double length) {
    const bool at_start = length == 0.0;
    if (!(at_start ? follower_.linearize_at(here) : follower_.step(here, length, trial).converged())) return false;
    evaluate(at_start ? here : trial);
    return true;
  };
  const std::optional<double>& value = data_.values[test];
  const auto has_sign = [&] { return value && data_.signs[test] == signs_[test]; };
  double low = 0.0;
  double high = ds;
  bool arrived = arrive(low);
  for (int halving = 0; arrived && !has_sign() && halving < most_halvings; ++halving) {
    const double middle = 0.5 * (low + high);
    arrived = arrive(middle);
    if (value && data_.signs[test] == -signs_[test])
      high = middle, end_value = *value;
    else
      low = middle;
  }
  if (!arrived || !has_sign()) return {test, 0.0, false};
  const auto at = [&](double length) { return arrive(low + length) ? value : std::nullopt; };
  const double rounding = 1e-5 * data_.zero_levels[test];
  const double start_value = *value;
  const LocatedZero zero =
      locate_zero(at, high - low, start_value, end_value, settings_.tolerance, rounding, settings_.max_evaluations);
  return {test, low + zero.ds, zero.converged};
}

/// What the zero is. Functions that vanish together make one special point, of the first one's type, and none of them
/// is looked for again.
SpecialPoint SpecialPointSearch::classify(const Zero& zero, const PathPoint& at, const PointData& end) {
  std::vector<std::size_t> group;
  for (const std::size_t i : changed(end))
    if (i == zero.test || (data_.values[i] && std::abs(*data_.values[i]) <= together * std::abs(*end.values[i])))
      group.push_back(i);
  SpecialPoint special;
  for (const std::size_t i : group) {
    const SpecialPoint found = tests_[i]->classify(tested(at), signs_[i] < 0);
    if (i == group.front()) {
      special = found;
    } else if (!is_the_same(special, found)) {
      special.description += joined(special.description, found.description);
      special.ends_branch = special.ends_branch || found.ends_branch;
    }
  }
  for (const std::size_t i : group) {
    signs_[i] = end.signs[i];
    data_.values[i] = 0.0;
  }
  return special;
}

}  // namespace tchat
