#include "continuation/special_point_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "base/levels.hpp"
#include "continuation/branch_point_bracket.hpp"
#include "continuation/path_follower.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/equilibrium_system.hpp"
#include "orbit/orbit.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/equilibrium_tests.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

namespace {

/// Functions that have fallen to this share of their change over the step vanish together with the one located.
constexpr double together = level::same;
/// A step whose tangents make a larger angle (cosine) has come to another branch if the distance to a singular problem
/// falls below this share.
constexpr double same_direction = 0.95;
constexpr double small_distance = 0.3;
/// Near a crossing of two curves a step along one of them turns by less (cosine): states or periods that change alike
/// along both make the angle between the curves small.
constexpr double hardly_turned = 0.99;
/// Places on a step that are so near to each other, as a share of it, may be one.
constexpr double near_on_step = 1e-3;
constexpr std::size_t history_length = 12;

/// A defined value without its rounding.
double beyond_level(const TestValue& test) { return std::abs(*test.value) > test.zero_level ? *test.value : 0.0; }

/// A multiplier +1 where the bordered determinant changes sign is a branch point, no grazing-fold; a branch that turns
/// where an end of a segment is tangent to its surface has the label of that. A resonance may have two functions. A
/// curve of folds of doubled orbits that meets its mirror image has no cusp there.
bool is_the_same(const SpecialPoint& special, const SpecialPoint& other) {
  if (special.type != PointType::user && special.type == other.type) return true;
  constexpr auto velocity = UserPointKind::impact_velocity;
  if (special.kind.kind == velocity && other.kind.kind == velocity) return special.kind.segment == other.kind.segment;
  if (special.type == PointType::doubled_fold_end && other.type == PointType::cusp) return true;
  return special.type == PointType::branch_point && other.kind.kind == UserPointKind::grazing_codimension_two &&
         other.kind.index == 1;
}

/// Do the segments behind the end of segment `from` last no time up to the end of segment `to` (from 0)?
bool nothing_between(const Orbit& x, int from, int to) {
  const int m = x.shape.segments;
  for (int s = from; s != to; s = (s + 1) % m)
    if (!lasts_no_time(x, (s + 1) % m)) return false;
  return true;
}

/// Is a contact at an end of a segment, where segments around last no time, the impact that the label is?
bool is_that_impact(const Orbit& x, const Signature& signature, const SpecialPoint& special,
                    const SpecialPoint& other) {
  const UserPointKind& contact = other.kind;
  if (special.kind.kind != UserPointKind::impact_velocity || contact.kind != UserPointKind::contact) return false;
  if (contact.tau > 0.0 && contact.tau < 1.0) return false;
  const int m = x.shape.segments;
  const int impact = special.kind.segment - 1;
  const int end = contact.tau > 0.0 ? contact.segment - 1 : (contact.segment - 2 + m) % m;
  const bool same_event = signature[static_cast<std::size_t>(impact)].event == contact.index;
  return same_event && (nothing_between(x, impact, end) || nothing_between(x, end, impact));
}

/// On a curve of folds or period doublings one multiplier is known by the curve's own condition, also where the curve
/// ends on the grazing curve.
void put_critical(FloquetMultipliers& multipliers, int critical) {
  constexpr double accuracy = 1e-3;
  const bool listed = std::any_of(multipliers.values.begin(), multipliers.values.end(), [&](const auto& mu) {
    return std::abs(mu - static_cast<double>(critical)) < accuracy;
  });
  if (multipliers.undetermined == 0 || listed) return;
  // Sorted: the one closest to 1 first, then by the distance to the unit circle.
  multipliers.values.insert(multipliers.values.begin() + (critical < 0 ? 1 : 0), critical);
  --multipliers.undetermined;
}

/// What vanishes besides the label's own function.
UserPointKind kind_of(const SpecialPoint& special) {
  if (special.type == PointType::user) return special.kind;
  return {UserPointKind::other_type, 0, static_cast<int>(special.type), 0.0};
}

/// What to add to the description "KIND: WHAT" for a further one, without repeating an equal KIND.
std::string joined(const std::string& description, const std::string& further) {
  const std::size_t kind = further.find(": ");
  if (kind != std::string::npos && description.compare(0, kind + 2, further, 0, kind + 2) == 0)
    return ", " + further.substr(kind + 2);
  return "; " + further;
}

/// The description with the names of the sliding bifurcations that the point is, each once, before it.
std::string with_sliding_names(const SpecialPoint& special, const TestedPoint& point) {
  std::vector<UserPointKind> kinds = special.further;
  if (special.type == PointType::user) kinds.insert(kinds.begin(), special.kind);
  std::vector<std::string> names;
  for (const UserPointKind& kind : kinds)
    if (const std::string name = sliding_bifurcation(point, kind);
        !name.empty() && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  return names.empty() ? special.description : fmt::format("{}: {}", fmt::join(names, ", "), special.description);
}

}  // namespace

SpecialPointSearch::SpecialPointSearch(PathFollower& follower, const DefiningSystem& system, BranchAnalysis& analysis,
                                       std::vector<std::unique_ptr<TestFunction>> tests,
                                       const LocationSettings& settings)
    : follower_(follower),
      system_(system),
      tests_(std::move(tests)),
      settings_(settings),
      analysis_(analysis),
      evidence_(tests_.size()),
      is_one_parameter_family_(system.free_count() == 1 && follower.condition() == nullptr && follower.held().empty()),
      signs_(tests_.size(), 0) {}

TestedPoint SpecialPointSearch::tested(const PathPoint& at, const PointData& data) const {
  return {at.orbit,
          at.tangent,
          follower_.condensed(),
          data.multipliers,
          data.transversalities,
          data.singular_distance,
          follower_.condition(),
          follower_.principal_direction(at),
          data.principal_rate_size,
          is_one_parameter_family_,
          data.courses};
}

std::vector<std::string> SpecialPointSearch::details(const PathPoint& at, const PointData& data) const {
  std::vector<std::string> list;
  for (const auto& test : tests_)
    if (const std::string text = test->details(tested(at, data)); !text.empty()) list.push_back(text);
  return list;
}

std::vector<VanishingFunction> SpecialPointSearch::vanishing(const PathPoint& at, const PointData& data) const {
  constexpr int least_points = 3;
  std::vector<VanishingFunction> list;
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (evidence_[i].points >= least_points && !evidence_[i].has_sign)
      list.push_back({tests_[i]->name(), tests_[i]->reason_to_vanish(tested(at, data))});
  return list;
}

/// At a point whose linearisation the follower holds.
double SpecialPointSearch::signed_distance(const PathPoint& at) const {
  std::optional<double> own;
  if (follower_.condition() == nullptr) own = system_.singular_distance(at.orbit, at.tangent);
  return own ? *own : follower_.signed_distance(at);
}

PointData SpecialPointSearch::evaluate(PathPoint& at) {
  PointData data;
  evaluate(at, data);
  return data;
}

void SpecialPointSearch::evaluate(PathPoint& at, PointData& data) {
  if (settings_.multipliers) {
    analysis_.find_multipliers(follower_.condensed(), at.orbit, data.multipliers);
    const OrbitCondition* condition = follower_.condition();
    const std::optional<int> kept = condition != nullptr ? condition->kept_multiplier() : std::nullopt;
    if (kept) put_critical(data.multipliers, *kept);
    follower_.monitors().store(at.orbit, data.multipliers);
  }
  data.transversalities.clear();
  for (int s = 0; s < system_.segments(); ++s)
    data.transversalities.push_back(crossing_at_end(system_, at.orbit, s).transversality());
  data.singular_distance = signed_distance(at);
  data.principal_rate_size = follower_.principal_rate_size(at);
  data.estimated_error = estimated_error(system_.system(), system_.signature(), at.orbit, follower_.condensed().rule());
  if (data.multipliers.is_flow_lost && !(data.estimated_error <= coarse_mesh)) {
    data.multipliers.is_flow_lost = false;
    data.multipliers.is_mesh_coarse = true;
  }
  find_event_courses(at.orbit, data);
  const TestedPoint point = tested(at, data);
  data.tests.clear();
  for (const auto& test : tests_) data.tests.push_back(test->evaluate(point));
  data.details.clear();
}

void SpecialPointSearch::find_event_courses(const Orbit& x, PointData& data) {
  event_scales_.begin(system_.system());
  std::size_t count = 0;
  for (std::size_t s = 0; s < std::min(settings_.monitored.size(), system_.signature().size()); ++s)
    for (const int event : settings_.monitored[s]) {
      if (count == data.courses.size()) data.courses.emplace_back();
      EventCourse& course = data.courses[count++];
      course.segment = static_cast<int>(s);
      course.event = event;
      course_finder_.find(system_.system(), system_.signature()[s].field, follower_.condensed().rule(), x, course);
      course.scale = event_scales_.of(system_.system(), x, event);
    }
}

PointData SpecialPointSearch::evaluate_again(PathPoint& at) {
  follower_.linearize_at(at);
  return evaluate(at);
}

PointData SpecialPointSearch::begin(PathPoint& start) {
  PointData data = evaluate_again(start);
  for (std::size_t i = 0; i < tests_.size(); ++i) signs_[i] = data.tests[i].sign;
  labelled_.assign(tests_.size(), false);
  rest_ = 0.0;
  history_.clear();
  remember(data, 0.0);
  return data;
}

void SpecialPointSearch::remember(const PointData& data, double ds) {
  const double arclength = history_.empty() ? 0.0 : history_.back().arclength + std::abs(ds);
  if (std::isfinite(data.singular_distance)) distance_here_ = data.singular_distance;
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    evidence_[i].points += data.tests[i].value.has_value();
    evidence_[i].has_sign = evidence_[i].has_sign || labelled_[i] || data.tests[i].sign != 0;
  }
  if (history_.size() < history_length) {
    history_.push_back({arclength, data.tests});
    return;
  }
  std::rotate(history_.begin(), history_.begin() + 1, history_.end());  // the oldest one's space is used again
  history_.back().arclength = arclength;
  history_.back().tests = data.tests;
}

