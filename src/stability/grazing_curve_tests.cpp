#include "stability/grazing_curve_tests.hpp"

#include <fmt/format.h>

#include <cmath>

#include "linear/dense_matrix.hpp"
#include "model/event_at.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/condensed_system.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/grazing_response.hpp"

namespace tchat {

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
  std::string text = fmt::format("Contact x*, beta of jump {} there, and the derivative A of the return map:\n", jump_);
  text += "x*  " + row_text(contact.transpose()) + "\nbeta" + row_text(matrices.beta.transpose());
  for (const auto& row : matrices.return_map.rowwise()) text += "\nA   " + row_text(row);
  return text;
}

SpecialPoint AccelerationTest::classify(const TestedPoint&, bool) const {
  return {PointType::user,
          {UserPointKind::grazing_codimension_two, system_.grazing_segment() + 1, 0, 1.0},
          false,
          "codimension two: a* = 0, h is no longer least at the contact"};
}

TestValue GrazingTurnTest::evaluate(const TestedPoint& point) const {
  constexpr double level = 1e-10;  // of a tangent of unit length, which Newton's tolerances leave
  return TestValue::of(point.tangent.globals(parameter_), level);
}

bool GrazingTurnTest::is_genuine(const TestedPoint& point) const {
  constexpr double crossing = 1e-6;
  return std::abs(point.singular_distance) > crossing;
}

SpecialPoint GrazingTurnTest::classify(const TestedPoint&, bool) const {
  return {PointType::fold, {}, stop_, fmt::format("the grazing curve turns in {}", parameter_name_)};
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
