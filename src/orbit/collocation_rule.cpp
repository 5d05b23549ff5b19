#include "orbit/collocation_rule.hpp"

#include <boost/math/special_functions/legendre.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "linear/dense_matrix.hpp"
#include "linear/memory.hpp"

namespace tchat {

namespace {

struct GaussRule {
  Eigen::VectorXd points;   // on [0, 1], rising
  Eigen::VectorXd weights;  // of unit sum
};

GaussRule gauss_rule(int order) {
  GaussRule rule{Eigen::VectorXd(order), Eigen::VectorXd(order)};
  const std::vector<double> zeros = boost::math::legendre_p_zeros<double>(order);  // the zeros in [0, 1)
  int filled = 0;
  const auto add = [&](double z) {
    const double slope = boost::math::legendre_p_prime(order, z);
    rule.points(filled) = 0.5 * (1.0 + z);
    rule.weights(filled) = 1.0 / ((1.0 - z * z) * slope * slope);
    ++filled;
  };
  for (auto z = zeros.rbegin(); z != zeros.rend(); ++z)
    if (*z > 0.0) add(-*z);
  for (const double z : zeros) add(z);
  return rule;
}

/// Norm of prod (sigma - node_i) / (c+1)! over the interval; that of c + 1 equally spaced nodes is a good measure.
double interpolation_constant(int c) {
  double worst = 0.0;
  for (int k = 0; k <= 200; ++k) {
    double product = 1.0;
    for (int i = 0; i <= c; ++i) product *= k / 200.0 - static_cast<double>(i) / c;
    worst = std::max(worst, std::abs(product));
  }
  return worst / std::tgamma(c + 2.0);
}

/// The error that arises on an interval, per size of the residual at its ends.
double residual_integral_of(const Eigen::VectorXd& gauss) {
  constexpr int samples = 400;
  const auto product = [&](double sigma) { return (sigma - gauss.array()).prod(); };
  double integral = 0.0;
  double largest = 0.0;
  for (int k = 0; k < samples; ++k) {
    integral += product((k + 0.5) / samples) / samples;
    largest = std::max(largest, std::abs(integral));
  }
  return largest / std::abs(product(0.0));
}

}  // namespace

CollocationRule::CollocationRule(int points)
    : value(points, points + 1),
      slope(points, points + 1),
      mass(Eigen::MatrixXd::Zero(points + 1, points + 1)),
      integral(Eigen::VectorXd::Zero(points + 1)),
      highest(points + 1),
      interpolation(interpolation_constant(points)),
      end_slope(2, points + 1),
      points_(points),
      nodes_(points + 1),
      barycentric_(points + 1) {
  const int nodes = points + 1;
  for (int i = 0; i < nodes; ++i) {
    nodes_(i) = static_cast<double>(i) / points;
    double product = 1.0;
    for (int k = 0; k < nodes; ++k)
      if (k != i) product *= static_cast<double>(i - k) / points;
    barycentric_(i) = 1.0 / product;
    // The leading coefficient of l_i is its barycentric weight; its c-th derivative is that times c!.
    highest(i) = std::tgamma(points + 1.0) / product;
  }

  GaussRule rule = gauss_rule(points);
  gauss = std::move(rule.points);
  weights = std::move(rule.weights);
  Eigen::VectorXd values(nodes);
  Eigen::VectorXd slopes(nodes);
  for (int j = 0; j < points; ++j) {
    basis(gauss(j), values.data(), slopes.data());
    value.row(j) = values.transpose();
    slope.row(j) = slopes.transpose();
  }
  const Eigen::VectorXi order = elimination_order(slope.rightCols(points));
  gauss = gauss(order).eval();
  weights = weights(order).eval();
  value = value(order, Eigen::all).eval();
  slope = slope(order, Eigen::all).eval();

  for (const int end : {0, 1}) {
    basis(end, values.data(), slopes.data());
    end_slope.row(end) = slopes.transpose();
  }
  residual_integral = residual_integral_of(gauss);

  const GaussRule exact = gauss_rule(nodes);  // exact to degree 2c + 1, the products have 2c
  for (int j = 0; j < nodes; ++j) {
    basis(exact.points(j), values.data(), nullptr);
    mass += exact.weights(j) * values * values.transpose();
    integral += exact.weights(j) * values;
  }
}

/// l_i = b_i prod_(k < i) (sigma - node_k) prod_(k > i) (sigma - node_k)
void CollocationRule::basis_values(double sigma, double* values) const {
  const int nodes = points_ + 1;
  double before = 1.0;
  for (int i = 0; i < nodes; ++i) {
    values[i] = barycentric_(i) * before;
    before *= sigma - nodes_(i);
  }
  double after = 1.0;
  for (int i = nodes - 1; i >= 0; --i) {
    values[i] *= after;
    after *= sigma - nodes_(i);
  }
}

void CollocationRule::basis(double sigma, double* values, double* slopes) const {
  if (slopes == nullptr) return basis_values(sigma, values);
  const int nodes = points_ + 1;
  for (int i = 0; i < nodes; ++i) {
    double product = barycentric_(i);
    double sum = 0.0;  // derivative of the product of (sigma - node_k)
    for (int k = 0; k < nodes; ++k) {
      if (k == i) continue;
      const double factor = sigma - nodes_(k);
      sum = sum * factor + product;
      product *= factor;
    }
    if (values != nullptr) values[i] = product;
    slopes[i] = sum;
  }
}

int interval_at(const Orbit& x, int s, double tau) {
  const double* const mesh = x.mesh_of(s);
  const int intervals = x.shape.intervals_of(s);
  const auto right = static_cast<int>(std::upper_bound(mesh, mesh + intervals + 1, tau) - mesh);
  return std::clamp(right - 1, 0, intervals - 1);
}

Eigen::VectorXd state_at(const Orbit& x, const CollocationRule& rule, int s, double tau) {
  Eigen::VectorXd state(x.shape.dimension);
  state_at(x, rule, s, tau, state.data());
  return state;
}

void state_at(const Orbit& x, const CollocationRule& rule, int s, double tau, double* state) {
  const int j = interval_at(x, s, tau);
  const double* const left = x.mesh_of(s) + j;
  const int c = x.shape.collocation;
  StackVector basis(c + 1);
  rule.basis((tau - left[0]) / (left[1] - left[0]), basis.data(), nullptr);
  Eigen::Map<Eigen::VectorXd>(state, x.shape.dimension).noalias() =
      x.states.middleCols(x.shape.first_node(s) + j * c, c + 1).lazyProduct(basis);
}

WeightedNorm::WeightedNorm(Eigen::VectorXd state_weights, ParameterVector parameter_weights)
    : state_weights_(std::move(state_weights)), parameter_weights_(std::move(parameter_weights)) {}

WeightedNorm WeightedNorm::unit(const OrbitShape& shape) {
  ParameterVector parameters(ParameterLayout(), shape.segments);
  parameters.setOnes();
  return {Eigen::VectorXd::Ones(shape.dimension), std::move(parameters)};
}

MassIntervals mass_intervals(const Orbit& x, const CollocationRule& rule, const Eigen::VectorXd& weights, int s) {
  return {x.mesh_of(s),   x.shape.intervals_of(s), rule.mass.data(), x.shape.collocation + 1,
          weights.data(), x.shape.dimension};
}

double WeightedNorm::dual(const Orbit& x, const CollocationRule& rule, const std::vector<int>& free_parameters,
                          const OrbitVector& v, OrbitVector& row) const {
  GrowingDot product(row.states.data(), v.states.data());
  for (int s = 0; s < x.shape.segments; ++s) {
    const MassIntervals mass = mass_intervals(x, rule, state_weights_, s);
    const int first = x.shape.first_node(s);
    row.states.middleCols(first, x.shape.nodes_of(s)).setZero();  // not all at once, to find it in the cache
    array_functions().add_mass(mass, v.states.col(first).data(), row.states.col(first).data());
    product.grow_to(long{first + x.shape.nodes_of(s)} * x.shape.dimension);
    row.durations(s) = parameter_weights_.duration(s) * v.durations(s);
  }
  for (std::size_t g = 0; g < free_parameters.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    row.globals(i) = parameter_weights_(free_parameters[g] - 1) * v.globals(i);
  }
  return product.value(row.states.size()) + row.durations.dot(v.durations) + row.globals.dot(v.globals);
}

namespace {

/// The largest component of the residual at the ends of the intervals of segment s.
double largest_residual(const HybridSystem& system, int field, const Orbit& x, const CollocationRule& rule, int s) {
  const int n = x.shape.dimension;
  const int c = x.shape.collocation;
  constexpr std::size_t usual_entries = 2048;
  const int intervals = x.shape.intervals_of(s);
  const double* const mesh = x.mesh_of(s);
  StackMatrix<usual_entries> slopes(n, 2 * static_cast<Eigen::Index>(intervals));
  array_functions().interpolate({rule.end_slope.data(), 2, c, n, intervals}, x.node(s, 0), slopes.data(), n);
  StackVector f(n);
  double largest = 0.0;
  for (int j = 0; j <= intervals; ++j) {
    system.value(FunctionKind::field, field, x.node(s, j * c), x.par.data(), f.data());
    if (!std::all_of(f.begin(), f.end(), [](double value) { return std::isfinite(value); })) continue;
    // The end of one interval is the start of the next one.
    for (const int side : {0, 1}) {
      const int interval = j - side;
      if (interval < 0 || interval >= intervals) continue;
      const double time = (mesh[interval + 1] - mesh[interval]) * x.duration(s);
      const double* slope = slopes.col(2 * interval + side).data();
      for (int a = 0; a < n; ++a) largest = std::max(largest, std::abs(slope[a] - time * f(a)));
    }
  }
  return largest;
}

}  // namespace

double estimated_error(const HybridSystem& system, const Signature& signature, const Orbit& x,
                       const CollocationRule& rule) {
  ArrayRange of_states{0.0, true};
  double residual = 0.0;
  for (int s = 0; s < x.shape.segments; ++s) {
    widen(of_states, array_functions().range(x.node(s, 0), long{x.shape.nodes_of(s)} * x.shape.dimension));
    if (!of_states.finite) return std::numeric_limits<double>::infinity();
    const int field = signature[static_cast<std::size_t>(s)].field;
    if (x.duration(s) != 0.0) residual = std::max(residual, largest_residual(system, field, x, rule, s));
  }
  return rule.residual_integral * residual / (1.0 + of_states.largest);
}

}  // namespace tchat
