#include "kinds/families.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "continuation/branch_limits.hpp"
#include "continuation/orbit_trend.hpp"
#include "continuation/solution_measure.hpp"
#include "files/orbit_trace.hpp"
#include "kinds/orbit_check.hpp"
#include "model/events.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/equilibrium_system.hpp"
#include "orbit/ring_system.hpp"
#include "settings/run_settings.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/equilibrium_tests.hpp"

namespace tchat {

std::span<const ProblemType* const> problem_types() {
  static const std::vector<const ProblemType*> all = [] {
    std::vector<const ProblemType*> list;
    for (const auto& types :
         {periodic_orbit_types(), grazing_types(), torus_types(), boundary_value_types(), equilibrium_types()})
      list.insert(list.end(), types.begin(), types.end());
    return list;
  }();
  return all;
}

// What most families do.

std::string SolutionFamily::mismatch(const LabelledSolution& label, const RunSettings& settings) const {
  const auto states = static_cast<Eigen::Index>(settings.segments.size()) * settings.dimension;
  if (!is_same_problem_type(label.problem_type, settings.problem_type))
    return fmt::format("computed with IPS = {}, the constants have {}", label.problem_type, settings.problem_type);
  if (label.states.rows() == states) return "";
  return fmt::format("has {} states, the constants {} segments of {}", label.states.rows(), settings.segments.size(),
                     settings.dimension);
}

OrbitTrace SolutionFamily::trace(const LabelledSolution& label, const std::string& name, int dimension,
                                 const std::string& path) const {
  return orbit_trace(label, name, dimension, path);
}

OrbitTrace SolutionFamily::section_trace(const LabelledSolution& label, const std::string&, int,
                                         const std::string& path) const {
  throw UserError(
      fmt::format("--section: label {} of {} is no torus (IPS = {}), and its orbit no curve on a section; leave "
                  "--section out",
                  label.label, path, label.problem_type));
}

std::map<int, LineKind> SolutionFamily::label_kinds(const std::string& solution_path) const {
  return tchat::label_kinds(solution_path);
}

namespace {

/// An orbit whose period is a smaller part of its start's is the empty orbit that every event surface has: x_s(0) =
/// x_s(1) with T_s = 0 for all s satisfies every condition where h = 0 and g(x) = x.
constexpr double vanishing_period = level::same;
/// An orbit whose states all move by a smaller part of what they did at the start, or by no more than Newton's method
/// ends with, is an equilibrium.
constexpr double vanishing_range = level::visible;
constexpr double no_range = level::tolerance;

/// The angular frequency with which an orbit of this period that has shrunk to the point x goes around it, if the flow
/// is smooth there and the period is that of the linear oscillation.
std::optional<double> hopf_frequency(const DefiningSystem& system, const Orbit& x) {
  constexpr double accuracy = 1e-2;
  if (!is_smooth(system)) return std::nullopt;
  const FloquetMultipliers eigenvalues = equilibrium_eigenvalues(system, x);
  const EigenvaluePair pair = hopf_pairs(eigenvalues.values).nearest;
  const double omega = std::abs(pair.first.imag());
  const bool same_period = std::abs(omega * x.period() - 2.0 * std::numbers::pi) < accuracy * 2.0 * std::numbers::pi;
  return pair.is_oscillation() && pair.distance < accuracy && same_period ? std::optional(omega) : std::nullopt;
}

}  // namespace

const FamilyFacts& RingAnalysis::facts() const { return periodic_orbit_family().facts(); }

bool RingAnalysis::has_fixed_phase() const {
  const Signature& signature = system_.signature();
  return std::none_of(signature.begin(), signature.end(),
                      [](const IndexVector& index) { return index.event == no_function; });
}

SpecialPoint RingAnalysis::shrunk(const Orbit& x, bool are_folds) const {
  std::optional<double> omega = hopf_frequency(system_, x);
  const bool is_family = system_.conserved_quantities() > 0;  // at an equilibrium that need not change its stability
  const char* what = is_family ? "linear oscillation" : are_folds ? "generalised Hopf point" : "Hopf bifurcation";
  const PointType type = !omega || is_family ? PointType::end
                         : are_folds         ? PointType::generalized_hopf
                                             : PointType::hopf;
  const int n = x.shape.dimension;
  const CollocationRule rule(x.shape.collocation);
  Eigen::VectorXd point = Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index i) {
    return solution_measure(x, rule, Eigen::VectorXd::Ones(n), n + 1 + static_cast<int>(i));
  });
  if (omega) {  // means differ from the equilibrium by the square of the amplitude
    const int field = system_.signature().front().field;
    const Eigen::VectorXd sizes = state_sizes(system_.system(), system_.signature(), x);
    if (const auto found = find_equilibrium(system_.system(), field, point, x.par.data(), {}, sizes)) {
      point = found->state;
      Orbit equilibrium = x;
      equilibrium.states.colwise() = point;
      omega = hopf_frequency(system_, equilibrium).value_or(*omega);
    }
  }
  return {type,
          {},
          false,
          fmt::format("the orbit has shrunk to a point, {}: an equilibrium, where the {} ends{}",
                      state_text(system_.system(), x, point.data()),
                      are_folds ? "curve of folds" : "branch of periodic orbits",
                      omega ? fmt::format(" ({}, omega = {:.10g})", what, *omega) : "")};
}

