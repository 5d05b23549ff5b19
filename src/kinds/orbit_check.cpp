#include "kinds/orbit_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "orbit/admissibility.hpp"
#include "resegment/contact_point.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// h_x f / (|h_x| |f|) below this: not divided by.
constexpr double contact_level = 1e-3;
constexpr double infinite = 1e99;
/// Beyond this a multiplier is compared by its reciprocal.
constexpr double huge = 1e6;
/// mu = shift + 1 / nu: a shift that no problem has for a multiplier.
constexpr double shift = 0.73194651;

MatrixXd with_column(const MatrixXd& matrix, const Eigen::VectorXd& column) {
  MatrixXd result(matrix.rows(), matrix.cols() + 1);
  result << matrix, column;
  return result;
}

void sort_by_modulus(std::vector<Complex>& values) {
  std::sort(values.begin(), values.end(), [](const Complex& a, const Complex& b) {
    const double difference = std::abs(a) - std::abs(b);
    return difference != 0.0 ? difference > 0.0 : a.imag() > b.imag();
  });
}

double difference(const Complex& a, const Complex& b) {
  if (std::max(std::abs(a), std::abs(b)) > huge && a != 0.0 && b != 0.0) return std::abs(1.0 / a - 1.0 / b);
  return std::abs(a - b) / std::max(1.0, std::abs(a));
}

}  // namespace

ReturnPencil::ReturnPencil(const std::vector<SegmentLink>& links) : dimension_(links.front().flow.rows()) {
  const Index n = dimension_;
  MatrixXd state = MatrixXd::Identity(n, n);  // [R Q]
  MatrixXd conditions(0, n);                  // [C D]
  for (const SegmentLink& link : links) {
    MatrixXd end = link.flow * state;
    const double velocity = link.hx.dot(link.f);
    const double size = link.hx.norm() * link.f.norm();
    if (std::abs(velocity) > contact_level * size) {
      end -= link.f * (link.hx * end) / velocity;
    } else {
      const double f_size = link.f.norm() > 0.0 ? link.f.norm() : 1.0;
      const double h_size = link.hx.norm() > 0.0 ? link.hx.norm() : 1.0;
      end = with_column(end, link.f / f_size);
      MatrixXd extended = MatrixXd::Zero(conditions.rows() + 1, end.cols());
      extended.topLeftCorner(conditions.rows(), conditions.cols()) = conditions;
      extended.bottomRows(1) = link.hx * end / h_size;
      conditions = extended;
    }
    state = link.gx * end;
  }
  a_.resize(n + conditions.rows(), state.cols());
  a_ << state, conditions;
}

std::vector<Complex> ReturnPencil::multipliers() const {
  const Index n = dimension_;
  std::vector<Complex> values;
  if (!a_.allFinite()) return values;
  if (a_.rows() == n) {
    const Eigen::VectorXcd mu = eigenvalues(a_);
    values.assign(mu.begin(), mu.end());
    sort_by_modulus(values);
    return values;
  }
  MatrixXd b = MatrixXd::Zero(a_.rows(), a_.cols());
  b.topLeftCorner(n, n).setIdentity();
  const MatrixXd inverted = solve_with_complete_pivoting(a_ - shift * b, b);
  const Eigen::VectorXcd nu = eigenvalues(inverted);
  std::vector<Complex> reciprocals(nu.begin(), nu.end());
  sort_by_modulus(reciprocals);
  reciprocals.resize(static_cast<std::size_t>(n));  // those dropped are the conditions' own, infinite
  for (const Complex& value : reciprocals)
    values.push_back(std::abs(value) > 1.0 / infinite ? shift + 1.0 / value : Complex(infinite));
  sort_by_modulus(values);
  return values;
}

bool ReturnPencil::determines_multipliers(double tolerance) const {
  const Complex elsewhere(-0.36871, 0.51932);
  return a_.rows() == dimension_ || backward_error(elsewhere) > tolerance || backward_error(shift) > tolerance;
}

double ReturnPencil::backward_error(Complex mu) const {
  MatrixXcd difference = a_.cast<Complex>();
  for (Index i = 0; i < dimension_; ++i) difference(i, i) -= mu;
  return least_singular_value(difference) / (a_.norm() + std::abs(mu));
}

