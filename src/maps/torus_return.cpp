#include "maps/torus_return.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/user_error.hpp"
#include "maps/circle.hpp"
#include "maps/return_path.hpp"
#include "maps/smooth_return.hpp"
#include "motion/mode_rule.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double largest_defect = 1e-4;
constexpr double largest_interpolation_error = 1e-3;

/// Angles between 0 and 2 pi.
VectorXd reduced(const InvariantCurve& curve, VectorXd x) {
  for (Index i = 0; i < x.size(); ++i)
    if (curve.is_angle(i)) x(i) -= full_turn * std::floor(x(i) / full_turn);
  return x;
}

Index triangle(Index n) { return n * (n + 1) / 2; }

/// The size of the highest quarter of the harmonics beside that of all.
double tail_of(const TrigonometricSeries& series) {
  const MatrixXd& c = series.coefficients();
  const double all = c.cwiseAbs().maxCoeff();
  const Index tail = std::max<Index>(1, c.cols() / 4);
  return all > 0.0 ? c.rightCols(tail).cwiseAbs().maxCoeff() / all : 0.0;
}

}  // namespace

/// Derivatives at equal phases.
struct TorusReturn::Nodes {
  MatrixXd first, second, times;
  double defect = 0.0, by_parameters = 0.0;

  Index count() const { return times.cols(); }
  void take(Index node, const Nodes& from, Index there) {
    first.col(node) = from.first.col(there);
    second.col(node) = from.second.col(there);
    times.col(node) = from.times.col(there);
  }
};

/// Every second of `count` nodes is one of `known`, where these are half as many.
TorusReturn::Nodes TorusReturn::nodes_at(int count, const Nodes& known, const ParameterVector& par, int section,
                                         const TorusSettings& settings) const {
  const HybridSystem& system = suspended_->system();
  const Index n = curve_.dimension();
  const Index all = system.dimension();
  Nodes nodes{MatrixXd(n * all, count), MatrixXd(settings.order > 1 ? n * triangle(all) : 0, count), MatrixXd(1, count),
              known.defect, known.by_parameters};
  for (int node = 0; node < count; ++node) {
    if (node % 2 == 0 && count == 2 * known.count()) {
      nodes.take(node, known, node / 2);
      continue;
    }
    const double phi = static_cast<double>(node) / count;
    const VectorXd start = suspended_->suspended(on_curve(phi), par);
    const Signature path = return_path(system, start, par, section, suspended_->field(), settings.flow);
    const QuadraticMap map = smooth_return(system, path, start, par, settings.order, settings.flow);
    const VectorXd miss = curve_.difference(map.value.head(n), curve_.at(phi + curve_.rotation()));
    nodes.defect = std::max(nodes.defect, miss.cwiseQuotient(scale_).cwiseAbs().maxCoeff());
    if (!(nodes.defect <= largest_defect))
      throw UserError(
          fmt::format("the return map does not take the invariant curve to itself: it misses by {:.1e} of "
                      "the curve's extent; give the parameters of the simulation that the points come from, "
                      "as 'PAR(k)=v', and its section",
                      nodes.defect));
    const MatrixXd of_state = map.first.topRows(n);
    nodes.first.col(node) = Eigen::Map<const VectorXd>(of_state.data(), of_state.size());
    nodes.times(0, node) = map.time;
    if (all > n) nodes.by_parameters = std::max(nodes.by_parameters, of_state.rightCols(all - n).cwiseAbs().maxCoeff());
    Index row = 0;
    for (Index i = 0; i < n && settings.order > 1; ++i)
      for (Index a = 0; a < all; ++a)
        for (Index b = a; b < all; ++b) nodes.second(row++, node) = map.second[static_cast<std::size_t>(i)](a, b);
  }
  return nodes;
}