bool SpecialPointSearch::resolved(const PathPoint& here, const Candidate& next) const {
  const auto turns = [&] { return !(dot(here.dual, next.point.tangent) > hardly_turned); };
  const double at = history_.back().arclength + std::abs(next.ds);
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    const Resolution resolution = tests_[i]->resolution();
    if (!next.data.tests[i].value || resolution == Resolution::any) continue;
    std::array<TrendValue, history_length> values;
    std::size_t count = 0;
    for (const Past& point : history_)
      if (point.tests[i].value) values[count++] = {point.arclength, beyond_level(point.tests[i])};
    const std::span<const TrendValue> past(values.data(), count);
    const TrendValue last{at, beyond_level(next.data.tests[i])};
    if (resolution == Resolution::direction && is_near_zero(i, next.data.tests[i]) && turns()) return false;
    const bool is_resolved = resolution == Resolution::trend ? follows_trend(past, last) : !has_two_zeros(past, last);
    if (!is_resolved) return false;
  }
  return true;
}

/// At the end of a step, or somewhere on it.
bool SpecialPointSearch::is_near_zero(std::size_t test, const TestValue& end) const {
  constexpr double nearby = 0.1;
  const TestValue& start = history_.back().tests[test];
  return end.sign == -signs_[test] || std::abs(*end.value) < nearby || (start.value && std::abs(*start.value) < nearby);
}