double largest_difference(std::vector<Complex> stored, std::vector<Complex> computed) {
  sort_by_modulus(stored);
  double largest = 0.0;
  for (std::size_t k = 0; k + 1 < stored.size() && !computed.empty(); ++k) {
    const auto nearest = std::min_element(computed.begin(), computed.end(), [&](const Complex& a, const Complex& b) {
      return difference(stored[k], a) < difference(stored[k], b);
    });
    largest = std::max(largest, difference(stored[k], *nearest));
    computed.erase(nearest);
  }
  return largest;
}

namespace {

using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// What q-files round away, and Newton's method leaves.
constexpr double stored_accuracy = level::orbit;
/// What integration along a segment must at least tell: where errors of the start grow by more, its end says nothing.
constexpr double most_allowed = 1e-2;
/// A difference of multipliers is no defect where a change of the map by this part of the tolerance explains it.
constexpr double explained = 1e-2;

StoredSegment stored_segment(const HybridSystem& system, const RunSettings& settings, const Orbit& x, int s) {
  const int m = x.shape.segments;
  const int n = x.shape.dimension;
  const SegmentSettings& own = settings.segments[static_cast<std::size_t>(s)];
  const SegmentSettings& before = settings.segments[static_cast<std::size_t>((s + m - 1) % m)];
  const SegmentSettings& after = settings.segments[static_cast<std::size_t>((s + 1) % m)];
  StoredSegment segment;
  segment.index = own.index;
  segment.next_field = after.index.field;
  segment.integrand = signature_rules(settings).counts_conditions && system.integral_conditions() > 0 ? s + 1 : 0;
  segment.grazing = contact_segment(settings) == s;
  segment.start = Eigen::Map<const VectorXd>(x.start(s), n);
  segment.end = Eigen::Map<const VectorXd>(x.end(s), n);
  segment.duration = x.duration(s);
  segment.period = x.period();
  segment.monitored = own.monitor;
  if (!system.has_successors()) return segment;
  const auto following =
      system.successors(before.index, x.end((s + m - 1) % m), x.par.data()).value_or(std::vector<IndexVector>{});
  for (const IndexVector& v : following)
    if (v.field == own.index.field && v.event != own.index.event) segment.alternatives.push_back(v);
  return segment;
}

/// In states divided by their scales. A segment that ends in contact is a return to h_x f = 0, where the orbit that
/// does not see the contact is cut; where no event ends it, the plane across the flow is its section.
SegmentLink link_at(const HybridSystem& system, const StoredSegment& segment, const SegmentCheck& check,
                    const VectorXd& par, const VectorXd& scale) {
  const int n = system.dimension();
  const IndexVector& index = segment.index;
  const double* const x = check.end.data();
  SegmentLink link{check.flow, VectorXd(n), Eigen::RowVectorXd(n),
                   jump_at(system, index.jump, x, par.data()).derivative};
  if (index.event == no_function) {
    system.value(FunctionKind::field, index.field, x, par.data(), link.f.data());
    link.hx = link.f.transpose();
  } else {
    const EventAt at = event_at(system, index.event, index.field, x, par.data());
    link.f = at.f;
    const VectorXd section =
        segment.grazing ? rate_gradient(system, at, index.event, index.field, x, par.data()) : at.gradient;
    link.hx = section.transpose();
  }
  const auto divide = scale.cwiseInverse().asDiagonal();
  link.flow = divide * link.flow * scale.asDiagonal();
  link.f = divide * link.f;
  link.hx = link.hx * scale.asDiagonal();
  link.gx = divide * link.gx * scale.asDiagonal();
  return link;
}

/// The state after the stored end's jump against the one that follows.
double jump_defect(const HybridSystem& system, const IndexVector& index, const Orbit& x, int s,
                   const VectorXd& following, const VectorXd& scale) {
  VectorXd after(x.shape.dimension);
  system.value(FunctionKind::jump, index.jump, x.end(s), x.par.data(), after.data());
  return (after - following).cwiseAbs().cwiseQuotient(scale).maxCoeff<Eigen::PropagateNaN>();
}

/// The starts of the segments after each, in a ring.
MatrixXd next_starts(const Orbit& x) {
  MatrixXd starts(x.shape.dimension, x.shape.segments);
  for (int s = 0; s < x.shape.segments; ++s)
    starts.col(s) = Eigen::Map<const VectorXd>(x.start((s + 1) % x.shape.segments), x.shape.dimension);
  return starts;
}

/// Does a jump change nothing but angles, by whole turns?
bool takes_turns_off(const HybridSystem& system, int jump, const VectorXd& x, const VectorXd& par,
                     const std::vector<Eigen::Index>& angles) {
  if (angles.empty()) return false;
  constexpr double turn = 2.0 * std::numbers::pi;
  VectorXd change(x.size());
  system.value(FunctionKind::jump, jump, x.data(), par.data(), change.data());
  change -= x;
  VectorXd sizes = x.cwiseAbs();
  for (const Eigen::Index a : angles) change(a) = std::remainder(change(a), turn), sizes(a) = turn;
  return (change.array().abs() <= level::orbit * sizes.array()).all();
}

/// NaN stays.
void take_larger(double& value, double other) { value = std::isfinite(other) ? std::max(value, other) : other; }

/// The largest of the boundary conditions at the stored ends.
double boundary_defect(const HybridSystem& system, const Orbit& x) {
  const int m = x.shape.segments;
  MatrixXd starts(x.shape.dimension, m), ends(x.shape.dimension, m);
  for (int s = 0; s < m; ++s) {
    starts.col(s) = Eigen::Map<const VectorXd>(x.start(s), x.shape.dimension);
    ends.col(s) = Eigen::Map<const VectorXd>(x.end(s), x.shape.dimension);
  }
  VectorXd values(system.boundary_conditions());
  system.boundary({m, starts.data(), ends.data(), x.par.data()}, values.data());
  return values.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
}

/// The largest integral condition, relative to its size (IntegralValues). NaN where a segment could not be integrated.
std::optional<double> integral_defect(const OrbitCheck& check) {
  Eigen::ArrayXd sums, sizes;
  for (const SegmentCheck& segment : check.segments) {
    if (!segment.message.empty()) return NAN;
    if (segment.integrals.values.size() == 0) return std::nullopt;
    if (sums.size() == 0) sums = sizes = Eigen::ArrayXd::Zero(segment.integrals.values.size());
    sums += segment.integrals.values.array();
    sizes += segment.integrals.sizes.array();
  }
  // An integrand that is zero along the orbit for all that rounding says has no size.
  return (sums.abs() / (sizes + stored_accuracy * check.period)).maxCoeff<Eigen::PropagateNaN>();
}

void compare_critical(const std::vector<std::complex<double>>& critical, const ReturnPencil& pencil,
                      OrbitCheck& check) {
  for (const std::complex<double>& wanted : critical) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::complex<double>& mu : check.multipliers) least = std::min(least, std::abs(mu - wanted));
    check.critical_difference = std::max(check.critical_difference.value_or(0.0), least);
    check.critical_error = std::max(check.critical_error, pencil.backward_error(wanted));
  }
}

