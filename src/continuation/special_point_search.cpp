#include "continuation/special_point_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "continuation/value_trend.hpp"
#include "special_points/bifurcation_tests.hpp"

namespace tchat {

namespace {

/// Functions that have fallen to this share of their change over the step vanish together with the one located.
constexpr double together = 1e-5;
/// A step whose tangents make a larger angle (cosine) has come to another branch if the determinant falls below this
/// share.
constexpr double same_direction = 0.95;
constexpr double small_determinant = 0.3;
/// To find where a function has the sign that it brought into the step.
constexpr int most_halvings = 12;
constexpr std::size_t history_length = 12;

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

void SpecialPointSearch::evaluate_again(const PathPoint& at) {
  follower_.linearize_at(at);
  evaluate(at);
}

int SpecialPointSearch::sign_at(const TestedPoint& point, std::size_t test) const {
  const std::optional<double>& value = data_.values[test];
  if (!value) return tests_[test]->sign_where_undefined(point);
  if (!(std::abs(*value) > data_.zero_levels[test])) return 0;
  return *value > 0.0 ? 1 : -1;
}

void SpecialPointSearch::begin(const PathPoint& start) {
  determinant_unit_.reset();
  evaluate_again(start);
  signs_ = data_.signs;
  history_.clear();
  remember(0.0);
}

void SpecialPointSearch::remember(double ds) {
  const double arclength = history_.empty() ? 0.0 : history_.back().arclength + std::abs(ds);
  determinant_here_ = data_.determinant;
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
    std::vector<TrendValue> past;
    for (const Past& point : history_)
      if (point.values[i]) past.push_back({point.arclength, *point.values[i]});
    if (!follows_trend(past, {at, *data_.values[i]})) return false;
  }
  return true;
}

bool SpecialPointSearch::same_branch(const PathPoint& here, const PathPoint& next) {
  const double cosine = dot(here.dual, next.tangent);
  if (cosine > same_direction) return true;
  evaluate(next);
  // A border that is not the tangent makes the determinant smaller by the cosine.
  return std::abs(data_.determinant) > small_determinant * std::abs(cosine * determinant_here_);
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
  std::optional<SpecialPoint> special;
  if (!changed(data_).empty()) special = advance_to_first_zero(here, next, ds, newton, note);
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (data_.signs[i] != 0) signs_[i] = data_.signs[i];
  remember(ds);
  return special;
}

/// Trial steps overwrite `next`: it becomes the first zero, or again the end of the step when there is none.
std::optional<SpecialPoint> SpecialPointSearch::advance_to_first_zero(const PathPoint& here, PathPoint& next,
                                                                      double& ds, NewtonResult& newton,
                                                                      const Note& note) {
  const PathPoint end_point = next;
  const Step whole{ds, data_};
  // A branch point before anything else: other functions are searched up to it only, so that no step leads onto it.
  const std::optional<BranchPointBracket> branch_point = find_branch_point(here, next, ds, note);
  const Step searched = branch_point ? up_to(*branch_point) : whole;
  if (const std::optional<Zero> first = find_first(here, next, searched, note)) {
    const bool at_end = first->ds == whole.ds;
    const NewtonResult result = at_end ? newton : follower_.step(here, first->ds, next);
    if (result.converged()) {
      if (at_end) next = end_point;
      evaluate_again(next);
      ds = first->ds;
      newton = result;
      return classify(vanishing_with(first->test, whole.end), next, whole.end);
    }
    note(fmt::format("Possible special point: {}, dropped for want of convergence", tests_[first->test]->name()));
  }
  if (branch_point) {
    branch_point->put_zero(next);
    evaluate_again(next);
    ds = branch_point->length();
    return classify(vanishing_at(*branch_point), next, branch_point->after().data);
  }
  next = end_point;
  evaluate_again(next);
  return std::nullopt;
}

/// Right after the start a zero is the start itself: a label that the run begins from.
bool SpecialPointSearch::is_start(double length) const {
  return history_.size() == 1 && std::abs(length) <= 10.0 * settings_.tolerance;
}

/// The zero of a function that Newton's method cannot come near to, on the step to `trial`, evaluated last.
std::optional<BranchPointBracket> SpecialPointSearch::find_branch_point(const PathPoint& here, PathPoint& trial,
                                                                        double ds, const Note& note) {
  const std::vector<std::size_t> candidates = changed(data_);
  const auto found =
      std::find_if(candidates.begin(), candidates.end(), [&](std::size_t i) { return tests_[i]->singular_at_zero(); });
  if (found == candidates.end()) return std::nullopt;
  if (data_.signs[*found] == 0) {  // the step ends on top of it: look from beyond
    constexpr double beyond = 1.1;
    ds *= beyond;
    if (!follower_.step(here, ds, trial).converged()) return std::nullopt;
    evaluate(trial);
    if (data_.signs[*found] != -signs_[*found]) return std::nullopt;
  }
  const PathPoint end = trial;
  const PointData end_data = data_;
  evaluate_again(here);
  BranchPointBracket bracket(follower_, here, data_, ds, end, end_data, *found, signs_[*found]);
  const auto evaluated = [this](const PathPoint& point) -> const PointData& {
    evaluate(point);
    return data_;
  };
  if (!bracket.narrow(evaluated, trial, settings_.tolerance)) {
    note(fmt::format("Possible special point: {} changes sign, but no zero of it was located", tests_[*found]->name()));
    return std::nullopt;
  }
  if (is_start(bracket.length())) {
    note(fmt::format("The run starts at a zero of {}: no label of its own", tests_[*found]->name()));
    return std::nullopt;
  }
  return bracket;
}

/// What vanishes within the bracket, vanishes with the branch point and not before it.
SpecialPointSearch::Step SpecialPointSearch::up_to(const BranchPointBracket& branch_point) const {
  Step step{branch_point.length_before(), branch_point.before().data};
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (step.end.signs[i] == 0) step.end.signs[i] = signs_[i];
  return step;
}

/// The zero nearest to the start among those of all functions that Newton's method can come near to.
std::optional<SpecialPointSearch::Zero> SpecialPointSearch::find_first(const PathPoint& here, PathPoint& trial,
                                                                       const Step& step, const Note& note) {
  std::optional<Zero> first;
  for (const std::size_t i : changed(step.end)) {
    const bool at_end = step.end.signs[i] == 0;
    if (tests_[i]->singular_at_zero() && !at_end) continue;
    const Zero zero = at_end ? Zero{i, step.ds, true} : locate(i, here, trial, step.ds, *step.end.values[i]);
    if (!zero.converged)
      note(fmt::format("Possible special point: {} changes sign, but no zero of it was located", tests_[i]->name()));
    else if (!is_start(zero.ds) && (!first || std::abs(zero.ds) < std::abs(first->ds)))
      first = zero;
  }
  return first;
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

/// The functions that vanish at the point evaluated last, where `test` has its zero.
std::vector<std::size_t> SpecialPointSearch::vanishing_with(std::size_t test, const PointData& end) const {
  std::vector<std::size_t> group;
  for (const std::size_t i : changed(end))
    if (i == test || (data_.values[i] && std::abs(*data_.values[i]) <= together * std::abs(*end.values[i])))
      group.push_back(i);
  return group;
}

/// The branch point's own function, then the others that change sign within the bracket.
std::vector<std::size_t> SpecialPointSearch::vanishing_at(const BranchPointBracket& branch_point) const {
  std::vector<std::size_t> group{branch_point.test()};
  const PointData& before = branch_point.before().data;
  const PointData& after = branch_point.after().data;
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (i != branch_point.test() && before.values[i] && after.values[i] && signs_[i] != 0 &&
        after.signs[i] == -signs_[i])
      group.push_back(i);
  return group;
}

/// Functions that vanish together make one special point, of the first one's type, and none of them is looked for
/// again.
SpecialPoint SpecialPointSearch::classify(const std::vector<std::size_t>& group, const PathPoint& at,
                                          const PointData& after) {
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
    signs_[i] = after.signs[i];
    data_.values[i] = 0.0;
    data_.signs[i] = 0;
  }
  return special;
}

}  // namespace tchat
