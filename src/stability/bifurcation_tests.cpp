#include "stability/bifurcation_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/levels.hpp"
#include "model/events.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"
#include "stability/equilibrium_tests.hpp"
#include "stability/normal_form_text.hpp"

namespace tchat {

namespace {

/// A pair whose imaginary parts are smaller, relatively, is real.
constexpr double complex_level = level::double_zero;

bool trusted(const FloquetMultipliers& multipliers) {
  return multipliers.valid && multipliers.structural <= structural_bound;
}

const MultiplierProduct& product_of(const FloquetMultipliers& multipliers, int target) {
  return target > 0 ? multipliers.with_one : multipliers.with_minus_one;
}

bool is_upper(const std::complex<double>& mu) { return mu.imag() > complex_level * std::abs(mu); }

/// Does segment s end in a mere cut: identity jump, the same field after it?
bool is_section(const DefiningSystem& system, int s) {
  const Signature& signature = system.signature();
  const IndexVector& index = signature[static_cast<std::size_t>(s)];
  return index.field == signature[static_cast<std::size_t>((s + 1) % system.segments())].field &&
         is_identity_jump(system.system(), index);
}

/// How many are at the target where a zero has been located there: to EPSS they are nearer than this.
long multipliers_at(const FloquetMultipliers& multipliers, double target) {
  constexpr double located = 1e-3;
  const auto list = multipliers.nontrivial();
  return std::count_if(list.begin(), list.end(), [&](const auto& mu) { return std::abs(mu - target) < located; });
}

/// Visits the upper multiplier of every complex pair except the pair nearest to `known`. Allocates nothing.
template <class Visit>
void for_pairs(const TestedPoint& point, const std::optional<std::complex<double>>& known, const Visit& visit) {
  const std::complex<double>* left_out = nullptr;
  for (const auto& mu : point.multipliers.values)
    if (known && is_upper(mu) && (left_out == nullptr || std::abs(mu - *known) < std::abs(*left_out - *known)))
      left_out = &mu;
  for (const auto& mu : point.multipliers.values)
    if (is_upper(mu) && &mu != left_out) visit(mu);
}

}  // namespace

std::string state_text(const HybridSystem& system, const Orbit& orbit, const double* state) {
  const Eigen::VectorXd uncertainty = state_uncertainty(orbit);
  std::string text;
  for (int k = 1; k <= system.dimension(); ++k)
    text += fmt::format("{}{} = {:.10g}", k > 1 ? ", " : "", system.state_name(k),
                        std::abs(state[k - 1]) > uncertainty(k - 1) ? system.unit_of(k) * state[k - 1] : 0.0);
  return text;
}

TestValue multiplier_product(const TestedPoint& point, int target) {
  if (!trusted(point.multipliers)) return TestValue::undefined();
  const double nearest = multiplier_distance(point.multipliers, target);
  const double accuracy = multiplier_accuracy(point.multipliers);
  const MultiplierProduct& product = product_of(point.multipliers, target);
  const double level = nearest > 0.0 ? accuracy * std::abs(product.value) / nearest : accuracy;
  return TestValue::of(product.value, std::max(level, product.uncertainty));
}

bool is_multiplier_at(const TestedPoint& point, int target) {
  return multiplier_distance(point.multipliers, target) <= agreeing_multiplier;
}

FoldTest::FoldTest(int parameter, const std::vector<int>& free_parameters, const ParameterLayout& layout, int segments,
                   bool stop, PointType type, std::string held)
    : is_duration_(layout.is_duration(parameter, segments)),
      is_monitor_(parameter >= layout.first_monitor(segments)),
      stop_(stop),
      type_(type),
      held_(std::move(held)) {
  index_ = is_duration_
               ? layout.duration_segment(parameter)
               : std::find(free_parameters.begin(), free_parameters.end(), parameter) - free_parameters.begin();
}

TestValue FoldTest::evaluate(const TestedPoint& point) const {
  const double rate = is_monitor_    ? point.principal_rate
                      : is_duration_ ? point.tangent.durations(index_)
                                     : point.tangent.globals(index_);
  return TestValue::of(rate, level::converged * point.principal_rate_size);
}

/// The branch also turns where h_x f = 0: at a section that becomes tangent its two ways through the orbit meet, while
/// the orbits go on, and in the plane so it is at grazing. A fold of orbits has the multiplier +1.
SpecialPoint FoldTest::classify(const TestedPoint& point, bool) const {
  const DefiningSystem& system = point.condensed.system();
  const int s = touching_segment(point);
  const bool is_fold = multipliers_at(point.multipliers, 1.0) > 0;
  const bool of_orbits = type_ == PointType::fold && system.orbits() == 1 && !point.multipliers.are_eigenvalues;
  if (is_monitor_ && of_orbits && point.multipliers.valid && !is_fold)
    return {PointType::user, {UserPointKind::extremum}, stop_, "extremum of ICP(1) along the branch"};
  if (!held_.empty()) return {type_, {}, stop_, "fold of the curve with " + held_ + " held"};
  if (is_monitor_ && !is_fold) return {type_, {}, stop_, "fold, or extremum of ICP(1) along the branch"};
  const bool has_form = is_fold || point.multipliers.are_eigenvalues;
  if (s < 0 || is_fold) return {type_, {}, stop_, "fold", {}, has_form ? fold_text(point) : ""};
  return {PointType::user,
          {UserPointKind::impact_velocity, s + 1, system.signature()[static_cast<std::size_t>(s)].event, 1.0},
          stop_,
          fmt::format("turning point of the branch, no fold of orbits: h_x f = 0 at the end of segment {}", s + 1)};
}

/// A duration or a monitor in place of the parameter turns without a multiplier +1, and so does a curve of orbits on
/// which something is held.
std::string FoldTest::objection(const TestedPoint& point) const {
  if (is_duration_ || is_monitor_ || !held_.empty()) return "";
  return objection_without_multiplier(point, 1, "the parameter turns");
}

TestValue BranchPointTest::evaluate(const TestedPoint& point) const {
  return TestValue::of(point.singular_distance, level::rounding_of_sums);
}

std::string BranchPointTest::objection(const TestedPoint& point) const {
  return objection_without_multiplier(point, 1, "the determinant changes sign");
}

SpecialPoint BranchPointTest::classify(const TestedPoint& point, bool) const {
  const bool rests = point.multipliers.are_eigenvalues;
  const long together = rests ? eigenvalues_at_zero(point) : multipliers_at(point.multipliers, 1.0);
  if (together > 2)
    return {type_,
            {},
            stop_,
            fmt::format("branch point: {} {} are at {} together", together, rests ? "eigenvalues" : "multipliers",
                        rests ? "0" : "+1")};
  return {type_, {}, stop_, "branch point", {}, branch_point_text(point)};
}

TestValue PeriodDoublingTest::evaluate(const TestedPoint& point) const { return multiplier_product(point, -1); }

std::string PeriodDoublingTest::objection(const TestedPoint& point) const {
  return objection_without_multiplier(point, -1, "the product of (multiplier + 1) changes sign");
}

bool PeriodDoublingTest::is_genuine(const TestedPoint& point) const { return is_multiplier_at(point, -1); }

SpecialPoint PeriodDoublingTest::classify(const TestedPoint& point, bool) const {
  return {PointType::period_doubling, {}, stop_, "period doubling", {}, normal_form_text(point, -1.0)};
}

std::string MultiplierPairTest::name() const { return fmt::format("a pair of multipliers {:+d}", target_); }

TestValue MultiplierPairTest::evaluate(const TestedPoint& point) const {
  if (!trusted(point.multipliers) || !point.multipliers.determined()) return TestValue::undefined();
  const auto list = point.multipliers.nontrivial();
  const auto beyond = [&](const std::complex<double>& mu) {
    const bool is_real = std::abs(mu.imag()) <= complex_level * std::abs(mu);
    return is_real && mu.real() * target_ > 0.0 ? mu.real() * target_ - 1.0 : -INFINITY;
  };
  double value = INFINITY, sign = 1.0;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const double x = beyond(list[k]);
    const auto comes_before = [&](std::size_t l) { return beyond(list[l]) > x || (beyond(list[l]) == x && l < k); };
    std::size_t before = 0;
    for (std::size_t l = 0; l < list.size(); ++l) before += comes_before(l) ? 1 : 0;
    if (x == -INFINITY || before % 2 == 0) continue;
    value = std::min(value, std::abs(x));
    sign = x > 0.0 ? -sign : sign;
  }
  // Pairs that are complex have not gone through it.
  if (value == INFINITY) value = multiplier_distance(point.multipliers, target_);
  if (!std::isfinite(value)) return TestValue::undefined();
  return TestValue::of(sign * value, multiplier_accuracy(point.multipliers));
}

