#include "continuation/continuation_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bvp/evaluation_failure.hpp"
#include "bvp/mesh_adaptation.hpp"
#include "continuation/solution_measure.hpp"
#include "special_points/locator.hpp"

namespace tchat {

ContinuationRun::ContinuationRun(PathFollower& follower, const DefiningSystem& system, ContinuationSettings settings,
                                 std::vector<std::unique_ptr<TestFunction>> tests, BranchSink& sink)
    : follower_(follower),
      system_(system),
      settings_(std::move(settings)),
      tests_(std::move(tests)),
      sink_(sink),
      floquet_(follower.condensed().shape()),
      step_(settings_.step),
      values_(tests_.size()),
      zero_levels_(tests_.size()),
      here_values_(tests_.size()),
      signs_(tests_.size()) {}

BranchSummary ContinuationRun::run(PathPoint start) {
  here_ = std::move(start);
  next_ = here_;
  follower_.linearize_at(here_);
  evaluate(here_);
  for (std::size_t i = 0; i < tests_.size(); ++i) signs_[i] = sign_of(i);
  here_values_ = values_;
  SpecialPoint special;
  if (settings_.label_start) special.type = PointType::end;
  record(end_conditions(special));

  while (!ended_) {
    prepare_next_step();
    if (!take_step()) {
      give_up();
      break;
    }
    evaluate(next_);
    const std::optional<Zero> zero = first_zero();
    special = zero ? move_to(*zero) : SpecialPoint{};
    for (std::size_t i = 0; i < tests_.size(); ++i)
      signs_[i] = zero && zero->test == i ? zero->sign_after : sign_of(i) != 0 ? sign_of(i) : signs_[i];
    std::swap(here_, next_);
    here_values_ = values_;
    ++number_;
    record(end_conditions(special));
    step_.converged(newton_.iterations, number_);
  }
  return summary_;
}

/// Predicts and corrects, halving the step until it succeeds. False when it cannot be made any smaller.
bool ContinuationRun::take_step() {
  for (;;) {
    newton_ = follower_.step(here_, step_.value(), next_);
    ds_taken_ = step_.value();
    if (newton_.converged()) return true;
    if (!step_.failed()) return false;
    sink_.note(number_ + 1, fmt::format("Retrying step ({}): ds = {:.4e}", describe(newton_.status), step_.value()));
  }
}

void ContinuationRun::evaluate(const PathPoint& at) {
  if (settings_.multipliers) multipliers_ = floquet_.compute(follower_.condensed(), at.orbit);
  measure_ = solution_measure(at.orbit, follower_.condensed().rule(), settings_.state_weights, settings_.measure);
  const TestedPoint point = tested(at);
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    values_[i] = tests_[i]->value(point);
    zero_levels_[i] = tests_[i]->zero_level(point);
  }
}

int ContinuationRun::sign_of(std::size_t test) const {
  if (!values_[test] || std::abs(*values_[test]) <= zero_levels_[test]) return 0;
  return *values_[test] > 0.0 ? 1 : -1;
}

/// The first zero of any test function on the step to next_, if one has changed sign.
std::optional<ContinuationRun::Zero> ContinuationRun::first_zero() {
  std::vector<Zero> zeros;
  std::vector<std::size_t> crossed;
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    if (!values_[i] || signs_[i] == 0 || sign_of(i) == signs_[i]) continue;
    if (sign_of(i) == 0)
      zeros.push_back({i, ds_taken_, 0, true});
    else if (here_values_[i])
      crossed.push_back(i);
  }
  for (const std::size_t i : crossed) {
    const Zero zero = locate(i);
    if (zero.converged)
      zeros.push_back(zero);
    else
      sink_.note(number_ + 1, fmt::format("Possible special point: {} changes sign, but its zero was not located",
                                          tests_[i]->name()));
  }
  const auto nearer = [](const Zero& a, const Zero& b) { return std::abs(a.ds) < std::abs(b.ds); };
  const auto first = std::min_element(zeros.begin(), zeros.end(), nearer);
  if (!crossed.empty()) {
    // Trial steps have moved next_: compute it again, where the branch goes on.
    const double ds = first == zeros.end() ? ds_taken_ : first->ds;
    newton_ = follower_.step(here_, ds, next_);
    ds_taken_ = ds;
    if (newton_.converged()) evaluate(next_);
  }
  return first == zeros.end() ? std::nullopt : std::optional<Zero>(*first);
}

