#include "maps/discontinuity_map.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/user_error.hpp"
#include "maps/local_flow.hpp"
#include "maps/taylor_coefficients.hpp"
#include "model/event_at.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

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
    constexpr double tangent = 1e-9;
    const double rate = gradient.dot(point.f);
    if (std::abs(rate) > tangent * gradient.norm() * point.f.norm()) return;
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

}  // namespace tchat