bool MultiplierPairTest::is_genuine(const TestedPoint& point) const {
  return multipliers_at(point.multipliers, target_) >= 2;
}

SpecialPoint MultiplierPairTest::classify(const TestedPoint& point, bool) const {
  return {target_ > 0 ? PointType::branch_point : PointType::period_doubling,
          {},
          stop_,
          fmt::format("{}: {} multipliers go through {:+d} together", target_ > 0 ? "branch point" : "period doubling",
                      multipliers_at(point.multipliers, target_), target_)};
}

std::optional<std::complex<double>> nearest_pair(const TestedPoint& point, std::optional<std::complex<double>> known) {
  std::optional<std::complex<double>> nearest;
  for_pairs(point, known, [&](const std::complex<double>& mu) {
    if (!nearest || std::abs(std::abs(mu) - 1.0) < std::abs(std::abs(*nearest) - 1.0)) nearest = mu;
  });
  return nearest;
}

TestValue pair_distance(const TestedPoint& point, std::optional<std::complex<double>> known) {
  if (!trusted(point.multipliers) || !point.multipliers.determined()) return TestValue::undefined();
  const std::optional<std::complex<double>> nearest = nearest_pair(point, known);
  if (!nearest) return TestValue::undefined();
  double sign = 1.0;
  for_pairs(point, known, [&](const std::complex<double>& mu) {
    if (std::abs(mu) < 1.0) sign = -sign;
  });
  return TestValue::of(sign * std::abs(std::abs(*nearest) - 1.0), multiplier_accuracy(point.multipliers));
}