TorusReturn::TorusReturn(std::shared_ptr<const SuspendedSystem> suspended, InvariantCurve curve,
                         CurveProjection projection, const ParameterVector& par, int section,
                         const TorusSettings& settings)
    : suspended_(std::move(suspended)),
      curve_(std::move(curve)),
      projection_(std::move(projection)),
      par_(par),
      scale_(curve_.extent().cwiseMax(1e-3 * curve_.extent().maxCoeff())) {
  parameters_along_ = suspended_->suspended(curve_.at(0.0), par).tail(suspended_->system().dimension() - dimension());
  // As many as the curve has harmonics is a good guess.
  const int first_count = std::clamp(2 * (curve_.harmonics() / 2), 64, settings.most_nodes);
  Nodes nodes;
  for (int count = first_count; count <= settings.most_nodes; count *= 2) {
    nodes = nodes_at(count, nodes, par, section, settings);
    nodes_ = count;
    first_ = TrigonometricSeries::through(nodes.first);
    second_ = TrigonometricSeries::through(nodes.second);
    times_ = TrigonometricSeries::through(nodes.times);
    defect_ = nodes.defect;
    depends_ = nodes.by_parameters > 1e-10;
    mean_time_ = nodes.times.mean();
    interpolation_error_ = std::max(tail_of(first_), settings.order > 1 ? tail_of(second_) : 0.0);
    if (interpolation_error_ <= settings.accuracy) return;
  }
  if (!(interpolation_error_ <= largest_interpolation_error))
    throw UserError(
        fmt::format("the derivative of the return map varies too much along the invariant curve: error "
                    "{:.1e} with {} harmonics; take a section that the torus crosses at larger angles",
                    interpolation_error_, first_.harmonics()));
}

VectorXd TorusReturn::on_curve(double phi) const { return reduced(curve_, curve_.at(phi)); }

TorusReturn::Deviation TorusReturn::deviation(const VectorXd& x, const ParameterVector& par) const {
  const Index n = x.size();
  const double phi = projection_.phase(x);
  VectorXd u = suspended_->suspended(x, par);
  u.head(n) = curve_.difference(x, curve_.at(phi));
  u.tail(u.size() - n) -= parameters_along_;
  return {phi, std::move(u)};
}

/// n x N, or its derivatives by phi.
MatrixXd TorusReturn::matrix(double phi, int derivative) const {
  const VectorXd entries = first_.derivative(phi, derivative);
  return Eigen::Map<const MatrixXd>(entries.data(), curve_.dimension(), entries.size() / curve_.dimension());
}

/// u^T S_i u for each component.
VectorXd TorusReturn::quadratic(double phi, const VectorXd& u, int derivative) const {
  VectorXd out = VectorXd::Zero(curve_.dimension());
  if (second_.rows() == 0) return out;
  const VectorXd entries = second_.derivative(phi, derivative);
  Index row = 0;
  for (Index i = 0; i < out.size(); ++i)
    for (Index a = 0; a < u.size(); ++a)
      for (Index b = a; b < u.size(); ++b) out(i) += (a == b ? 1.0 : 2.0) * entries(row++) * u(a) * u(b);
  return out;
}

VectorXd TorusReturn::image(const VectorXd& x, const ParameterVector& par) const {
  const Deviation at = deviation(x, par);
  return reduced(curve_,
                 curve_.at(at.phi + curve_.rotation()) + matrix(at.phi, 0) * at.u + 0.5 * quadratic(at.phi, at.u, 0));
}

/// With phi_x the gradient of the projection: (u'(phi + rho) + A' d) phi_x + A (Id - u' phi_x), and the second order.
MatrixXd TorusReturn::derivative(const VectorXd& x, const ParameterVector& par) const {
  const Index n = x.size();
  const Deviation at = deviation(x, par);
  const RowVectorXd phi_x = projection_.gradient(x, at.phi);
  const MatrixXd first = matrix(at.phi, 0);
  const VectorXd tangent = curve_.derivative(at.phi);
  VectorXd by_phi =
      curve_.derivative(at.phi + curve_.rotation()) + matrix(at.phi, 1) * at.u - first.leftCols(n) * tangent;
  MatrixXd jacobian = first.leftCols(n);
  if (second_.rows() > 0) {
    by_phi += 0.5 * quadratic(at.phi, at.u, 1);
    const VectorXd entries = second_(at.phi);
    MatrixXd linear = MatrixXd::Zero(n, at.u.size());  // S_i u
    Index row = 0;
    for (Index i = 0; i < n; ++i)
      for (Index a = 0; a < at.u.size(); ++a)
        for (Index b = a; b < at.u.size(); ++b, ++row) {
          linear(i, a) += entries(row) * at.u(b);
          if (b != a) linear(i, b) += entries(row) * at.u(a);
        }
    jacobian += linear.leftCols(n);
    by_phi -= linear.leftCols(n) * tangent;
  }
  return jacobian + by_phi * phi_x;
}

double TorusReturn::time(const VectorXd& x) const { return times_(projection_.phase(x))(0); }

double TorusReturn::distance(const VectorXd& x) const {
  const VectorXd d = curve_.difference(x, curve_.at(projection_.phase(x)));
  return d.cwiseQuotient(scale_).cwiseAbs().maxCoeff();
}

}  // namespace tchat
