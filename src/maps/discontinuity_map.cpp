#include "maps/discontinuity_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int points = 12;
constexpr int sizes = 14;

/// Chebyshev points of [-1, 1], and the matrix that makes coefficients of powers of values there.
struct UnitInterpolation {
  VectorXd nodes = VectorXd(points);
  MatrixXd to_coefficients;

  UnitInterpolation() {
    MatrixXd powers(points, points);
    for (int i = 0; i < points; ++i) {
      nodes(i) = std::cos((2 * i + 1) * std::numbers::pi / (2 * points));
      powers(i, 0) = 1.0;
      for (int k = 1; k < points; ++k) powers(i, k) = powers(i, k - 1) * nodes(i);
    }
    to_coefficients = solve(powers, MatrixXd::Identity(points, points));
  }
};

std::optional<MatrixXd> coefficients(const std::function<VectorXd(double)>& function, double size, int count,
                                     const UnitInterpolation& unit) {
  MatrixXd values;
  for (int i = 0; i < points; ++i) {
    const VectorXd value = function(size * unit.nodes(i));
    if (!value.allFinite()) return std::nullopt;
    if (i == 0) values.resize(value.size(), points);
    values.col(i) = value;
  }
  MatrixXd result = values * unit.to_coefficients.topRows(count).transpose();
  double power = 1.0;
  for (int k = 0; k < count; ++k, power *= size) result.col(k) /= power;
  return result;
}

}  // namespace

TaylorCoefficients taylor_coefficients(const std::function<VectorXd(double)>& function, double first_size, int count) {
  const UnitInterpolation unit;
  TaylorCoefficients best{{}, VectorXd::Constant(count, INFINITY)};
  std::optional<MatrixXd> before;
  double size = first_size;
  for (int trial = 0; trial < sizes; ++trial, size *= 0.5) {
    std::optional<MatrixXd> now = coefficients(function, size, count, unit);
    if (now && best.columns.size() == 0) best.columns = MatrixXd::Constant(now->rows(), count, NAN);
    for (int k = 0; now && before && k < count; ++k) {
      const double difference = (now->col(k) - before->col(k)).lpNorm<Eigen::Infinity>();
      if (!(difference < best.errors(k))) continue;
      best.errors(k) = difference;
      best.columns.col(k) = now->col(k);
    }
    before = std::move(now);
  }
  return best;
}

namespace {

using Eigen::RowVectorXd;

VectorXd no_value(Eigen::Index n) { return VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN()); }

}  // namespace

struct DiscontinuityMap::Implementation {
  const HybridSystem& system;
  GrazingPoint point;
  std::optional<CrossSection> section;
  VectorXd gradient;  // of the section's function
  DiscontinuityExpansion expansion;

  Implementation(const HybridSystem& s, GrazingPoint p, std::optional<CrossSection> cross)
      : system(s), point(std::move(p)), section(cross) {
    gradient = section ? flow(point.par).section_gradient(*section, VectorXd::Zero(n())) : point.section_gradient;
    if (section) require_crossing();
    expand();
  }

  Eigen::Index n() const { return point.x.size(); }
  LocalFlow flow(const ParameterVector& par) const {
    return {system, {point.field, point.event, point.jump}, point.x, point.par, par};
  }

  std::string section_name() const {
    if (section->event > 0)
      return fmt::format("event {} ({})", section->event, system.function_name(FunctionKind::event, section->event));
    return "constant " + system.state_name(section->state);
  }

  void require_crossing() const {
    const double rate = gradient.dot(point.f);
    if (std::abs(rate) > level::orbit * gradient.norm() * point.f.norm()) return;
    throw UserError(fmt::format(
        "--section: the flow is tangent to the section of {} at the contact, it cannot be P'; choose an event function "
        "or a state that rises or falls there{}",
        section_name(), section->event == point.event ? " (this one is the surface in contact)" : ""));
  }

  // --- The smooth map X, in deviations. `d` on the section or near it.

  /// To P; for the exact map also the derivative.
  static bool flow_to_p(LocalFlow& local, VectorXd& d, MatrixXd* derivative) {
    return local.to_least_height(d, derivative);
  }

  /// From P through the jump back to P or P'.
  bool pass(LocalFlow& local, VectorXd& d, double y, MatrixXd* derivative) const {
    if (!local.to_height(d, y, derivative)) return false;
    return bring_back(local, d, derivative);
  }