bool SpecialPointSearch::same_branch(const PathPoint& here, const PathPoint& next) {
  const double cosine = dot(here.dual, next.tangent);
  if (cosine > same_direction) return true;
  // A border that is not the tangent makes the determinant smaller by the cosine.
  const double of_border = follower_.cosine_at_ends(here, next);
  return std::abs(signed_distance(next)) > small_distance * std::abs(of_border * distance_here_);
}

/// Test functions that had a sign at the start of the step and have the other one at its end.
std::vector<std::size_t> SpecialPointSearch::changed(const PointData& end) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (!tests_[i]->is_only_reported() && end.tests[i].value && signs_[i] != 0 && end.tests[i].sign == -signs_[i])
      result.push_back(i);
  return result;
}

std::optional<SpecialPoint> SpecialPointSearch::advance(const PathPoint& here, Candidate& next, NewtonResult& newton,
                                                        const Reports& reports) {
  searches_.assign(tests_.size(), Search::none);
  objections_.assign(tests_.size(), "");
  const std::optional<Candidate> farther = farther_step(here, next);
  const PointData& at_end = farther ? farther->data : next.data;
  std::optional<SpecialPoint> special;
  std::optional<Candidate> whole;  // the step, where a zero is looked for on it
  rest_ = std::max(rest_ - std::abs(next.ds), 0.0);
  report_start(at_end, reports);
  if (!changed(at_end).empty()) {
    whole = farther ? *farther : next;
    special = advance_to_first_zero(here, next, newton, *whole);
  }
  report_lost(next.data, reports);
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (next.data.tests[i].sign != 0) signs_[i] = next.data.tests[i].sign;
  if (special)
    keep_rest(*whole, next.point);
  else
    labelled_.assign(tests_.size(), false);
  remember(next.data, next.ds);
  return special;
}