ContinuationRun::Zero ContinuationRun::locate(std::size_t test) {
  const double far_value = *values_[test];
  const double rounding = 1e-5 * zero_levels_[test];
  const double tolerance =
      settings_.location_tolerance * (1.0 + std::sqrt(std::abs(settings_.step.initial * settings_.step.maximum)));
  const auto at = [&](double ds) -> std::optional<double> {
    if (!follower_.step(here_, ds, next_).converged()) return std::nullopt;
    if (settings_.multipliers) multipliers_ = floquet_.compute(follower_.condensed(), next_.orbit);
    return tests_[test]->value(tested(next_));
  };
  const LocatedZero zero = locate_zero(at, ds_taken_, *here_values_[test], far_value, tolerance, rounding,
                                       std::max(settings_.max_location, 2));
  return {test, zero.ds, far_value > 0.0 ? 1 : -1, zero.converged};
}

SpecialPoint ContinuationRun::move_to(const Zero& zero) {
  const bool rising = signs_[zero.test] < 0;
  return tests_[zero.test]->classify(tested(next_), rising);
}

/// What the point here_ is after all: special already, the end of the branch, a regular output point, or nothing.
SpecialPoint ContinuationRun::end_conditions(SpecialPoint special) {
  const double principal = here_.orbit.par(settings_.principal - 1);
  const bool is_special = special.type != PointType::ordinary && special.type != PointType::end;
  if (is_special && (special.ends_branch || (settings_.stop_at && settings_.stop_at(special))))
    end(EndReason::special_point, special.description);
  else if (principal < settings_.parameter_min || principal > settings_.parameter_max)
    end(EndReason::parameter_bound, fmt::format("it is {:.10g}, allowed are {:.10g} to {:.10g}", principal,
                                                settings_.parameter_min, settings_.parameter_max));
  else if (measure_ < settings_.measure_min || measure_ > settings_.measure_max)
    end(EndReason::measure_bound, fmt::format("it is {:.10g}, allowed are {:.10g} to {:.10g}", measure_,
                                              settings_.measure_min, settings_.measure_max));
  else if (number_ >= settings_.max_points)
    end(EndReason::max_points, fmt::format("NMX = {}", settings_.max_points));
  else if (settings_.interrupted && settings_.interrupted())
    end(EndReason::interrupted, "");
  if (is_special) return special;
  if (ended_)
    special.type = PointType::end;
  else if (special.type == PointType::ordinary && settings_.print_every > 0 && number_ % settings_.print_every == 0 &&
           (number_ > 1 || settings_.label_start))
    special.type = PointType::regular;
  return special;
}

void ContinuationRun::record(const SpecialPoint& special) {
  const std::vector<Violation> violations =
      inadmissibilities(system_.system(), system_.signature(), settings_.monitored, here_.orbit);
  BranchPoint point{number_,
                    special,
                    here_,
                    multipliers_,
                    violations,
                    measure_,
                    estimated_error(here_.orbit, follower_.condensed().rule()),
                    newton_.iterations,
                    follower_.newton().history(),
                    number_ > 1 ? ds_taken_ : 0.0,
                    {}};
  for (std::size_t i = 0; i < tests_.size(); ++i) point.tests.push_back({tests_[i]->name(), values_[i]});
  summary_.points = number_;
  summary_.inadmissible_points += !violations.empty();
  summary_.multipliers_computed = settings_.multipliers;
  summary_.unstable_points += settings_.multipliers && !multipliers_.stable();
  summary_.worst_structural = std::max(summary_.worst_structural, multipliers_.structural);
  summary_.worst_estimated_error = std::max(summary_.worst_estimated_error, point.estimated_error);
  sink_.point(point);
}

void ContinuationRun::end(EndReason reason, std::string detail) {
  ended_ = true;
  summary_.reason = reason;
  summary_.detail = std::move(detail);
}

/// A new mesh where it is due, and the step length for the d-file.
void ContinuationRun::prepare_next_step() {
  if (settings_.adapt_mesh_every > 0 && number_ % settings_.adapt_mesh_every == 0)
    follower_.change_mesh(here_,
                          equidistributed_mesh(here_.orbit, follower_.condensed().rule(), here_.orbit.shape.intervals));
  sink_.next_step(number_, step_.value());
}

/// The branch ends abnormally: the last converged point is written once more, as MX.
void ContinuationRun::give_up() {
  std::string trouble = describe(newton_.status);
  if (newton_.status == NewtonStatus::not_finite) {
    const std::string where = evaluation_failure(system_, follower_.condensed().rule(), next_.orbit);
    if (!where.empty()) trouble = where;
  }
  end(number_ == 1 ? EndReason::first_step_failed : EndReason::no_convergence,
      fmt::format("{}; steps down to {:.3e} were tried", trouble, std::abs(ds_taken_)));
  sink_.note(number_ + 1, settings_.step.adapt_every == 0 ? "No convergence with fixed step size"
                                                          : "No convergence using minimum step size");
  ++number_;
  SpecialPoint special;
  special.type = PointType::no_convergence;
  special.description = summary_.detail;
  record(special);
}

}  // namespace tchat
