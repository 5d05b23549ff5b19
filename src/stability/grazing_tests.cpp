#include "stability/grazing_tests.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/orbit.hpp"
#include "stability/bifurcation_tests.hpp"

namespace tchat {

ContactTest::ContactTest(const DefiningSystem& system, int segment, int event, bool stop)
    : system_(system), segment_(segment), event_(event), stop_(stop) {}

std::string ContactTest::name() const { return fmt::format("least h{} on segment {}", event_, segment_ + 1); }

std::optional<EventMinimum> ContactTest::least(const TestedPoint& point) const {
  return least_value(system_, point.condensed.rule(), point.orbit, segment_, event_);
}

/// Courses are in the order of segments.
const EventCourse* ContactTest::known_course(const TestedPoint& point) const {
  auto course = std::lower_bound(point.courses.begin(), point.courses.end(), segment_,
                                 [](const EventCourse& one, int segment) { return one.segment < segment; });
  for (; course != point.courses.end() && course->segment == segment_; ++course)
    if (course->event == event_) return &*course;
  return nullptr;
}

std::optional<double> ContactTest::least_h(const TestedPoint& point) const {
  if (const EventCourse* const course = known_course(point))
    return tchat::least_h(system_, point.condensed.rule(), point.orbit, *course);
  const auto contact = least(point);
  return contact ? std::optional(contact->value) : std::nullopt;
}

TestValue ContactTest::evaluate(const TestedPoint& point) const {
  const std::optional<double> contact = least_h(point);
  if (!contact) return TestValue::undefined(sign_without_minimum(point.orbit));
  const EventCourse* const course = known_course(point);
  const double scale = course != nullptr ? scale_of(system_.system(), point.orbit, *course)
                                         : event_scale(system_.system(), point.orbit, event_);
  return TestValue::of(*contact, orbit_accuracy * scale);
}

/// Between pinned ends h may rise and fall without a minimum in between: no contact, positive.
int ContactTest::sign_without_minimum(const Orbit& x) const {
  if (!(x.duration(segment_) > 0.0)) return 0;
  for (int k = 1; k + 1 < x.shape.nodes_of(segment_); ++k)
    if (system_.system().event(event_, x.node(segment_, k), x.par.data()) > 0.0) return 1;
  return 0;
}

/// At an end of the segment h may pass zero with a slope: its surface is met there, where another event cuts the orbit.
bool ContactTest::crosses(const TestedPoint& point, const EventMinimum& contact) const {
  if (contact.tau > 0.0 && contact.tau < 1.0) return false;
  const int field = system_.signature()[static_cast<std::size_t>(segment_)].field;
  const EventAt at = event_at(system_.system(), event_, field, contact.state.data(), point.orbit.par.data());
  return std::abs(at.rate()) > tangent_contact * at.sizes();
}

SpecialPoint ContactTest::vanishing_segment(bool ends_branch) const {
  const int own = system_.signature()[static_cast<std::size_t>(segment_)].event;
  const auto name = [this](int event) {
    return fmt::format("event {} ({})", event, system_.system().function_name(FunctionKind::event, event));
  };
  return {PointType::user,
          {UserPointKind::contact, segment_ + 1, event_, 1.0},
          ends_branch,
          fmt::format("two events at once: segment {}, which ends in {}, has shrunk to T = 0{}", segment_ + 1,
                      name(own), own == event_ ? "" : " on the surface of " + name(event_))};
}

SpecialPoint ContactTest::classify(const TestedPoint& point, bool rising) const {
  const std::optional<EventMinimum> contact = least(point);
  const bool ends_branch = stop_ && !rising;
  // Where the segment lasts no time every point of it is the contact.
  if (lasts_no_time(point.orbit, segment_)) return vanishing_segment(ends_branch);
  const std::string where = fmt::format("event {} ({}) inside segment {}", event_,
                                        system_.system().function_name(FunctionKind::event, event_), segment_ + 1);
  if (!contact)
    return {PointType::user,
            {UserPointKind::contact, segment_ + 1, event_, 0.0},
            ends_branch,
            "grazing: contact with " + where};
  return {PointType::user,
          {UserPointKind::contact, segment_ + 1, event_, contact->tau},
          ends_branch,
          fmt::format("{} with {}, tau = {:.10g}, {}",
                      crosses(point, *contact) ? "two events at once: crossing" : "grazing: contact", where,
                      contact->tau, state_text(system_.system(), point.orbit, contact->state.data()))};
}

std::string RuleTest::name() const { return fmt::format("the rule for what follows segment {}", segment_ + 1); }

TestValue RuleTest::evaluate(const TestedPoint& point) const {
  const bool follows = follows_rules_there(system_.system(), system_.signature(), point.orbit, segment_);
  return TestValue::of(follows ? 1.0 : -1.0, 0.0);
}

SpecialPoint RuleTest::classify(const TestedPoint& point, bool rising) const {
  const HybridSystem& system = system_.system();
  const IndexVector& from = system_.signature()[static_cast<std::size_t>(segment_)];
  const int next = (segment_ + 1) % system_.segments();
  const IndexVector& to = system_.signature()[static_cast<std::size_t>(next)];
  const tchat_chatter* const chatter = system.chatter_with_limit(to.jump);
  const bool ends_chatter = chatter != nullptr && from == IndexVector{chatter->field, chatter->event, chatter->impact};
  const std::string event =
      fmt::format("(event {}, {})", from.event, system.function_name(FunctionKind::event, from.event));
  const std::string change =
      ends_chatter ? fmt::format(
                         "chatter becomes incomplete: on one side of this point the impacts from the end of segment {} "
                         "{} on do not accumulate",
                         next + 1, event)
                   : fmt::format(
                         "the rules of the model change at the end of segment {} {}: on one side of this point jump {} "
                         "({}) ends segment {}, on the other side it is another one",
                         segment_ + 1, event, to.jump, system.function_name(FunctionKind::jump, to.jump), next + 1);
  return {PointType::user,
          ends_chatter ? UserPointKind{UserPointKind::chatter, next + 1, from.event, 1.0}
                       : UserPointKind{UserPointKind::rule, segment_ + 1, from.event, 1.0},
          stop_ && !rising, fmt::format("{}, {}", change, state_text(system, point.orbit, point.orbit.end(segment_)))};
}

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A matrix or vector as digits * 2^exponent, so that powers neither vanish nor overflow.
struct ScaledMatrix {
  MatrixXd digits;
  double exponent = 0.0;

