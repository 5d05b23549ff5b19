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
constexpr std::size_t history_length = 12;

/// Value at `at` of the parabola through the last point and two earlier ones at least `spacing` apart (the line when
/// there is only one such point); nothing when there is none.
struct Node {
  double at;
  double value;
};
std::optional<double> extrapolate(const std::vector<Node>& nodes, double at, double spacing) {
  std::vector<Node> chosen;
  for (auto node = nodes.rbegin(); node != nodes.rend() && chosen.size() < 3; ++node)
    if (chosen.empty() || std::abs(node->at - chosen.back().at) >= spacing) chosen.push_back(*node);
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
  }
}

int SpecialPointSearch::sign_of(const PointData& data, std::size_t test) {
  const std::optional<double>& value = data.values[test];
  if (!value || !(std::abs(*value) > data.zero_levels[test])) return 0;
  return *value > 0.0 ? 1 : -1;
}

void SpecialPointSearch::begin(const PathPoint& start) {
  follower_.linearize_at(start);
  determinant_unit_.reset();
  evaluate(start);
  for (std::size_t i = 0; i < tests_.size(); ++i) signs_[i] = sign_of(data_, i);
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
  }
  return true;
}

/// Test functions that had a sign at the start of the step and have another, or none, at its end.
std::vector<std::size_t> SpecialPointSearch::changed(const PointData& end) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (end.values[i] && signs_[i] != 0 && sign_of(end, i) != signs_[i]) result.push_back(i);
  return result;
}

std::optional<SpecialPoint> SpecialPointSearch::advance(const PathPoint& here, PathPoint& next, double& ds,
                                                        NewtonResult& newton, const Note& note) {
  evaluate(next);
  const PointData end = data_;
  std::optional<Zero> first;
  bool moved = false;
  const double negligible = 10.0 * settings_.tolerance;
  for (const std::size_t i : changed(end)) {
    const bool at_end = sign_of(end, i) == 0;
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
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (!first || i != first->test)
      if (const int sign = sign_of(data_, i); sign != 0) signs_[i] = sign;
  remember(ds);
  return special;
}

SpecialPointSearch::Zero SpecialPointSearch::locate(std::size_t test, const PathPoint& here, PathPoint& trial,
                                                    double ds, double end_value) {
  const auto value_at = [&](const PathPoint& at) {
    evaluate(at);
    return data_.values[test];
  };
  // Again at the start of the step: with the border and the mesh of the trial steps.
  std::optional<double> start_value;
  if (follower_.linearize_at(here)) start_value = value_at(here);
  if (!start_value || !(*start_value * end_value < 0.0)) return {test, 0.0, false};
  const auto at = [&](double length) -> std::optional<double> {
    if (!follower_.step(here, length, trial).converged()) return std::nullopt;
    return value_at(trial);
  };
  const double rounding = 1e-5 * data_.zero_levels[test];
  const LocatedZero zero =
      locate_zero(at, ds, *start_value, end_value, settings_.tolerance, rounding, settings_.max_evaluations);
  return {test, zero.ds, zero.converged};
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
    } else {
      special.description += "; " + found.description;
      special.ends_branch = special.ends_branch || found.ends_branch;
    }
  }
  for (const std::size_t i : group) {
    signs_[i] = sign_of(end, i);
    data_.values[i] = 0.0;
  }
  return special;
}

}  // namespace tchat