/// A function that ends the step to `next` within its zero level has not changed sign yet: whether it does is seen a
/// little farther on. Nothing where none does; `next` is then linearised and evaluated again, if that was looked at.
std::optional<Candidate> SpecialPointSearch::farther_step(const PathPoint& here, Candidate& next) {
  constexpr double beyond = 1.1;
  std::vector<std::size_t> undecided;
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (signs_[i] != 0 && next.data.tests[i].value && next.data.tests[i].sign == 0) undecided.push_back(i);
  if (undecided.empty()) return std::nullopt;
  Candidate farther{next.point, beyond * next.ds, {}};
  if (follower_.step(here, farther.ds, farther.point).converged() && same_branch(here, farther.point)) {
    farther.data = evaluate(farther.point);
    if (std::any_of(undecided.begin(), undecided.end(),
                    [&](std::size_t i) { return farther.data.tests[i].sign == -signs_[i]; }))
      return farther;
  }
  next.data = evaluate_again(next.point);
  return std::nullopt;
}

/// After a step of this length, by the trial steps so far.
bool SpecialPointSearch::has_tangent(double length) const {
  return std::none_of(singular_.begin(), singular_.end(), [&](double singular) {
    return std::abs(singular - length) <= near_on_step * std::abs(whole_->ds);
  });
}

/// Where the equations are singular, as on a curve of branch points that passes a conservative system, what they have
/// as a tangent is rounding: between points with about one direction the branch has about that direction.
NewtonResult SpecialPointSearch::step_within(const PathPoint& here, double length, PathPoint& trial) {
  constexpr double most_turn = 2.0;  // beside that of the whole step
  const NewtonResult result = follower_.step(here, length, trial);
  if (!result.converged()) return result;
  const OrbitVector& beyond = whole_->point.tangent;
  const double turn = 1.0 - dot(here.dual, beyond);
  const double least = std::max(most_turn * turn, 1.0 - hardly_turned);
  if (turn > 1.0 - same_direction || !(1.0 - dot(here.dual, trial.tangent) > least)) return result;
  const double share = length / whole_->ds;
  OrbitVector between = here.tangent;
  between.states += share * (beyond.states - here.tangent.states);
  between.durations += share * (beyond.durations - here.tangent.durations);
  between.globals += share * (beyond.globals - here.tangent.globals);
  follower_.set_tangent(trial, between);
  singular_.push_back(length);
  return result;
}