  /// From the state before the jump.
  bool bring_back(LocalFlow& local, VectorXd& d, MatrixXd* derivative) const {
    d = local.jumped(d, derivative);
    for (const IndexVector& v : point.aftermath) {
      LocalFlow other(system, v, point.x, point.par, local.parameters());
      if (!d.allFinite() || !other.to_section(d, {v.event, 0}, derivative)) return false;
      d = other.jumped(d, derivative);
    }
    if (!d.allFinite() || !local.to_least_height(d, derivative)) return false;
    return !section || local.to_section(d, *section, derivative);
  }

  VectorXd smooth(LocalFlow& local, VectorXd d, double y) const {
    return flow_to_p(local, d, nullptr) && pass(local, d, y, nullptr) ? d : no_value(n());
  }

  /// X(x* + d, 0) and d X / dy there, side by side: with dv/dy = sqrt(2 / a(x0)) the state x_in leaves x0 by
  /// -sqrt(2/a) f, and what follows is differentiated.
  MatrixXd first_in_y(LocalFlow& local, VectorXd d) const {
    MatrixXd result(n(), 2);
    result.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (!flow_to_p(local, d, nullptr)) return result;
    MatrixXd change = -std::sqrt(2.0 / local.acceleration(d)) * local.field(d);
    if (!bring_back(local, d, &change)) return result;
    result << d, change;
    return result;
  }

  // --- Its expansion.

  void expand() {
    LocalFlow local = flow(point.par);
    const MatrixXd identity = MatrixXd::Identity(n(), n());
    const MatrixXd onto = section ? project_along_flow(point.f, gradient, identity) : identity;
    const MatrixXd onto_p = project_along_flow(point.f, point.section_gradient, identity);
    expansion.y = onto * point.B;
    expansion.dx = onto * onto_p * point.jump_derivative * onto_p;

    MatrixXd fx(n(), n());
    VectorXd f(n());
    system.first(FunctionKind::field, point.field, point.x.data(), point.par.data(), {}, f.data(), fx.data(), nullptr);
    const double rate = fx.norm();
    const double time = rate > 0.0 ? 2.0 / rate : 1.0;  // over which the flow changes its direction, or less

    const TaylorCoefficients in_y = taylor_coefficients([&](double y) { return smooth(local, VectorXd::Zero(n()), y); },
                                                        time * std::sqrt(0.5 * point.a), 4);
    expansion.yy = in_y.columns.col(2);
    expansion.yyy = in_y.columns.col(3);
    expansion.error = std::max(in_y.errors(2), in_y.errors(3));

    expansion.ydx = MatrixXd::Zero(n(), n());
    const double length = time * point.f.norm();
    for (Eigen::Index k = 0; k < system.dimension_of(point.field); ++k) {
      const TaylorCoefficients along = taylor_coefficients(
          [&](double e) -> VectorXd { return first_in_y(local, e * VectorXd::Unit(n(), k)).reshaped(); }, length, 2);
      expansion.ydx.col(k) = along.columns.col(1).tail(n());
      expansion.error = std::max(expansion.error, along.errors(1));
    }
    expand_parameters();
    if (std::isfinite(expansion.error)) return;
    throw ComputationError(
        "the discontinuity map cannot be expanded: field, event function or jump have no finite values near the "
        "contact");
  }

  void expand_parameters() {
    constexpr double share = 0.25;  // of a parameter, the first interval
    expansion.parameters.resize(static_cast<std::size_t>(system.parameters()));
    std::iota(expansion.parameters.begin(), expansion.parameters.end(), 1);
    expansion.dp.resize(n(), system.parameters());
    expansion.ydp.resize(n(), system.parameters());
    for (int k = 0; k < system.parameters(); ++k) {
      const double size = point.par(k) != 0.0 ? share * std::abs(point.par(k)) : share;
      const TaylorCoefficients along = taylor_coefficients(
          [&](double e) -> VectorXd {
            ParameterVector par = point.par;
            par(k) += e;
            LocalFlow local = flow(par);
            return first_in_y(local, VectorXd::Zero(n())).reshaped();
          },
          size, 2);
      expansion.dp.col(k) = along.columns.col(1).head(n());
      expansion.ydp.col(k) = along.columns.col(1).tail(n());
      expansion.error = std::max(expansion.error, along.errors(1));
    }
  }