TestValue TorusTest::evaluate(const TestedPoint& point) const { return pair_distance(point); }

SpecialPoint TorusTest::classify(const TestedPoint& point, bool) const {
  const std::optional<std::complex<double>> mu = nearest_pair(point);
  const std::string remark = mu ? normal_form_text(point, *mu / std::abs(*mu)) : "";
  return {PointType::torus,
          {},
          stop_,
          fmt::format("torus bifurcation, angle {:.10g}", mu ? std::arg(*mu) : 0.0),
          {},
          remark};
}

ImpactVelocityTest::ImpactVelocityTest(const DefiningSystem& system, int segment, bool stop)
    : system_(system), segment_(segment), stop_(stop) {}

std::string ImpactVelocityTest::name() const { return fmt::format("h_x f at the end of segment {}", segment_ + 1); }

TestValue ImpactVelocityTest::evaluate(const TestedPoint& point) const {
  const Crossing crossing = crossing_at_end(system_, point.orbit, segment_);
  return TestValue::of(crossing.rate, no_transversality * crossing.sizes);
}

/// Of a contact segment that lasts no time both ends vanish: the label names the one where it begins.
SpecialPoint ImpactVelocityTest::lost_contact(const TestedPoint& point, int contact, bool ends_branch) const {
  const int m = system_.segments();
  const int before = (contact + m - 1) % m;
  const HybridSystem& system = system_.system();
  const IndexVector& entered = system_.signature()[static_cast<std::size_t>(before)];
  const int field = system_.signature()[static_cast<std::size_t>(contact)].field;
  return {
      PointType::user,
      {UserPointKind::impact_velocity, before + 1, entered.event, 1.0},
      ends_branch,
      fmt::format("grazing: segment {} ({}), the contact after event {} ({}) of segment {}, has shrunk to T = 0, {}; "
                  "orbits without it: tchat resegment --to signature",
                  contact + 1, system.function_name(FunctionKind::field, field), entered.event,
                  system.function_name(FunctionKind::event, entered.event), before + 1,
                  state_text(system, point.orbit, point.orbit.end(before)))};
}