/// `next` becomes the first zero, or stays the end of the step when there is none; the follower holds its
/// linearisation.
std::optional<SpecialPoint> SpecialPointSearch::advance_to_first_zero(const PathPoint& from, Candidate& next,
                                                                      NewtonResult& newton, const Candidate& whole) {
  whole_ = &whole;
  singular_.clear();
  PathPoint here = from;  // with the end of the step, between which and its start trial points are predicted
  here.trail.add(whole.point, system_.free_parameters());
  PathPoint trial = next.point;
  std::optional<Cut> cut;
  Candidate step = whole;
  // Each round leaves a shorter step, or two functions vanish at one place of which each is found after the other.
  for (std::size_t round = 0; round < tests_.size() && !changed(step.data).empty(); ++round) {
    std::optional<Cut> earlier = first_in(here, trial, step);
    if (!earlier) break;
    cut = std::move(earlier);
    // What besides has another sign there than at both ends of the step has a zero before.
    step = cut->at;
    for (const std::size_t i : cut->group) step.data.tests[i].sign = signs_[i];
  }
  if (cut) next = std::move(cut->at);
  next.data = evaluate_again(next.point);
  if (!cut) return std::nullopt;
  if (cut->newton) newton = *cut->newton;
  return classify(cut->group, next);
}

/// The nearest of the zeros that can be located on a step; trial steps overwrite `trial`.
std::optional<SpecialPointSearch::Cut> SpecialPointSearch::first_in(const PathPoint& here, PathPoint& trial,
                                                                    const Candidate& step) {
  // A branch point before anything else: other functions are searched up to it only, so that no step leads onto it.
  const std::optional<BranchPointBracket> branch_point = find_branch_point(here, trial, step);
  // What vanishes within the bracket, vanishes with the branch point and not before it.
  const double length = branch_point ? branch_point->length_before() : step.ds;
  const PointData& end = branch_point ? branch_point->before().data : step.data;
  std::vector<Zero> zeros = find_zeros(here, trial, length, end);
  while (!zeros.empty()) {
    const Zero first = first_sharp_zero(here, trial, length, zeros, end);
    const NewtonResult result = step_within(here, first.ds, trial);
    if (!result.converged()) {
      searches_[first.test] = Search::failed;
      break;
    }
    const PointData there = evaluate(trial);
    std::vector<std::size_t> group = vanishing_with(first, zeros, there, length, step.data);
    std::erase_if(group, [&](std::size_t test) { return !has_evidence(test, trial, there); });
    if (!group.empty()) return Cut{{trial, first.ds, there}, group, result};
    // The first one too where it has changed its sign back at the end of the step: it is looked for once.
    std::erase_if(zeros,
                  [&](const Zero& zero) { return zero.test == first.test || searches_[zero.test] != Search::located; });
  }
  if (!branch_point) return std::nullopt;
  branch_point->put_zero(trial);
  const PointData there = evaluate_again(trial);
  std::vector<std::size_t> group = vanishing_at(*branch_point);
  std::erase_if(group, [&](std::size_t test) {
    if (tests_[test]->is_genuine(tested(trial, there))) return false;
    searches_[test] = Search::no_special_point;
    return true;
  });
  return Cut{{trial, branch_point->length(), there}, group, std::nullopt};
}

/// At the point that would be labelled as its zero, no trial point beside it: where orbits depend on the parameter
/// steeply the two differ.
bool SpecialPointSearch::has_evidence(std::size_t test, const PathPoint& at, const PointData& data) {
  const TestedPoint point = tested(at, data);
  objections_[test] = tests_[test]->objection(point);
  if (objections_[test].empty() && tests_[test]->is_genuine(point)) return true;
  searches_[test] = objections_[test].empty() ? Search::no_special_point : Search::refused;
  return false;
}

/// At a point `distance` from the place of its zero: is the function so small there that the point may be its zero as
/// well? So it is with a function that is flat where it vanishes, whose zero is found to the root of rounding only.
bool SpecialPointSearch::is_flat(const Zero& zero, const PointData& there, double distance, double length,
                                 const PointData& end) const {
  constexpr double linear_share = 0.1;
  const std::optional<double>& value = there.tests[zero.test].value;
  return value && std::abs(*value) <= linear_share * std::abs(distance / length * *end.tests[zero.test].value);
}