/// Where the stored ones begin with the trivial one of an orbit without a section, the pencil has a structural zero.
void compare_multipliers(std::vector<std::complex<double>> stored, bool has_trivial, const ReturnPencil& pencil,
                         OrbitCheck& check) {
  if (has_trivial) stored.front() = 0.0;
  check.multiplier_difference = largest_difference(stored, check.multipliers);
  for (const std::complex<double>& mu : stored)
    if (std::abs(mu) < 1e98) check.multiplier_error = std::max(check.multiplier_error, pencil.backward_error(mu));
}

}  // namespace

std::vector<SegmentCheck> check_segments(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                                         const VectorXd& scale, const MatrixXd& following, double tolerance,
                                         const std::vector<Eigen::Index>& angles) {
  std::vector<SegmentCheck> checks;
  for (int s = 0; s < x.shape.segments; ++s) {
    const IndexVector& index = settings.segments[static_cast<std::size_t>(s)].index;
    StoredSegment stored = stored_segment(system, settings, x, s);
    std::erase_if(stored.alternatives, [&](const IndexVector& other) {
      return takes_turns_off(system, other.jump, stored.start, x.par, angles);
    });
    SegmentCheck segment = check_segment(system, stored, x.par, scale, tolerance);
    if (s < following.cols())
      take_larger(segment.state_defect, jump_defect(system, index, x, s, following.col(s), scale));
    segment.breaks_rules = s < following.cols() && !follows_rules(system, settings.signature(), x, s);
    checks.push_back(std::move(segment));
  }
  return checks;
}