SpecialPoint ImpactVelocityTest::classify(const TestedPoint& point, bool rising) const {
  for (const int s : {segment_, (segment_ + 1) % system_.segments()})
    if (system_.is_contact_segment(s) && contact_lasts_no_time(point.orbit, s))
      return lost_contact(point, s, stop_ && rising);
  const int event = system_.signature()[static_cast<std::size_t>(segment_)].event;
  return {PointType::user,
          {UserPointKind::impact_velocity, segment_ + 1, event, 1.0},
          stop_ && rising,
          fmt::format("{}: h_x f = 0 at the end of segment {}, event {} ({}), {}",
                      is_section(system_, segment_)
                          ? "section tangent: orbits go on, cut elsewhere (tchat simulate --without-sections)"
                          : "grazing",
                      segment_ + 1, event, system_.system().function_name(FunctionKind::event, event),
                      state_text(system_.system(), point.orbit, point.orbit.end(segment_)))};
}

namespace {

constexpr const char* crossing_sliding = "crossing-sliding";
constexpr const char* grazing_sliding = "grazing-sliding";
constexpr const char* switching_sliding = "switching-sliding";
constexpr const char* adding_sliding = "adding-sliding";

/// Does a field point at the surface of its mode in state x?
bool points_at_surface(const HybridSystem& system, const tchat_sliding& mode, int side, const double* x,
                       const double* par) {
  return side_rate(system, mode, side, x, par).away < 0.0;
}

/// Is the surface of an event function that of the mode, at a state that lies on the event's?
bool is_surface(const HybridSystem& system, const tchat_sliding& mode, int event, const double* x, const double* par) {
  constexpr double parallel = 1.0 - level::orbit;
  if (event == mode.surface) return true;
  if (event == no_function) return false;
  const EventAt own = event_at(system, mode.surface, x, par);
  const EventAt other = event_at(system, event, x, par);
  return std::abs(own.h) <= level::located * own.scale(x) &&
         std::abs(own.gradient.dot(other.gradient)) >= parallel * own.gradient.norm() * other.gradient.norm();
}

/// The pieces around a place of the orbit: the fields that last before and after it, and those between that do not.
struct Surroundings {
  int before;
  int after;
  std::set<int> vanishing;
  bool has_sliding(const tchat_sliding& mode) const { return vanishing.contains(mode.field); }
};

/// Around segment s (from 0) where that lasts no time, else around its start or end.
Surroundings around(const DefiningSystem& system, const Orbit& x, int s, bool at_end) {
  const int m = system.segments();
  const auto field = [&](int k) { return system.signature()[static_cast<std::size_t>(k)].field; };
  const auto step = [m](int k, int by) { return (k + by + m) % m; };
  Surroundings found{};
  int before = at_end || lasts_no_time(x, s) ? s : step(s, -1);
  int after = step(before, 1);
  for (int count = 0; count < m && lasts_no_time(x, before); ++count, before = step(before, -1))
    found.vanishing.insert(field(before));
  for (int count = 0; count < m && lasts_no_time(x, after); ++count, after = step(after, 1))
    found.vanishing.insert(field(after));
  found.before = field(before);
  found.after = field(after);
  return found;
}

/// A contact in the middle of a segment that lasts.
std::string inside(const TestedPoint& point, const tchat_sliding& mode, const UserPointKind& kind, int field) {
  const DefiningSystem& defining = point.condensed.system();
  if (field == mode.field) return ends_sliding(mode, kind.index) ? adding_sliding : "";
  if (!is_side(mode, field)) return "";
  const auto contact = least_value(defining, point.condensed.rule(), point.orbit, kind.segment - 1, kind.index);
  const double* par = point.orbit.par.data();
  if (!contact || !is_surface(defining.system(), mode, kind.index, contact->state.data(), par)) return "";
  return points_at_surface(defining.system(), mode, other_side(mode, field), contact->state.data(), par)
             ? grazing_sliding
             : "";
}

/// Does h_x f of a side, zero at x, rise along its flow in the direction that sliding allows? Sliding that begins there
/// goes on then; else it ends at once.
bool sliding_goes_on(const HybridSystem& system, const tchat_sliding& mode, int side, const double* x,
                     const double* par) {
  const EventAt at = event_at(system, mode.surface, side, x, par);
  const double change = rate_gradient(system, at, mode.surface, side, x, par).dot(at.f);
  return side == mode.minus ? change > 0.0 : change < 0.0;
}

/// What meets at a start, an end or a segment that lasts no time. `x` is the state there.
std::string at_meeting(const HybridSystem& system, const tchat_sliding& mode, const Surroundings& pieces,
                       const UserPointKind& kind, const double* x, const double* par) {
  const bool from_side = is_side(mode, pieces.before), to_side = is_side(mode, pieces.after);
  const bool from_sliding = pieces.before == mode.field, to_sliding = pieces.after == mode.field;
  if (from_side && to_side && pieces.before != pieces.after) {
    if (pieces.has_sliding(mode)) return crossing_sliding;
    if (!ends_sliding(mode, kind.index)) return "";
    return sliding_goes_on(system, mode, pieces.after, x, par) ? switching_sliding : crossing_sliding;
  }
  if (from_side && to_side) {
    if (pieces.has_sliding(mode)) return grazing_sliding;
    const int other = other_side(mode, pieces.before);
    const bool touches = is_surface(system, mode, kind.index, x, par) && !pieces.vanishing.contains(other);
    return touches && points_at_surface(system, mode, other, x, par) ? grazing_sliding : "";
  }
  if (from_side && to_sliding) {
    const int other = other_side(mode, pieces.before);
    const bool other_vanishes = kind.index == ends_with(mode, other);
    return pieces.vanishing.contains(other) || other_vanishes ? switching_sliding : "";
  }
  if (from_sliding && to_sliding) {
    const bool leaves = pieces.vanishing.contains(mode.minus) || pieces.vanishing.contains(mode.plus);
    return leaves || ends_sliding(mode, kind.index) ? adding_sliding : "";
  }
  const bool ends_tangent = kind.kind == UserPointKind::impact_velocity && ends_sliding(mode, kind.index);
  return from_sliding && to_side && ends_tangent ? adding_sliding : "";
}

}  // namespace