/// The nearest zero on a step of this length; where its function is flat and another one vanishes sharply beside it (a
/// contact and an impact velocity at a codimension-two end of a curve), the sharp one.
SpecialPointSearch::Zero SpecialPointSearch::first_sharp_zero(const PathPoint& here, PathPoint& trial, double length,
                                                              const std::vector<Zero>& zeros, const PointData& end) {
  const Zero first = *std::min_element(zeros.begin(), zeros.end(),
                                       [](const Zero& a, const Zero& b) { return std::abs(a.ds) < std::abs(b.ds); });
  const auto data_at = [&](const Zero& zero) -> std::optional<PointData> {
    if (!step_within(here, zero.ds, trial).converged()) return std::nullopt;
    return evaluate(trial);
  };
  for (const Zero& other : zeros) {
    const double distance = other.ds - first.ds;
    if (std::abs(distance) <= settings_.same_place() || std::abs(distance) > near_on_step * std::abs(length)) continue;
    const std::optional<PointData> at_first = data_at(first);
    const std::optional<PointData> at_other = data_at(other);
    if (at_first && at_other && is_flat(first, *at_other, distance, length, end) &&
        !is_flat(other, *at_first, distance, length, end))
      return other;
  }
  return first;
}

/// After a step was cut at a zero: what has yet another sign at its end is found on the rest, if that is not passed.
void SpecialPointSearch::keep_rest(const Candidate& whole, const PathPoint& cut) {
  if (changed(whole.data).empty()) return;
  rest_ = std::abs(dot_difference(cut.dual, whole.point.orbit, cut.orbit, system_.free_parameters()));
}

double SpecialPointSearch::limited(double ds) const {
  return rest_ > settings_.tolerance && rest_ < std::abs(ds) ? std::copysign(rest_, ds) : ds;
}

/// Functions that are zero at the first point of the branch and are not at the second one.
void SpecialPointSearch::report_start(const PointData& next, const Reports& reports) const {
  if (history_.size() != 1) return;
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (const TestValue& at_start = history_.back().tests[i];
        at_start.value && at_start.sign == 0 && signs_[i] == 0 && next.tests[i].sign != 0)
      reports.start(tests_[i]->name());
}

/// Changes of sign that `next` leaves behind without a label.
void SpecialPointSearch::report_lost(const PointData& next, const Reports& reports) const {
  for (const std::size_t i : changed(next)) {
    const std::string name = tests_[i]->name();
    if (searches_[i] == Search::start && history_.size() == 1)
      reports.start(name);
    else if (searches_[i] == Search::start)
      reports.note(fmt::format("The last label is at a zero of {}: no label of its own", name));
    else if (searches_[i] == Search::jump)
      reports.note(fmt::format("{} changes sign by a jump: no special point", name));
    else if (searches_[i] == Search::refused)
      reports.lost(objections_[i]);
    else if (searches_[i] != Search::no_special_point)
      reports.lost(fmt::format("Possible special point: {} changes sign, but no zero of it was located", name));
  }
}

/// Right after the start a zero is the start itself: a label that the run begins from. Right after a label it cannot be
/// told from that.
bool SpecialPointSearch::is_start(double length) const {
  const bool is_special =
      history_.size() == 1 || std::find(labelled_.begin(), labelled_.end(), true) != labelled_.end();
  return is_special && std::abs(length) <= settings_.same_place();
}

/// The zero of a function that Newton's method cannot come near to.
std::optional<BranchPointBracket> SpecialPointSearch::find_branch_point(const PathPoint& here, PathPoint& trial,
                                                                        const Candidate& step) {
  const std::vector<std::size_t> candidates = changed(step.data);
  const auto found =
      std::find_if(candidates.begin(), candidates.end(), [&](std::size_t i) { return tests_[i]->singular_at_zero(); });
  if (found == candidates.end()) return std::nullopt;
  PathPoint start = here;
  BranchPointBracket bracket(follower_, here, evaluate_again(start), step, *found, signs_[*found]);
  const auto evaluated = [this](PathPoint& point) { return evaluate(point); };
  const bool narrowed = bracket.narrow(evaluated, trial, settings_.tolerance);
  bracket.put_zero(trial);
  const PointData at_zero = evaluate_again(trial);
  searches_[*found] = !tests_[*found]->is_genuine(tested(trial, at_zero)) ? Search::no_special_point
                      : !narrowed                                         ? Search::failed
                      : is_start(bracket.length())                        ? Search::start
                                                                          : Search::located;
  if (searches_[*found] != Search::located) return std::nullopt;
  objections_[*found] = objection_at(bracket, trial, at_zero);
  if (objections_[*found].empty()) return bracket;
  searches_[*found] = Search::refused;
  return std::nullopt;
}