std::vector<SegmentLink> links_of(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                                  const std::vector<SegmentCheck>& segments, const VectorXd& scale) {
  std::vector<SegmentLink> links;
  for (int s = 0; s < x.shape.segments; ++s) {
    const SegmentCheck& segment = segments[static_cast<std::size_t>(s)];
    if (!segment.message.empty()) return {};
    SegmentLink link = link_at(system, stored_segment(system, settings, x, s), segment, x.par, scale);
    const auto next = static_cast<std::size_t>((s + 1) % x.shape.segments);
    const int states = system.dimension_of(settings.segments[next].index.field);
    link.gx.bottomRows(system.dimension() - states).setZero();  // the identity leaves them
    links.push_back(std::move(link));
  }
  return links;
}

namespace {

/// Segments and durations.
OrbitCheck check_segments_of(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                             const MatrixXd& following, double tolerance) {
  OrbitCheck check;
  check.segments =
      check_segments(system, settings, x, state_sizes(system, settings.signature(), x), following, tolerance);
  for (int s = 0; s < x.shape.segments; ++s) {
    check.durations.push_back(x.duration(s));
    check.period += std::abs(x.duration(s));
  }
  check.goes_forward = x.period() > 0.0 && std::isfinite(x.period());
  if (!(check.period > 0.0)) check.period = 1.0;
  return check;
}

}  // namespace

OrbitCheck check_boundary_values(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                                 double tolerance) {
  OrbitCheck check = check_segments_of(system, settings, x, MatrixXd(), tolerance);
  take_larger(check.segments.back().state_defect, boundary_defect(system, x));
  check.integral_defect = integral_defect(check);
  return check;
}

OrbitCheck check_orbit(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                       const std::vector<std::complex<double>>& stored, double tolerance,
                       const CriticalMultipliers& critical) {
  OrbitCheck check = check_segments_of(system, settings, x, next_starts(x), tolerance);
  check.computes_multipliers = true;
  const std::vector<SegmentLink> links =
      links_of(system, settings, x, check.segments, state_sizes(system, settings.signature(), x));
  if (links.empty() || is_at_border_of_chatter(system, settings.signature(), x)) return check;
  const ReturnPencil pencil(links);
  if (!pencil.determines_multipliers(tolerance)) return check;
  check.multipliers = pencil.multipliers();
  const auto states = static_cast<std::size_t>(least_dimension(system, settings.signature()));
  if (check.multipliers.size() > states) check.multipliers.resize(states);  // the others are zero
  if (critical) compare_critical(critical(check.multipliers), pencil, check);
  const bool has_trivial = settings.segments.front().index.event == no_function;
  if (stored.size() == check.multipliers.size()) compare_multipliers(stored, has_trivial, pencil, check);
  if (has_trivial) check.multipliers.back() = 1.0;
  return check;
}

std::vector<Defect> defects_of(const OrbitCheck& check, std::size_t s, double tolerance) {
  const SegmentCheck& segment = check.segments[s];
  std::vector<Defect> defects;
  if (s == 0 && !check.goes_forward) defects.push_back(Defect::duration);
  const double growing = stored_accuracy * segment.growth;
  if (!segment.message.empty() || !(growing <= most_allowed)) {
    defects.push_back(segment.message.empty() ? Defect::undecided : Defect::not_integrated);
    return defects;
  }
  const double allowed = std::max(tolerance, growing);
  if (!(segment.state_defect <= allowed)) defects.push_back(Defect::state);
  if (s + 1 == check.segments.size() && check.integral_defect && !(*check.integral_defect <= allowed))
    defects.push_back(Defect::integral);
  // Where the flow touches the surface, an error of the state moves the event by its root.
  const bool is_touched = segment.touches && segment.event_level <= allowed;
  if (!(segment.time_defect <= (is_touched ? std::sqrt(allowed) : allowed) * check.period))
    defects.push_back(Defect::time);
  if (!segment.wrong.empty() || segment.leaves_surface || segment.breaks_rules ||
      check.durations[s] < -allowed * check.period)
    defects.push_back(Defect::event);
  return defects;
}

bool are_multipliers_wrong(const OrbitCheck& check, double tolerance) {
  return check.multiplier_difference && *check.multiplier_difference > tolerance &&
         check.multiplier_error > explained * tolerance;
}

bool are_critical_ones_wrong(const OrbitCheck& check, double tolerance) {
  return check.critical_difference && *check.critical_difference > tolerance &&
         check.critical_error > explained * tolerance;
}

}  // namespace tchat