  void normalise() {
    const double size = digits.lpNorm<Eigen::Infinity>();
    if (size == 0.0 || !std::isfinite(size)) return;
    const int shift = std::ilogb(size);
    digits *= std::ldexp(1.0, -shift);
    exponent += shift;
  }
};

ScaledMatrix scaled_product(const ScaledMatrix& a, const ScaledMatrix& b) {
  ScaledMatrix result{a.digits * b.digits, a.exponent + b.exponent};
  result.normalise();
  return result;
}

/// A^n v by squaring A.
ScaledMatrix power_times(ScaledMatrix a, int n, ScaledMatrix v) {
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) v = scaled_product(a, v);
    a = scaled_product(a, a);
  }
  return v;
}

/// Of before = A^(n-1) (beta and its errors).
ImpactReturn one_more(const VectorXd& event_gradient, const MatrixXd& return_map, const ScaledMatrix& before) {
  constexpr double smallest = -900.0;  // a sign that underflow would swallow is kept, at this size
  constexpr double largest = 900.0;
  const double size = std::ldexp(1.0, static_cast<int>(std::clamp(before.exponent, smallest, largest)));
  return impact_return(event_gradient, size * before.digits, size * (return_map * before.digits));
}

}  // namespace

MatrixXd ImpactDirection::with_errors() const {
  MatrixXd columns(beta.size(), 1 + beta.size());
  columns << beta, uncertainty * MatrixXd::Identity(beta.size(), beta.size());
  return columns;
}

ImpactDirection impact_direction(const VectorXd& f, const VectorXd& section_gradient, const MatrixXd& jump_derivative) {
  const VectorXd v = jump_derivative * f;
  const double acceleration = section_gradient.dot(f);
  const double terms =
      jump_derivative.norm() * f.norm() * (1.0 + f.norm() * section_gradient.norm() / std::abs(acceleration));
  return {v - f * (section_gradient.dot(v) / acceleration), orbit_accuracy * terms};
}