  VectorXd expanded(const VectorXd& d, const VectorXd& dp, double y, MapOrder order) const {
    VectorXd result = expansion.y * y;
    if (order == MapOrder::half) return result;
    result += expansion.yy * (y * y) + expansion.dx * d + expansion.dp * dp;
    if (order == MapOrder::one) return result;
    return result + expansion.yyy * (y * y * y) + y * (expansion.ydx * d + expansion.ydp * dp);
  }

  /// Its derivative by d, where y is a function of d with this row.
  MatrixXd expanded_derivative(const VectorXd& d, const VectorXd& dp, double y, const RowVectorXd& dy,
                               MapOrder order) const {
    VectorXd by_y = expansion.y;
    if (order == MapOrder::half) return by_y * dy;
    by_y += 2.0 * y * expansion.yy;
    if (order == MapOrder::one) return expansion.dx + by_y * dy;
    by_y += 3.0 * y * y * expansion.yyy + expansion.ydx * d + expansion.ydp * dp;
    return expansion.dx + y * expansion.ydx + by_y * dy;
  }

  VectorXd parameter_deviation(const ParameterVector& par) const { return (par - point.par).head(system.parameters()); }
};

DiscontinuityMap::DiscontinuityMap(const HybridSystem& system, GrazingPoint point, std::optional<CrossSection> section)
    : p_(std::make_unique<const Implementation>(system, std::move(point), section)) {}
DiscontinuityMap::~DiscontinuityMap() = default;
DiscontinuityMap::DiscontinuityMap(DiscontinuityMap&&) noexcept = default;
DiscontinuityMap& DiscontinuityMap::operator=(DiscontinuityMap&&) noexcept = default;

const GrazingPoint& DiscontinuityMap::point() const { return p_->point; }
const std::optional<CrossSection>& DiscontinuityMap::section() const { return p_->section; }
const VectorXd& DiscontinuityMap::section_gradient() const { return p_->gradient; }
const DiscontinuityExpansion& DiscontinuityMap::expansion() const { return p_->expansion; }

double DiscontinuityMap::penetration(const VectorXd& x, const ParameterVector& par) const {
  LocalFlow local = p_->flow(par);
  VectorXd d = x - p_->point.x;
  return Implementation::flow_to_p(local, d, nullptr) ? -local.height(d) : std::numeric_limits<double>::quiet_NaN();
}

VectorXd DiscontinuityMap::apply(const VectorXd& x, const ParameterVector& par, MapOrder order) const {
  LocalFlow local = p_->flow(par);
  const VectorXd start = x - p_->point.x;
  VectorXd d = start;
  if (!Implementation::flow_to_p(local, d, nullptr)) return no_value(x.size());
  const double depth = -local.height(d);
  if (!(depth > 0.0)) return x;
  const double y = std::sqrt(depth);
  if (order != MapOrder::exact) return p_->point.x + p_->expanded(start, p_->parameter_deviation(par), y, order);
  if (!p_->pass(local, d, y, nullptr)) return no_value(x.size());
  return p_->point.x + d;
}

MatrixXd DiscontinuityMap::derivative(const VectorXd& x, const ParameterVector& par, MapOrder order) const {
  const Eigen::Index n = x.size();
  LocalFlow local = p_->flow(par);
  const VectorXd start = x - p_->point.x;
  VectorXd d = start;
  MatrixXd change = MatrixXd::Identity(n, n);
  const MatrixXd none = MatrixXd::Constant(n, n, std::numeric_limits<double>::quiet_NaN());
  if (!Implementation::flow_to_p(local, d, &change)) return none;
  const double depth = -local.height(d);
  if (!(depth > 0.0)) return MatrixXd::Identity(n, n);
  const double y = std::sqrt(depth);
  if (order != MapOrder::exact) {
    const RowVectorXd dy = local.height_gradient(d).transpose() * change / (-2.0 * y);
    return p_->expanded_derivative(start, p_->parameter_deviation(par), y, dy, order);
  }
  return p_->pass(local, d, y, &change) ? change : none;
}

VectorXd DiscontinuityMap::smooth_deviation(const VectorXd& d, double y) const {
  LocalFlow local = p_->flow(p_->point.par);
  return p_->smooth(local, d, y);
}