std::string RingAnalysis::passed_infinity(const PathPoint& from, const PathPoint& to, double ds) const {
  const std::string what = tchat::passed_infinity(from, to, ds);
  return what.empty() ? undetermined_duration(system_, to.orbit) : what;
}

std::string RingAnalysis::passed_zero(const Orbit& from, const Orbit& to) const { return tchat::passed_zero(from, to); }

std::string RingAnalysis::passed_zero_segment(const Orbit& from, const Orbit& to) const {
  return tchat::passed_zero_segment(from, to);
}

namespace {

/// Do an orbit's segments, or its one segment that no event ends, have parts that are alike?
bool has_parts(const DefiningSystem& system, const Orbit& x, int parts) {
  const int m = x.shape.segments;
  if (m == 1) return !system.has_event(0);
  if (m % parts != 0) return false;
  const Signature& signature = system.signature();
  for (int s = 0; s < m; ++s)
    if (signature[static_cast<std::size_t>(s)] != signature[static_cast<std::size_t>((s + m / parts) % m)])
      return false;
  return true;
}

/// Is an orbit what it is a part of the period later, each state to 1e-4 of its range?
bool is_alike_later(const Orbit& x, const CollocationRule& rule, int parts) {
  constexpr double same = level::visible;
  const int m = x.shape.segments, n = x.shape.dimension;
  StackVector most(n), now(n), later(n);
  for (int i = 0; i < n; ++i) {
    const double low = x.states.row(i).minCoeff(), high = x.states.row(i).maxCoeff();
    most(i) = same * std::max(high - low, level::orbit * std::max(std::abs(low), std::abs(high)));
  }
  const auto are_alike = [&](const double* a, const double* b) {
    for (int i = 0; i < n; ++i)
      if (std::abs(a[i] - b[i]) > most(i)) return false;
    return true;
  };
  for (int s = 0; m > 1 && s < m; ++s)
    if (!are_alike(x.end(s), x.end((s + m / parts) % m))) return false;
  for (int j = 0; m == 1 && j <= x.shape.intervals_of(0) && x.mesh_of(0)[j] + 1.0 / parts <= 1.0; ++j) {
    state_at(x, rule, 0, x.mesh_of(0)[j], now.data());
    state_at(x, rule, 0, x.mesh_of(0)[j] + 1.0 / parts, later.data());
    if (!are_alike(now.data(), later.data())) return false;
  }
  return true;
}

}  // namespace

int RingAnalysis::like_parts(const Orbit& x) const {
  for (const int parts : {2, 3})
    if (has_parts(system_, x, parts) && is_alike_later(x, rule_, parts)) return parts;
  return 1;
}

std::string RingAnalysis::tendency(const Orbit& x, const PeriodGrowth& growth,
                                   const std::string& parameter_name) const {
  return homoclinic_limit(system_, x, growth, parameter_name);
}

std::string RingAnalysis::why_no_solution(const Orbit& first, const Orbit& start, const std::string& source) const {
  if (!(first.period() > vanishing_period * std::abs(start.period())))
    return fmt::format(
        "Newton left the start from {}, of period {:.6g}, for an orbit of period {:.1e}: a point, no orbit; "
        "the start is too far from an orbit of this signature or the mesh too coarse, so improve the start "
        "or raise NTST",
        source, start.period(), first.period());
  const Eigen::VectorXd least =
      (vanishing_range * state_ranges(start)).cwiseMax(no_range * (1.0 + first.states.cwiseAbs().maxCoeff()));
  if ((state_ranges(first).array() > least.array()).any()) return "";
  return fmt::format(
      "Newton left the start from {} for an orbit on which no state moves by more than {:.1e}: an "
      "equilibrium, no orbit; the start is too far from an orbit of this signature, or there is none at "
      "these parameters",
      source, state_ranges(first).maxCoeff());
}

std::string RingAnalysis::start_advice(const Orbit& start) const {
  const bool rests = !system_.has_event(0) && (start.states.colwise() - start.states.col(0)).isZero(0.0);
  return rests
             ? "All states of the start are equal. Without a section (GCHIND = [0]) the start must be a closed orbit; "
               "IPS = 1 continues equilibria."
             : BranchAnalysis::start_advice(start);
}

std::unique_ptr<BranchAnalysis> RingSystem::make_analysis(const OrbitShape& shape) const {
  return std::make_unique<RingAnalysis>(*this, shape);
}

std::unique_ptr<BranchAnalysis> UnfoldedSystem::make_analysis(const OrbitShape& shape) const {
  return ring_->make_analysis(shape);
}

}  // namespace tchat