std::string sliding_bifurcation(const TestedPoint& point, const UserPointKind& kind) {
  if (kind.kind != UserPointKind::contact && kind.kind != UserPointKind::impact_velocity) return "";
  const DefiningSystem& defining = point.condensed.system();
  const Orbit& x = point.orbit;
  const int s = kind.segment - 1;
  const int field = defining.signature()[static_cast<std::size_t>(s)].field;
  const bool at_end = kind.kind == UserPointKind::impact_velocity || kind.tau == 1.0;
  const bool interior = !at_end && kind.tau > 0.0 && !lasts_no_time(x, s);
  for (const tchat_sliding& mode : defining.system().sliding_modes()) {
    const std::string name = interior ? inside(point, mode, kind, field)
                                      : at_meeting(defining.system(), mode, around(defining, x, s, at_end), kind,
                                                   at_end ? x.end(s) : x.start(s), x.par.data());
    if (!name.empty()) return name;
  }
  return "";
}

SlidingOnsetTest::SlidingOnsetTest(const DefiningSystem& system, int segment, const tchat_sliding& mode, bool stop)
    : system_(system), segment_(segment), mode_(mode), stop_(stop) {}

int SlidingOnsetTest::field_after() const { return system_.signature()[static_cast<std::size_t>(next())].field; }

int SlidingOnsetTest::event() const { return ends_with(mode_, field_after()); }

std::string SlidingOnsetTest::name() const {
  return fmt::format("h_x f of field {} at the start of segment {}", field_after(), next() + 1);
}

TestValue SlidingOnsetTest::evaluate(const TestedPoint& point) const {
  const double* x = point.orbit.start(next());
  const double* par = point.orbit.par.data();
  if (!is_on_surface(system_.system(), mode_, x, par, orbit_accuracy)) return TestValue::undefined();  // of another one
  const SideRate rate = side_rate(system_.system(), mode_, field_after(), x, par);
  return TestValue::of(rate.away, no_transversality * rate.sizes);
}

SpecialPoint SlidingOnsetTest::classify(const TestedPoint& point, bool rising) const {
  const HybridSystem& system = system_.system();
  return {PointType::user,
          {UserPointKind::contact, next() + 1, event(), 0.0},
          stop_ && !rising,
          fmt::format("h_x f = 0 of field {} ({}) where segment {} crosses event {} ({}), {}", field_after(),
                      system.function_name(FunctionKind::field, field_after()), segment_ + 1, mode_.surface,
                      system.function_name(FunctionKind::event, mode_.surface),
                      state_text(system, point.orbit, point.orbit.start(next())))};
}

}  // namespace tchat