/// The place of a branch point is interpolated: it has to satisfy the equations as well as a point that Newton's method
/// ends with, or as well as a branch point can be interpolated.
std::string SpecialPointSearch::objection_at(const BranchPointBracket& bracket, const PathPoint& trial,
                                             const PointData& at_zero) const {
  constexpr double interpolated = level::differences;
  const double residual = follower_.relative_residual(trial.orbit);
  if (!(residual <= std::max(interpolated, follower_.newton_settings().tolerance_states)))
    return fmt::format("{} changes sign, but no solution was found there (relative residual {:.1e}): no label",
                       tests_[bracket.test()]->name(), residual);
  return tests_[bracket.test()]->objection(tested(trial, at_zero));
}

/// All zeros on a step of length ds, which ends with the values `end`, that Newton's method can come near to.
std::vector<SpecialPointSearch::Zero> SpecialPointSearch::find_zeros(const PathPoint& here, PathPoint& trial, double ds,
                                                                     const PointData& end) {
  std::vector<Zero> zeros;
  if (ds == 0.0) return zeros;  // a branch point right behind the start of the step
  for (const std::size_t i : changed(end)) {
    if (tests_[i]->singular_at_zero()) continue;
    const Zero zero = locate(i, here, trial, ds, *end.tests[i].value);
    searches_[i] = zero.search;
    if (zero.search != Search::located) continue;
    if (is_start(zero.ds))
      searches_[i] = Search::start;
    else
      zeros.push_back(zero);
  }
  return zeros;
}

/// Between the start of the step, evaluated again with the border and the mesh of the trial steps, and its end. At a
/// zero located before, or where it is undefined, the function lacks the sign that the branch had there, or has it by
/// rounding: the point where it has it is found by bisection.
SpecialPointSearch::Zero SpecialPointSearch::locate(std::size_t test, const PathPoint& here, PathPoint& trial,
                                                    double ds, double end_value) {
  TestValue found;
  bool genuine = true;
  PathPoint start = here;
  const auto evaluate_at = [&](double length) {
    const bool at_start = length == 0.0;
    if (!(at_start ? follower_.linearize_at(here) : step_within(here, length, trial).converged())) return false;
    PathPoint& there = at_start ? start : trial;
    const PointData data = evaluate(there);
    found = data.tests[test];
    genuine = tests_[test]->is_genuine(tested(there, data));
    return true;
  };
  const auto has_wanted_sign = [&] { return found.value && found.sign == signs_[test]; };
  SignChange bracket{0.0, ds, 0.0, end_value};
  bool arrived = evaluate_at(bracket.low);
  const bool genuine_at_start = arrived && genuine;
  bool has_sign = arrived && has_wanted_sign() && !labelled_[test];
  while (arrived && !has_sign && bracket.length() > settings_.tolerance) {
    const double middle = 0.5 * (bracket.low + bracket.high);
    arrived = evaluate_at(middle);
    has_sign = arrived && has_wanted_sign();
    if (found.value && found.sign == -signs_[test])
      bracket.high = middle, bracket.high_value = *found.value;
    else
      bracket.low = middle;
  }
  if (!arrived) return {test, 0.0, Search::failed};
  if (!has_sign) return {test, bracket.high, genuine_at_start ? zero_at_start(test) : Search::no_special_point};
  bracket.low_value = *found.value;
  const auto at = [&](double length) { return evaluate_at(length) ? found.value : std::optional<double>(); };
  // No level of rounding: where a function is flat, it is small far from its zero.
  const LocatedZero zero = locate_zero_surely(at, bracket, settings_.tolerance, 0.0, settings_.max_evaluations);
  const bool is_jump = zero.status == ZeroSearch::jump;
  const Search search = tests_[test]->is_of_tangent() && !has_tangent(zero.ds)       ? Search::no_special_point
                        : zero.converged() || (is_jump && tests_[test]->is_switch()) ? Search::located
                        : is_jump && genuine                                         ? Search::jump
                        : is_jump                                                    ? Search::no_special_point
                                                                                     : Search::failed;
  return {test, zero.ds, search};
}

