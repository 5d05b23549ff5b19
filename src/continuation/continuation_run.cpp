#include "continuation/continuation_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/levels.hpp"
#include "continuation/branch_limits.hpp"
#include "continuation/orbit_limit.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "orbit/orbit.hpp"
#include "settings/problem_type.hpp"
#include "stability/bifurcation_tests.hpp"

namespace tchat {

namespace {

/// The principal parameter's part of the tangent, as a share of its largest one on the branch, that is rounding when
/// one end of a step has no more.
constexpr double insignificant_turn = level::tolerance;
/// A part that falls to rounding from this many times more within a step does not fade: the step ends on a fold, or the
/// one before has.
constexpr double sudden = 1e3;
/// An orbit whose states all move by a smaller share of what they did is a point: where the branch was found to turn,
/// known to EPSS, and where Newton's matrix is singular anyway.
constexpr double shrunk_where_located = 1e-3;
/// On curves of folds that matrix is so with the square of the amplitude.
constexpr double folds_shrunk_where_located = 2e-3;
/// So near to a point a branch is followed that leads through it: Newton's matrix is as near to a singular one.
constexpr double shrunk_enough = 0.5 * level::visible;
/// The deviations of orbits before and behind a point are opposite but for what a step changes.
constexpr double opposite = -0.8;
constexpr double shrunk = level::located;

/// How well the parameters are known where a curve of folds ends.
std::string accuracy_of_limits(const std::optional<SmallestOrbit>& end) {
  if (!end || end->uncertainties.empty()) return "; its parameters are those of the last orbit, and less accurate";
  std::string text;
  for (const double uncertainty : end->uncertainties)
    text += fmt::format("{}{:.0e}", text.empty() ? "; its parameters are known to " : " and ", uncertainty);
  return text;
}

/// On arclength: states are known to a share of their size; where steps are far shorter, as those of a parameter in
/// large units, to a share of ten thousand of these.
double location_accuracy(const ContinuationSettings& settings) {
  const double step = std::sqrt(std::abs(settings.step.initial * settings.step.maximum));
  return settings.location_tolerance * (std::min(1.0, 1e4 * settings.step.maximum) + step);
}

LocationSettings location_settings(const ContinuationSettings& settings) {
  return {settings.multipliers, location_accuracy(settings), std::max(settings.max_location, 2), settings.monitored};
}

/// After all others: what else vanishes on a bound gives the point its type.
std::vector<std::unique_ptr<TestFunction>> with_bounds(std::vector<std::unique_ptr<TestFunction>> tests,
                                                       const ContinuationSettings& settings) {
  if (settings.clip)
    for (auto& test : bound_tests(branch_bounds(settings))) tests.push_back(std::move(test));
  return tests;
}

/// Do the multipliers alone show a fold? In a canard explosion the parameter hardly moves. Near a Hopf bifurcation one
/// is near 1 on all orbits.
bool comes_to_multiplier_one(const PointData& before, const PointData& data) {
  constexpr double accurate = 1e-3, near = 1e-2, away = level::visible;
  const FloquetMultipliers& multipliers = data.multipliers;
  return multiplier_distance(before.multipliers, 1.0) > away && multipliers.determined() &&
         !multipliers.are_eigenvalues && multiplier_accuracy(multipliers) <= accurate &&
         multiplier_distance(multipliers, 1.0) <= near;
}

/// "the bounds RL0, RL1", or BOUNDS, which says it.
std::string bounds_text(const BranchBounds& bounds) {
  return (bounds.least_keyword == bounds.most_keyword ? "" : "the bounds ") + bounds.keywords();
}

}  // namespace

std::vector<BranchBounds> branch_bounds(const ContinuationSettings& settings) {
  std::vector<BranchBounds> all;
  all.push_back(
      {settings.principal, settings.principal_name, "RL0", "RL1", settings.parameter_min, settings.parameter_max});
  all.push_back({BranchBounds::solution_measure, "the solution measure", "A0", "A1", settings.measure_min,
                 settings.measure_max, settings.measure, settings.state_weights, settings.state_units});
  all.insert(all.end(), settings.further_bounds.begin(), settings.further_bounds.end());
  std::erase_if(all, [](const BranchBounds& bounds) { return !bounds.is_finite(); });
  return all;
}

bool is_beyond(const ContinuationSettings& settings, const BranchBounds& bounds, double value, double size) {
  const double accuracy = location_accuracy(settings) * size;
  return value < bounds.least - accuracy || value > bounds.most + accuracy;
}

ContinuationRun::ContinuationRun(PathFollower& follower, const DefiningSystem& system, ContinuationSettings settings,
                                 std::vector<std::unique_ptr<TestFunction>> tests, BranchSink& sink)
    : follower_(follower),
      system_(system),
      settings_(std::move(settings)),
      sink_(sink),
      analysis_(system.make_analysis(follower.condensed().shape())),
      search_(follower, system, *analysis_, with_bounds(std::move(tests), settings_), location_settings(settings_)),
      step_(settings_.step),
      trend_(settings_.trend.value_or(OrbitTrend(system.orbits()))),
      closed_(follower, system, analysis_->has_fixed_phase()),
      bounds_(branch_bounds(settings_)) {
  summary_.family = &analysis_->facts();
  for (const auto& test : search_.tests()) test_values_.push_back({test->name(), std::nullopt});
}

BranchSummary ContinuationRun::run(PathPoint start) {
  here_ = std::move(start);
  here_.trail.clear();  // a branch switch begins with a step on another branch
  accepted_ = here_;    // allocates what it needs later
  next_ = {here_, 0.0, search_.begin(here_)};
  number_ = settings_.first_number;
  SpecialPoint special;
  if (settings_.label_start) special.type = PointType::end;
  closed_.begin(here_, settings_.step.initial);
  turned_at_ = parameter_at(here_);
  first_period_ = here_.orbit.period();
  if (settings_.resumes)
    resume();
  else
    accept(end_conditions(special));
  if (const std::string exceeded = exceeded_bound(next_); !ended_ && settings_.may_refine && !exceeded.empty())
    end(EndReason::outgrown, exceeded);

  while (!ended_) {
    prepare_next_step();
    if (!take_step()) {
      if (!ends_beside_point()) give_up();
      break;
    }
    if (!may_go_to_next()) break;
    if (const std::string bound = bound_at_start(); !bound.empty()) {
      end(EndReason::on_bound, bound);
      break;
    }
    const std::optional<double> to_first = move_to_first_point();
    const bool is_there = to_first && std::abs(*to_first) <= location_settings(settings_).same_place();
    special = is_there ? SpecialPoint{} : advance();
    if (to_first) special = end_at_first_point(special, *to_first);
    if (const std::string zero = passed_zero_duration(); !ended_ && !zero.empty()) {
      end(EndReason::no_orbit, zero);
      write_last_again(PointType::end);
      break;
    }
    closed_.add_step(next_.ds);
    std::swap(here_, next_.point);
    ++number_;
    accept(end_conditions(curve_end(special)));
    if (!limited_) step_.converged(iterations_, number_);
    if (!ended_ && settings_.outgrown && settings_.outgrown(here_.orbit)) end(EndReason::outgrown, "");
  }
  summary_.vanishing = search_.vanishing(here_, accepted_data_);
  if (const std::optional<PeriodGrowth> growth = trend_.period_growth())
    summary_.remark = analysis_->tendency(here_.orbit, *growth, settings_.principal_name);
  if (summary_.reason == EndReason::max_points && summary_.remark.empty()) summary_.no_progress = no_progress();
  return summary_;
}

/// The step to here_.
void ContinuationRun::add_to_way() {
  constexpr double nearly = 0.99;
  constexpr double of_size = 2.0;  // that changes are divided by: the value and the size
  ++way_.steps;
  way_.longest += std::abs(next_.ds) >= nearly * settings_.step.maximum;
  way_.length += of_size * follower_.relative_length(here_) * std::abs(next_.ds);
}

/// Where most steps had the length DSMAX and nothing has changed by as much as 5 % of its size.
std::string ContinuationRun::no_progress() const {
  constexpr double no_way = 0.05, change_of_a_step = 0.02;
  constexpr int fewest_steps = 8;
  if (way_.steps < fewest_steps || 2 * way_.longest <= way_.steps || way_.length >= no_way) return "";
  const double longer = settings_.step.maximum * change_of_a_step * way_.steps / way_.length;
  const std::string example = std::isfinite(longer) ? fmt::format(", for example DSMAX={:.0e}", longer) : "";
  return fmt::format(
      "in {} steps, {} of them of length DSMAX = {:g}, nothing has changed by more than {:.0e} of its size: DS and "
      "DSMAX count in the unit of {}, which is {:.6g} here: larger ones go further{}",
      way_.steps, way_.longest, settings_.step.maximum, way_.length, settings_.principal_name, parameter_at(here_),
      example);
}

void ContinuationRun::add_to_trend() {
  const double parameter = here_.orbit.par(settings_.principal - 1);
  trend_.add(here_.orbit, parameter, system_.system().parameter_size(settings_.principal, parameter));
}

/// From a point that was recorded on another discretisation.
void ContinuationRun::resume() {
  mark_accepted();
  accepted_data_ = next_.data;
  add_to_trend();
  summary_.points = number_;
  stability_.begin({number_, parameter_at(here_), {}, accepted_data_.multipliers});
}

/// Where the step to next_ passes the first point of the branch: next_ is moved to just beyond it, so that special
/// points are looked for as far as there, also at the first point itself; here_ is moved to the mesh of the first
/// point. The length of a step to it.
std::optional<double> ContinuationRun::move_to_first_point() {
  if (!settings_.stop_when_closed) return std::nullopt;
  const std::optional<ClosedBranch::Return> way = closed_.on_step(here_, next_.point, next_.ds);
  if (!way) return std::nullopt;
  const double beyond = std::copysign(location_settings(settings_).same_place(), next_.ds);
  Candidate past{next_.point, way->length + beyond, {}};
  const NewtonResult newton = follower_.step(way->from, past.ds, past.point);
  if (!newton.converged()) {
    follower_.linearize_at(next_.point);
    return std::nullopt;
  }
  newton_ = newton;
  count_iterations(way->from, past);
  past.data = search_.evaluate(past.point);
  save_accepted();
  here_ = way->from;
  next_ = std::move(past);
  return way->length;
}

/// The end of a closed branch, `length` from here_, unless a special point comes before it: next_ is moved there.
SpecialPoint ContinuationRun::end_at_first_point(SpecialPoint special, double length) {
  if (ended_) return special;
  const double rest = std::abs(length) - std::abs(next_.ds);
  const bool is_special = special.type != PointType::ordinary;
  if (is_special && rest > location_settings(settings_).same_place()) return special;
  if (!is_special) {
    newton_ = follower_.step(here_, length, next_.point);
    next_.ds = length;
    next_.data = search_.evaluate(next_.point);
  }
  end(EndReason::closed,
      fmt::format("the branch is closed: after {} steps it is back at its first point (CLSTOP=0 goes on)", number_));
  if (!is_special) special = {PointType::end, {}, false, "back at the first point of the branch, which is closed"};
  return special;
}

/// The first special point on the step to next_, which is moved to it. A turn of the parameter that an end of the
/// step shows by no more than rounding is none: so it is where the parameter tends to a limit, at a period without
/// bound.
SpecialPoint ContinuationRun::advance() {
  const SpecialPointSearch::Reports reports{[this](const std::string& text) { sink_.note(number_ + 1, text); },
                                            [this](const std::string& text) { report_lost(text); },
                                            [this](const std::string& name) { report_start(name); }};
  const bool through_point = leads_through_point();
  const double before = std::abs(follower_.principal_direction(here_));
  const double turn = std::min(before, std::abs(follower_.principal_direction(next_.point)));
  steepest_ = std::max(steepest_, before);
  NewtonResult of_shorter_step;
  SpecialPoint special = search_.advance(here_, next_, of_shorter_step, reports).value_or(SpecialPoint{});
  if (of_shorter_step.converged()) {
    newton_ = of_shorter_step;
    count_iterations(here_, next_);
  }
  const double level = insignificant_turn * steepest_;
  const double earlier = std::exchange(before_, before);
  const bool is_visible =
      turn > level || std::max(before, earlier) > sudden * level || comes_to_multiplier_one(accepted_data_, next_.data);
  if (is_fold(special.type) && !(is_visible && turns_visibly(parameter_at(next_.point)))) {
    reports.note(fmt::format("ICP(1) turns by rounding only (its share of the tangent is {:.1e}): no fold", turn));
    return {};
  }
  if (is_fold(special.type)) turned_at_ = parameter_at(next_.point);
  if (special.type == PointType::doubled_fold_end)
    put_end_of_doubled_folds(follower_, system_, here_, next_.ds, next_.point.orbit);
  return shrunk_orbit(special, through_point);
}

/// Has the principal parameter moved by more than an orbit's accuracy since it last turned?
bool ContinuationRun::turns_visibly(double parameter) const {
  const double size = std::max(std::abs(parameter), std::abs(turned_at_));
  return std::abs(parameter - turned_at_) > orbit_accuracy * size;
}

/// Has the step gone through an equilibrium, to the same orbits run through from another point? Then next_ is moved
/// back to short of it. Whatever changes sign there is hardly located, for Newton's matrix is singular.
bool ContinuationRun::leads_through_point() {
  if (!analysis_->may_shrink() || deviation_cosine(here_.orbit, next_.point.orbit, system_.orbits()) > opposite)
    return false;
  const double growth = deviation_growth(here_.orbit, here_.tangent.states, system_.orbits());
  if (!(growth * next_.ds < 0.0)) return false;
  const Approach nearest = approach(follower_, here_, shrinking_amplitude(trend_, system_.orbits()), shrunk_enough);
  const bool found = trend_.has_shrunk(nearest.point.orbit, where_located());
  if (found) {
    next_.point = nearest.point;
    next_.ds = nearest.length;
    newton_ = nearest.newton;
  }
  follower_.linearize_at(next_.point);
  next_.data = search_.evaluate(next_.point);
  return found;
}

/// The share of amplitudes to which Newton's method comes beside a point.
double ContinuationRun::where_located() const {
  return is_curve_of_folds(follower_) ? folds_shrunk_where_located : shrunk_where_located;
}

/// Where the branch turns, or ends of itself, because its orbit has shrunk to a point: the end of the branch.
SpecialPoint ContinuationRun::shrunk_orbit(SpecialPoint special, bool through_point) {
  if (!analysis_->may_shrink()) return special;
  const bool turns =
      through_point || special.type == PointType::fold || special.kind.kind == UserPointKind::impact_velocity;
  return trend_.has_shrunk(next_.point.orbit, turns ? where_located() : shrunk) ? end_at_point() : special;
}

/// Makes next_ the end of the branch, whose orbit is a point.
SpecialPoint ContinuationRun::end_at_point() {
  const bool are_folds = is_curve_of_folds(follower_);
  std::optional<SmallestOrbit> smallest = smallest_orbit(follower_, system_, here_, trend_);
  if (smallest) next_.point = std::move(smallest->point);
  next_.data = search_.evaluate_again(next_.point);
  SpecialPoint special = analysis_->shrunk(next_.point.orbit, are_folds);
  if (are_folds) special.description += accuracy_of_limits(smallest);
  end(EndReason::equilibrium, special.description);
  return special;
}

/// Does a curve of folds end at here_, from which no step leads on, because it is beside a point?
bool ContinuationRun::ends_beside_point() {
  constexpr double beside = 10.0;  // times the amplitude to which steps may lead
  const bool may_be = analysis_->may_shrink() && is_curve_of_folds(follower_);
  if (!may_be || !trend_.has_shrunk(here_.orbit, beside * where_located())) return false;
  next_.point = here_;
  const SpecialPoint special = end_at_point();
  std::swap(here_, next_.point);
  ++number_;
  accept(end_conditions(special));
  return true;
}

/// A two-parameter curve may be left without a special point where it ends: from a start there, or when it was missed.
SpecialPoint ContinuationRun::curve_end(SpecialPoint special) {
  const OrbitCondition* condition = follower_.condition();
  if (ended_ || special.ends_branch || condition == nullptr) return special;
  const std::string reason = condition->beyond_end();
  if (reason.empty()) return special;
  end(EndReason::curve_end, reason);
  return {PointType::end, {}, false, reason};
}

/// Sets iterations_ for the step that newton_ made.
void ContinuationRun::count_iterations(const PathPoint& from, Candidate& to) {
  iterations_ = newton_.iterations;
  if (limited_ || !step_.adapts_at(number_ + 1) || (newton_.from_tangent && !is_doubtful_)) return;
  const IterationRange range = follower_.iterations_along_tangent(from, to.ds, to.point, !step_.is_longest());
  is_doubtful_ = step_.after(range.least) != step_.after(range.most);
  if (newton_.from_tangent) return;
  iterations_ = is_doubtful_ ? tried_along_tangent(from, to) : range.most;
}

/// The step again, from the tangent, for its number of iterations; where that fails, those of the step that was made.
int ContinuationRun::tried_along_tangent(const PathPoint& from, Candidate& to) {
  PathPoint trial = to.point;
  const NewtonResult newton = follower_.step_along_tangent(from, to.ds, trial);
  if (newton.converged())
    to.point.newton_constant = trial.newton_constant;
  else
    follower_.linearize_at(to.point);
  return newton.converged() ? newton.iterations : newton_.iterations;
}

/// Where the period has become long, or steps short, a branch that passes infinity ends without a further approach.
bool ContinuationRun::is_near_end() const {
  constexpr double long_period = 100.0;  // as a multiple of the first one
  return step_.is_short() || std::abs(here_.orbit.period()) > long_period * std::abs(first_period_);
}

/// Predicts and corrects, halving the step until it succeeds. False when it cannot be made any smaller.
bool ContinuationRun::take_step() {
  passed_.clear();
  for (;;) {
    next_.ds = search_.limited(step_.value());
    limited_ = next_.ds != step_.value();
    newton_ = is_doubtful_ ? follower_.step_along_tangent(here_, next_.ds, next_.point)
                           : follower_.step(here_, next_.ds, next_.point);
    const bool converged = newton_.converged();
    if (converged) count_iterations(here_, next_);
    std::string trouble;
    if (!converged)
      trouble = describe(newton_.status);
    else if (std::string passed = is_near_end() ? "" : passed_end(); !passed.empty())
      trouble = passed_ = std::move(passed);
    else if (!step_.is_short() && !search_.same_branch(here_, next_.point))
      trouble = "it may have come to another branch";
    else if (search_.evaluate(next_.point, next_.data); !step_.is_short() && !search_.resolved(here_, next_))
      trouble = "a test function may have changed sign twice";
    else if (std::string lost = lost_multiplier(follower_.condition(), next_.data); !step_.is_short() && !lost.empty())
      trouble = std::move(lost);
    else
      return true;
    if (!converged && is_moved_ && here_.orbit.mesh != accepted_.orbit.mesh) {
      here_ = accepted_;
      is_moved_ = false;
      sink_.note(number_ + 1, fmt::format("Retrying step ({}): on the mesh before its adaptation", trouble));
      continue;
    }
    if (!step_.failed()) return converged;
    sink_.note(number_ + 1, fmt::format("Retrying step ({}): ds = {:.4e}", trouble, step_.value()));
  }
}

/// Where a branch of doubled orbits meets the one that it was born from, its mesh, which is not that of one turn twice
/// over, may lead on along that one.
std::string ContinuationRun::shorter_orbit() {
  constexpr int enough = 3;  // points
  const int parts = analysis_->like_parts(here_.orbit);
  points_in_parts_ = parts == 1 ? 0 : points_in_parts_ + 1;
  has_whole_orbits_ = has_whole_orbits_ || parts == 1;
  if (!has_whole_orbits_ || points_in_parts_ < enough) return "";
  return fmt::format("the last {} orbits are those of {} of the period, run {}: the branch ends where these are born",
                     enough, parts == 2 ? "half" : "a third", parts == 2 ? "twice" : "three times");
}

/// What the point here_ is after all: special already, the end of the branch, a regular output point, or nothing.
SpecialPoint ContinuationRun::end_conditions(SpecialPoint special) {
  const BranchBounds* left = nullptr;
  double value = 0.0;
  for (const BranchBounds& bounds : bounds_) {
    const double here = bounds.value(here_.orbit, follower_.condensed().rule());
    const double size = system_.system().parameter_size(bounds.parameter, here);
    if (is_beyond(settings_, bounds, here, size)) special = {};  // special points outside of the bounds are not wanted
    if (left != nullptr || !(here < bounds.least || here > bounds.most)) continue;
    left = &bounds;
    value = here;
  }
  if (ended_) return special;
  const bool is_special = special.type != PointType::ordinary && special.type != PointType::end;
  summary_.stopped_at_grazing =
      special.ends_branch &&
      (special.kind.kind == UserPointKind::contact || special.kind.kind == UserPointKind::impact_velocity ||
       special.kind.kind == UserPointKind::rule || special.kind.kind == UserPointKind::boundary_equilibrium);
  summary_.stopped_at_border = special.ends_branch && special.kind.kind == UserPointKind::chatter;
  if (is_special && (special.ends_branch || (settings_.stop_at && settings_.stop_at(special))))
    end(EndReason::special_point, special.description);
  else if (special.ends_branch)
    end(EndReason::on_bound, special.description);
  else if (left != nullptr)
    end(EndReason::beyond_bound,
        fmt::format("{} {} {}: it is {:.10g}, allowed are {:.10g} to {:.10g}", left->quantity,
                    number_ > 1 ? "left" : "starts outside", bounds_text(*left), value, left->least, left->most));
  else if (number_ >= settings_.max_points)
    end(EndReason::max_points, fmt::format("NMX = {}", settings_.max_points));
  else if (settings_.interrupted && settings_.interrupted())
    end(EndReason::interrupted, "");
  else if (const std::string none = system_.why_no_solution(here_.orbit); !none.empty())
    end(EndReason::no_orbit, none);
  else if (const std::string released = tangent_release(follower_, system_, here_); !released.empty())
    end(EndReason::no_orbit, released);
  else if (const std::string shorter = shorter_orbit(); !shorter.empty())
    end(EndReason::no_orbit, shorter);
  else if (const std::string why = settings_.unresolved ? settings_.unresolved(here_.orbit) : ""; !why.empty())
    end(EndReason::unresolved, why);
  if (is_special) return special;
  if (ended_)
    special.type = PointType::end;
  else if (special.type == PointType::ordinary && settings_.print_every > 0 && number_ % settings_.print_every == 0 &&
           (number_ > 1 || settings_.label_start))
    special.type = PointType::regular;
  return special;
}

/// Is called before here_ is moved.
void ContinuationRun::save_accepted() {
  if (!is_moved_) accepted_ = here_;
  is_moved_ = true;
}

/// here_ is the last accepted point, as it was accepted.
void ContinuationRun::mark_accepted() {
  is_moved_ = false;
  accepted_.trail.clear();  // its marks can be used again
  accepted_parameter_ = parameter_at(here_);
}

/// here_ with what the search knows of it.
void ContinuationRun::accept(const SpecialPoint& special) {
  report_passed_points();
  if (settings_.reports_stability) {
    const bool is_reported = summary_.lost.size() > lost_before_;
    const auto change = stability_.add({number_, parameter_at(here_), special, next_.data.multipliers}, is_reported);
    if (change && change->is_through_one && !follower_.held().empty())
      sink_.note(number_, fmt::format("At fixed parameters {}; a curve that holds monitors need have none there",
                                      change->point.text));
    else if (change)
      report(change->point);
    lost_before_ = summary_.lost.size();
  }
  mark_accepted();
  if (number_ > settings_.first_number) add_to_way();
  accepted_data_ = next_.data;
  if (special.type != PointType::ordinary) accepted_data_.details = search_.details(here_, accepted_data_);
  add_to_trend();
  record(special, accepted_data_);
}

/// Between the last accepted point and here_.
void ContinuationRun::report_passed_points() {
  for (std::size_t i = 0; i < search_.tests().size() && !accepted_data_.tests.empty(); ++i) {
    const TestFunction& test = *search_.tests()[i];
    const int before = accepted_data_.tests[i].sign;
    const int now = next_.data.tests[i].sign;
    if (!test.is_only_reported() || before * now >= 0) continue;
    const TestedPoint at = search_.tested(here_, next_.data);
    sink_.passed({number_, test.classify(at, now > 0).description, accepted_parameter_, parameter_at(here_)});
  }
}

void ContinuationRun::record(const SpecialPoint& special, const PointData& data) {
  constexpr double errors_of_location = 100.0;  // that h_x f of one segment may have where another one's vanishes
  const bool is_located = special.kind.kind == UserPointKind::impact_velocity || !special.further.empty();
  const double leaving =
      is_located ? std::max(no_transversality, errors_of_location * settings_.location_tolerance) : no_transversality;
  const std::vector<Violation> violations =
      inadmissibilities(system_.system(), system_.signature(), settings_.monitored, here_.orbit, data.courses,
                        follower_.condensed().rule(), data.estimated_error, leaving);
  for (std::size_t i = 0; i < test_values_.size(); ++i) test_values_[i].value = data.tests[i].value;
  BranchPoint point{number_,
                    special,
                    here_,
                    data.multipliers,
                    violations,
                    data.estimated_error,
                    newton_.iterations,
                    follower_.newton().history(),
                    number_ > 1 ? next_.ds : 0.0,
                    test_values_,
                    data.details};
  if (settings_.remark) point.remark = settings_.remark(here_.orbit);
  for (const std::string& more :
       {special.remark, settings_.label_remark && point.labelled() ? settings_.label_remark(here_.orbit) : ""})
    if (!more.empty()) point.remark += (point.remark.empty() ? "" : "; ") + more;
  summary_.points = number_;
  summary_.inadmissible_points += !violations.empty();
  summary_.multipliers_computed = settings_.multipliers;
  summary_.critical_curve = follower_.condition() != nullptr;
  if (settings_.multipliers) {
    const Stability stability = data.multipliers.stability();
    summary_.unstable_points += stability == Stability::unstable;
    summary_.undetermined_points += stability == Stability::unknown;
    summary_.neutral_points += !is_bifurcation(special.type) && data.multipliers.neutral();
  }
  summary_.has_structural = summary_.has_structural || !data.multipliers.is_flow_lost;
  if (!data.multipliers.is_flow_lost)
    summary_.worst_structural = std::max(summary_.worst_structural, data.multipliers.structural);
  summary_.has_trivial = data.multipliers.has_trivial;
  if (const std::optional<double> lambda = system_.unfolding(here_.orbit); lambda && system_.conserved_quantities() > 0)
    summary_.worst_unfolding = std::max(summary_.worst_unfolding.value_or(0.0), std::abs(*lambda));
  summary_.worst_estimated_error = std::max(summary_.worst_estimated_error, point.estimated_error);
  sink_.point(point);
}

void ContinuationRun::end(EndReason reason, std::string detail) {
  ended_ = true;
  summary_.reason = reason;
  summary_.detail = std::move(detail);
}

/// Where multipliers are lost and the parameter stands still to its accuracy, what changes sign is rounding.
void ContinuationRun::report_lost(const std::string& text) {
  const double from = parameter_at(here_), to = parameter_at(next_.point);
  const bool stands_still = std::abs(to - from) <= orbit_accuracy * std::max(std::abs(from), std::abs(to));
  if (next_.data.multipliers.is_flow_lost && stands_still)
    sink_.note(number_ + 1, text);
  else
    report({number_ + 1, text, from, to});
}

void ContinuationRun::report(const LostPoint& point) {
  summary_.lost.push_back(point);
  sink_.lost(point);
}

/// A start from a label is known for what it is.
void ContinuationRun::report_start(const std::string& test_name) {
  if (number_ == 1 && settings_.label_start)
    sink_.starts_at_zero(test_name);
  else
    sink_.note(number_, fmt::format("The run starts at a zero of {}: no label of its own", test_name));
}

/// A new mesh where it is due, and the step length for the d-file.
void ContinuationRun::prepare_next_step() {
  if (settings_.adapt_mesh_every > 0 && here_.orbit.shape.intervals > 1 && number_ % settings_.adapt_mesh_every == 0) {
    const std::vector<double>& mesh =
        equidistribution_.mesh(here_.orbit, follower_.condensed().rule(), here_.orbit.shape.intervals);
    save_accepted();
    follower_.change_mesh(here_, equidistribution_.shape(), mesh);
  }
  sink_.next_step(number_, step_.value());
}

/// The branch ends abnormally: the last converged point is written once more as it was accepted, as MX. The history
/// of Newton's method is that of the last trial, which failed.
void ContinuationRun::give_up() {
  std::string trouble = describe(newton_.status);
  if (newton_.status == NewtonStatus::not_finite) {
    const std::string where = evaluation_failure(system_, follower_.condensed().rule(), next_.point.orbit);
    if (!where.empty()) trouble = where;
    summary_.undefined_function = true;
  }
  if (!passed_.empty()) {
    end(EndReason::no_orbit, passed_);
    write_last_again(PointType::end);
    return;
  }
  end(number_ == 1 ? EndReason::first_step_failed : EndReason::no_convergence,
      fmt::format("{}; steps down to {:.3e} were tried", trouble, std::abs(next_.ds)));
  sink_.note(number_ + 1, settings_.step.adapt_every == 0 ? "No convergence with fixed step size"
                                                          : "No convergence using minimum step size");
  write_last_again(PointType::no_convergence);
}

/// The last accepted point, as it was accepted, with the label and reason of the branch's end.
void ContinuationRun::write_last_again(PointType type) {
  ++number_;
  SpecialPoint special;
  special.type = type;
  special.description = summary_.detail;
  if (is_moved_) std::swap(here_, accepted_);
  record(special, accepted_data_);
}

/// Before any special point is looked for on the step: one on the way to what is no orbit, or none that the mesh
/// resolves, would have no evidence. False where the branch ends or goes on with another mesh.
bool ContinuationRun::may_go_to_next() {
  if (const std::string passed = passed_end(); !passed.empty()) {
    end(EndReason::no_orbit, passed);
  } else if (const std::string lost = lost_multiplier(follower_.condition(), next_.data); !lost.empty()) {
    end(EndReason::curve_end, fmt::format("beyond this point {}: there the curve ends", lost));
  } else {
    const std::string exceeded = exceeded_bound(next_);
    if (exceeded.empty()) return true;
    end(settings_.may_refine ? EndReason::outgrown : EndReason::unresolved, exceeded);
  }
  if (summary_.reason != EndReason::outgrown) write_last_again(PointType::end);
  return false;
}

std::string ContinuationRun::exceeded_bound(const Candidate& at) const {
  return unresolved_by_mesh(system_, at.point.orbit, at.data, settings_.error_bound);
}

std::string ContinuationRun::passed_end() const {
  return end_text(analysis_->passed_infinity(here_, next_.point, next_.ds));
}

/// Of a branch that is to end on its bounds, starts on one of them, and goes beyond it.
std::string ContinuationRun::bound_at_start() const {
  if (!settings_.clip || number_ != settings_.first_number) return "";
  for (const BranchBounds& bounds : bounds_) {
    const double from = bounds.value(here_.orbit, follower_.condensed().rule());
    const double to = bounds.value(next_.point.orbit, follower_.condensed().rule());
    const double size = system_.system().parameter_size(bounds.parameter, from);
    if (is_beyond(settings_, bounds, from, size) || !is_beyond(settings_, bounds, to, size)) continue;
    const double bound = to > from ? bounds.most : bounds.least;
    if (std::abs(from - bound) <= location_accuracy(settings_) * size)
      return fmt::format("{} = {:.10g}, the bound {}, where the branch starts", bounds.quantity, from,
                         to > from ? bounds.most_keyword : bounds.least_keyword);
  }
  return "";
}

std::string ContinuationRun::passed_zero_duration() const {
  const Orbit& beyond = next_.point.orbit;
  if (const std::string what = analysis_->passed_zero(here_.orbit, beyond); !what.empty()) return end_text(what);
  const std::string what = settings_.negative_durations ? "" : analysis_->passed_zero_segment(here_.orbit, beyond);
  const std::string cure =
      number_ == settings_.first_number ? fmt::format("; DS={:g} leads the other way", -settings_.step.initial) : "";
  return what.empty() ? "" : end_text(what) + cure + "; with GRSTOP=0 it goes on";
}

/// "" for "".
std::string ContinuationRun::end_text(const std::string& what) const {
  if (what.empty()) return "";
  return fmt::format("between {} = {:.8g} and {:.8g} {}: there the branch of orbits ends", settings_.principal_name,
                     parameter_at(here_), parameter_at(next_.point), what);
}

double ContinuationRun::parameter_at(const PathPoint& point) const { return point.orbit.par(settings_.principal - 1); }

}  // namespace tchat