ImpactReturn impact_return(const VectorXd& event_gradient, const MatrixXd& before, const MatrixXd& last) {
  const double of_powers = orbit_accuracy * std::max(before.col(0).norm(), last.col(0).norm());
  const double of_beta = last.rightCols(last.cols() - 1).norm();
  return {-event_gradient.dot(last.col(0)), event_gradient.norm() * (of_powers + of_beta)};
}

ImpactReturn impact_return(const VectorXd& event_gradient, const MatrixXd& return_map, const ImpactDirection& direction,
                           int n) {
  return one_more(event_gradient, return_map, power_times({return_map}, n - 1, {direction.with_errors()}));
}

std::vector<ImpactReturn> impact_returns(const VectorXd& event_gradient, const MatrixXd& return_map,
                                         const ImpactDirection& direction, int count) {
  std::vector<ImpactReturn> result;
  ScaledMatrix turned{direction.with_errors()};
  for (int n = 1; n <= count; ++n) {
    result.push_back(one_more(event_gradient, return_map, turned));
    turned = scaled_product({return_map}, turned);
  }
  return result;
}

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using RowMajorBlock = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

/// The columns of v at the end of segment s onto the section along the flow.
Matrix project(const DefiningSystem& system, const Orbit& x, int s, const Matrix& v) {
  const int n = system.dimension();
  Vector f(n);
  Vector gradient(n);
  system.system().value(FunctionKind::field, system.signature()[static_cast<std::size_t>(s)].field, x.end(s),
                        x.par.data(), f.data());
  system.section_gradient(s, x.end(s), x.par.data(), gradient.data());
  return v - f * ((gradient.transpose() * v) / gradient.dot(f));
}

Matrix jump_derivative(const HybridSystem& system, int jump, const double* x, const double* par) {
  const int n = system.dimension();
  Vector g(n);
  Matrix gx(n, n);
  system.first(FunctionKind::jump, jump, x, par, {}, g.data(), gx.data(), nullptr);
  return gx;
}

/// A v: the columns of v from the contact through the cycle back to it.
Matrix once_around(const GrazingOrbitSystem& system, const CondensedSystem& condensed, const Orbit& x, Matrix v) {
  const int m = system.segments();
  const int n = system.dimension();
  for (int i = 1; i <= m; ++i) {
    const int before = (system.grazing_segment() + i - 1) % m;
    const int s = (system.grazing_segment() + i) % m;
    v = jump_derivative(system.system(), system.signature()[static_cast<std::size_t>(before)].jump, x.end(before),
                        x.par.data()) *
        v;
    const RowMajorBlock first(condensed.first_block(s), n, n);
    const RowMajorBlock last(condensed.last_block(s), n, n);
    v = project(system, x, s, solve(last, -(first * v)));
  }
  return v;
}

/// xi_n. Few powers of A are taken one by one, as cheap and most accurate.
ImpactReturn return_of_impact(const GrazingOrbitSystem& system, const CondensedSystem& condensed, const Orbit& x,
                              const Vector& event_gradient, const ImpactDirection& direction, int n) {
  constexpr int one_by_one = 40;
  const Eigen::Index size = event_gradient.size();
  if (n > one_by_one)
    return impact_return(event_gradient, once_around(system, condensed, x, Matrix::Identity(size, size)), direction, n);
  Matrix before = direction.with_errors();
  Matrix last = before;
  for (int k = 1; k <= n; ++k) {
    before = last;
    last = once_around(system, condensed, x, before);
  }
  return impact_return(event_gradient, before, last);
}

ImpactDirection direction_of_impact(const GrazingOrbitSystem& system, const Orbit& x, int jump) {
  const int s = system.grazing_segment();
  Vector f(system.dimension());
  system.system().value(FunctionKind::field, system.signature()[static_cast<std::size_t>(s)].field, x.end(s),
                        x.par.data(), f.data());
  Vector section(system.dimension());
  system.section_gradient(s, x.end(s), x.par.data(), section.data());
  return impact_direction(f, section, jump_derivative(system.system(), jump, x.end(s), x.par.data()));
}

std::string row_text(const Eigen::RowVectorXd& row) {
  std::string text;
  for (const double value : row) text += fmt::format("{:19.10E}", value);
  return text;
}

}  // namespace