/// The branch leaves the start of the step with another sign than it came with.
SpecialPointSearch::Search SpecialPointSearch::zero_at_start(std::size_t test) const {
  const TestValue& here = history_.back().tests[test];
  if (!here.value) return Search::no_special_point;  // undefined there: nothing goes through zero
  if (labelled_[test]) return Search::start;
  return here.sign == 0 ? Search::located : Search::jump;
}

/// The functions that vanish where one has its zero, evaluated as `there`: whose own zeros are at the same place as far
/// as can be told, or, where these were not located, that have become small, or depend on a tangent that is not
/// determined.
std::vector<std::size_t> SpecialPointSearch::vanishing_with(const Zero& first, const std::vector<Zero>& zeros,
                                                            const PointData& there, double length,
                                                            const PointData& end) const {
  std::vector<std::size_t> group;
  for (const std::size_t i : changed(end)) {
    const auto zero = std::find_if(zeros.begin(), zeros.end(), [i](const Zero& z) { return z.test == i; });
    const std::optional<double>& value = there.tests[i].value;
    const bool small = value && std::abs(*value) <= together * std::abs(*end.tests[i].value);
    const bool has_none = tests_[i]->is_of_tangent() && !has_tangent(first.ds);
    const bool same = zero == zeros.end() ? has_none || (small && searches_[i] == Search::failed)
                                          : std::abs(zero->ds - first.ds) <= settings_.same_place() ||
                                                (small && is_flat(*zero, there, zero->ds - first.ds, length, end));
    if (same) group.push_back(i);
  }
  // Before a branch point it may have vanished twice, and then has no other sign at the end of the step.
  if (std::find(group.begin(), group.end(), first.test) == group.end()) group.push_back(first.test);
  return group;
}

/// The branch point's own function, then the others that change sign within the bracket.
std::vector<std::size_t> SpecialPointSearch::vanishing_at(const BranchPointBracket& branch_point) const {
  std::vector<std::size_t> group{branch_point.test()};
  const PointData& before = branch_point.before().data;
  const PointData& after = branch_point.after().data;
  for (std::size_t i = 0; i < tests_.size(); ++i)
    if (i != branch_point.test() && before.tests[i].value && after.tests[i].value && signs_[i] != 0 &&
        after.tests[i].sign == -signs_[i])
      group.push_back(i);
  return group;
}

/// Functions that vanish together make one special point, of the first one's type, and none of them is looked for
/// again.
SpecialPoint SpecialPointSearch::classify(const std::vector<std::size_t>& group, Candidate& at) {
  SpecialPoint special;
  labelled_.assign(tests_.size(), false);
  for (const std::size_t i : group) {
    const SpecialPoint found = tests_[i]->classify(tested(at.point, at.data), signs_[i] < 0);
    if (i == group.front()) {
      special = found;
    } else if (!is_the_same(special, found) && !is_that_impact(at.point.orbit, system_.signature(), special, found)) {
      special.further.push_back(kind_of(found));
      special.description += joined(special.description, found.description);
      special.ends_branch = special.ends_branch || found.ends_branch;
    }
    if (special.remark.empty() && found.remark.starts_with("normal form")) special.remark = found.remark;
  }
  special.description = with_sliding_names(special, tested(at.point, at.data));
  for (const std::size_t i : group) {
    signs_[i] = -signs_[i];
    at.data.tests[i].value = 0.0;
    at.data.tests[i].sign = 0;
    labelled_[i] = true;
  }
  return special;
}

}  // namespace tchat