VectorXd DiscontinuityMap::onto_section(const VectorXd& d) const {
  LocalFlow local = p_->flow(p_->point.par);
  VectorXd at = d;
  const bool arrives = p_->section ? local.to_section(at, *p_->section) : local.to_least_height(at);
  return arrives ? at : no_value(d.size());
}

double DiscontinuityMap::penetration_of_deviation(const VectorXd& d) const {
  LocalFlow local = p_->flow(p_->point.par);
  VectorXd at = d;
  return Implementation::flow_to_p(local, at, nullptr) ? -local.height(at) : std::numeric_limits<double>::quiet_NaN();
}

VectorXd DiscontinuityMap::expanded_deviation(const VectorXd& d, double y, MapOrder order) const {
  return p_->expanded(d, VectorXd::Zero(p_->system.parameters()), y, order);
}

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A deviation on the section with this penetration: along `direction`, whose h_D falls by 1.
VectorXd start_at(const DiscontinuityMap& map, const VectorXd& direction, double penetration) {
  double length = penetration;
  VectorXd d;
  for (int iteration = 0; iteration < 20; ++iteration) {
    d = map.onto_section(length * direction);
    const double factor = penetration / map.penetration_of_deviation(d);
    if (!(factor > 0.0) || !std::isfinite(factor)) return VectorXd::Constant(direction.size(), nan);
    if (std::abs(factor - 1.0) < 1e-3) break;  // which penetration it is does not matter, only that it is known
    length *= factor;
  }
  return d;
}

ComparedPenetration compared(const DiscontinuityMap& map, const VectorXd& direction, double penetration) {
  ComparedPenetration row{penetration, nan, {nan, nan, nan}};
  const VectorXd d = start_at(map, direction, penetration);
  if (!d.allFinite()) return row;
  row.penetration = map.penetration_of_deviation(d);
  const double y = std::sqrt(row.penetration);
  const VectorXd exact = map.smooth_deviation(d, y);
  row.change = exact.norm();
  for (std::size_t k = 0; k < expanded_orders.size(); ++k)
    row.errors[k] = (exact - map.expanded_deviation(d, y, expanded_orders[k])).norm();
  return row;
}

/// What rounding makes of an error: of the deviations, and of the coefficients of y^2.
double noise(const DiscontinuityMap& map, const ComparedPenetration& row) {
  constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  return rounding * row.change + map.expansion().error * row.penetration;
}

std::optional<ErrorOrder> fitted(const DiscontinuityMap& map, const std::vector<ComparedPenetration>& rows,
                                 std::size_t k) {
  constexpr double clear = 30.0;  // times the noise
  constexpr std::size_t points = 5;
  std::vector<const ComparedPenetration*> usable;
  for (const ComparedPenetration& row : rows)
    if (row.errors[k] > clear * noise(map, row)) usable.push_back(&row);
  if (usable.size() > points) usable.erase(usable.begin(), usable.end() - points);
  if (usable.size() < 2) return std::nullopt;
  double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0;
  const auto count = static_cast<double>(usable.size());
  for (const ComparedPenetration* row : usable) {
    mean_x += 0.5 * std::log(row->penetration) / count;
    mean_y += std::log(row->errors[k]) / count;
  }
  for (const ComparedPenetration* row : usable) {
    const double x = 0.5 * std::log(row->penetration) - mean_x;
    xx += x * x;
    xy += x * (std::log(row->errors[k]) - mean_y);
  }
  return ErrorOrder{xy / xx, usable.front()->penetration, usable.back()->penetration};
}

}  // namespace

MapComparison compare_with_expansion(const DiscontinuityMap& map, double largest, int decades) {
  MatrixXd rows(2, map.point().x.size());
  rows.row(0) = map.point().event_gradient.transpose();
  rows.row(1) = map.section_gradient().transpose();
  const VectorXd direction = least_squares(rows, Eigen::Vector2d(-1.0, 0.0));
  MapComparison result;
  double penetration = largest;
  for (int k = 0; k <= decades; ++k, penetration *= 0.1) result.rows.push_back(compared(map, direction, penetration));
  for (std::size_t k = 0; k < result.orders.size(); ++k) result.orders[k] = fitted(map, result.rows, k);
  return result;
}

}  // namespace tchat