GrazingMatrices grazing_matrices(const GrazingOrbitSystem& system, const CondensedSystem& condensed, const Orbit& x,
                                 int jump) {
  const int n = system.dimension();
  return {direction_of_impact(system, x, jump).beta, once_around(system, condensed, x, Matrix::Identity(n, n))};
}

GrazingUnfolding grazing_unfolding(const GrazingOrbitSystem& system, const CondensedSystem& condensed, const Orbit& x,
                                   int jump, int number) {
  const int s = system.grazing_segment();
  const int n = system.dimension();
  const IndexVector& index = system.signature()[static_cast<std::size_t>(s)];
  const double* contact = x.end(s);
  const EventAt event = event_at(system.system(), index.event, index.field, contact, x.par.data());
  Vector section(n);
  system.section_gradient(s, contact, x.par.data(), section.data());

  GrazingUnfolding result;
  result.acceleration = section.dot(event.f);
  if (number == 0) return result;
  const ImpactDirection direction = direction_of_impact(system, x, jump);
  const ImpactReturn turned = return_of_impact(system, condensed, x, event.gradient, direction, number);
  result.xi = turned.xi;
  result.uncertainty = turned.uncertainty;
  result.no_square_root = direction.is_zero();
  return result;
}

namespace {

constexpr const char* acceleration_name = "a*";
constexpr const char* xi_name = "xi_";

}  // namespace

bool reports_contact(const std::string& test_name) {
  return test_name == acceleration_name || test_name.starts_with(xi_name);
}

std::string XiTest::name() const { return fmt::format("{}{}", xi_name, n_); }

std::string AccelerationTest::name() const { return acceleration_name; }

TestValue XiTest::evaluate(const TestedPoint& point) const {
  const GrazingUnfolding unfolding = grazing_unfolding(system_, point.condensed, point.orbit, jump_, n_);
  return TestValue::of(unfolding.xi, unfolding.uncertainty);
}

std::string XiTest::reason_to_vanish(const TestedPoint& point) const {
  const bool no_root = grazing_unfolding(system_, point.condensed, point.orbit, jump_, n_).no_square_root;
  return no_root ? "beta = 0: contact has no square root here, so there is no xi_n" : "";
}

SpecialPoint XiTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::xi, system_.grazing_segment() + 1, n_, 1.0},
          false,
          fmt::format("codimension two: xi_{} = 0", n_)};
}

TestValue AccelerationTest::evaluate(const TestedPoint& point) const {
  const double sizes = crossing_at_end(system_, point.orbit, system_.grazing_segment()).sizes;
  return TestValue::of(grazing_unfolding(system_, point.condensed, point.orbit, jump_, 0).acceleration,
                       no_transversality * sizes);
}

std::string AccelerationTest::details(const TestedPoint& point) const {
  const GrazingMatrices matrices = grazing_matrices(system_, point.condensed, point.orbit, jump_);
  const Eigen::Map<const Vector> contact(point.orbit.end(system_.grazing_segment()), system_.dimension());
  const Vector units = units_of_states(system_.system());
  const Matrix return_map = units.asDiagonal() * matrices.return_map * units.cwiseInverse().asDiagonal();
  std::string text = fmt::format("Contact x*, beta of jump {} there, and the derivative A of the return map:\n", jump_);
  text += "x*  " + row_text(contact.cwiseProduct(units).transpose()) + "\nbeta" +
          row_text(matrices.beta.cwiseProduct(units).transpose());
  for (const auto& row : return_map.rowwise()) text += "\nA   " + row_text(row);
  return text;
}

SpecialPoint AccelerationTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::grazing_codimension_two, system_.grazing_segment() + 1, 0, 1.0},
          false,
          "codimension two: a* = 0, h is no longer least at the contact"};
}

TestValue SmoothMultiplierTest::evaluate(const TestedPoint& point) const { return multiplier_product(point, target_); }

bool SmoothMultiplierTest::is_genuine(const TestedPoint& point) const { return is_multiplier_at(point, target_); }

SpecialPoint SmoothMultiplierTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::grazing_codimension_two, 0, target_, 1.0},
          false,
          fmt::format("codimension two: {}, multiplier {} of the smooth return map", name(), target_)};
}

}  // namespace tchat
