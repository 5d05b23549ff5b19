#include "continuation/orbit_trend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "orbit/equilibrium_system.hpp"
#include "stability/bifurcation_tests.hpp"

namespace tchat {

namespace {

/// The parameter stands still while it moves no more than this (relatively), the period grows by more than that factor.
constexpr double standstill = level::located;
constexpr double growth = 1.5;
/// A state whose range is a smaller share of it does not move.
constexpr double rounding = level::converged;

/// What deviates from its mean along each row: a state over the orbit, or a node's state over the returns of a torus.
Eigen::Map<const Eigen::MatrixXd> rows_of(const Eigen::MatrixXd& states, int orbits) {
  const Eigen::Index rows = orbits == 1 ? states.rows() : states.size() / orbits;
  return {states.data(), rows, states.size() / rows};
}

/// Work on rows first .. first + count - 1: four at a time, which lie side by side, the rest one by one.
template <class Work>
void for_rows(Eigen::Index rows, Work&& work) {
  Eigen::Index first = 0;
  for (; first + 4 <= rows; first += 4) work(std::integral_constant<std::size_t, 4>{}, first);
  for (; first < rows; ++first) work(std::integral_constant<std::size_t, 1>{}, first);
}

/// sum (x - mean x) (y - mean y), and those of the squares.
struct Products {
  double both = 0.0, x = 0.0, y = 0.0;
};

Products products_of_deviations(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, int orbits) {
  const auto of_x = rows_of(x, orbits);
  const auto of_y = rows_of(y, orbits);
  const Eigen::Index rows = of_x.rows();
  const Eigen::Index columns = of_x.cols();
  Products sums;
  for_rows(rows, [&](auto count, Eigen::Index first) {
    std::array<double, count> mean_x{}, mean_y{}, both{}, square_x{}, square_y{};
    const double* u = of_x.data() + first;
    const double* v = of_y.data() + first;
    for (Eigen::Index k = 0; k < columns; ++k)
      for (std::size_t a = 0; a < count; ++a) {
        mean_x[a] += u[k * rows + static_cast<Eigen::Index>(a)];
        mean_y[a] += v[k * rows + static_cast<Eigen::Index>(a)];
      }
    for (std::size_t a = 0; a < count; ++a) {
      mean_x[a] /= static_cast<double>(columns);
      mean_y[a] /= static_cast<double>(columns);
    }
    for (Eigen::Index k = 0; k < columns; ++k)
      for (std::size_t a = 0; a < count; ++a) {
        const double of_u = u[k * rows + static_cast<Eigen::Index>(a)] - mean_x[a];
        const double of_v = v[k * rows + static_cast<Eigen::Index>(a)] - mean_y[a];
        both[a] += of_u * of_v;
        square_x[a] += of_u * of_u;
        square_y[a] += of_v * of_v;
      }
    for (std::size_t a = 0; a < count; ++a) {
      sums.both += both[a];
      sums.x += square_x[a];
      sums.y += square_y[a];
    }
  });
  return sums;
}

struct Range {
  double low, high;
  double size() const { return high - low; }
};

Range range_of_state(const Orbit& x, int k) {
  const auto values = x.states.row(k);
  Range range{values(0), values(0)};
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    range.low = std::min(range.low, values(i));
    range.high = std::max(range.high, values(i));
  }
  return range;
}

/// Of the deviations of state k.
double deviation_range(const Orbit& x, int k, int orbits) {
  if (orbits == 1) return range_of_state(x, k).size();
  const auto returns = rows_of(x.states, orbits);
  Range range{INFINITY, -INFINITY};
  for (Eigen::Index row = k; row < returns.rows(); row += x.shape.dimension) {
    const double mean = returns.row(row).mean();
    range.low = std::min(range.low, returns.row(row).minCoeff() - mean);
    range.high = std::max(range.high, returns.row(row).maxCoeff() - mean);
  }
  return range.size();
}

}  // namespace

Eigen::VectorXd state_ranges(const Orbit& x) {
  return Eigen::VectorXd::NullaryExpr(x.shape.dimension,
                                      [&](Eigen::Index k) { return deviation_range(x, static_cast<int>(k), 1); });
}

bool is_smooth(const DefiningSystem& system) {
  const Signature& signature = system.signature();
  return std::all_of(signature.begin(), signature.end(), [&](const IndexVector& index) {
    return index.field == signature.front().field && is_identity_jump(system.system(), index);
  });
}

double deviation_cosine(const Orbit& x, const Orbit& y, int orbits) {
  const Products sums = products_of_deviations(x.states, y.states, orbits);
  const double sizes = std::sqrt(sums.x) * std::sqrt(sums.y);
  return sizes > 0.0 ? sums.both / sizes : 0.0;
}

double deviation_norm(const Orbit& x) { return std::sqrt(products_of_deviations(x.states, x.states, 1).x); }

double deviation_growth(const Orbit& x, const Eigen::MatrixXd& direction, int orbits) {
  const Products sums = products_of_deviations(x.states, direction, orbits);
  return sums.both / sums.x;
}

void OrbitTrend::add(const Orbit& x, double parameter, double parameter_size) {
  const bool first = largest_.size() == 0;
  if (first) {
    largest_.setZero(x.shape.dimension);
    sizes_.setZero(x.shape.dimension);
  }
  const Eigen::Index rows = x.states.rows();
  for_rows(rows, [&](auto count, Eigen::Index begin) {
    std::array<double, count> low, high;
    low.fill(INFINITY);
    high.fill(-INFINITY);
    const double* u = x.states.data() + begin;
    for (Eigen::Index k = 0; k < x.states.cols(); ++k)
      for (std::size_t a = 0; a < count; ++a) {
        low[a] = std::min(low[a], u[k * rows + static_cast<Eigen::Index>(a)]);
        high[a] = std::max(high[a], u[k * rows + static_cast<Eigen::Index>(a)]);
      }
    for (std::size_t a = 0; a < count; ++a) {
      const Eigen::Index k = begin + static_cast<Eigen::Index>(a);
      const double range = orbits_ == 1 ? high[a] - low[a] : deviation_range(x, static_cast<int>(k), orbits_);
      largest_(k) = std::max(largest_(k), range);
      sizes_(k) = std::max({sizes_(k), std::abs(low[a]), std::abs(high[a])});
    }
  });
  if (first) first_parameter_ = parameter;
  size_ = std::max({size_, parameter_size, std::abs(parameter - first_parameter_)});
  if (first || !(std::abs(parameter - still_.parameter) <= standstill * size_)) still_ = {parameter, x.period()};
  last_ = {parameter, x.period()};
}

double OrbitTrend::amplitude(const Orbit& x) const {
  double largest = 0.0;
  for (int k = 0; k < largest_.size(); ++k)
    if (largest_(k) > rounding * (1.0 + sizes_(k)))
      largest = std::max(largest, deviation_range(x, k, orbits_) / largest_(k));
  return largest;
}

bool OrbitTrend::has_shrunk(const Orbit& x, double share) const {
  const bool moves = (largest_.array() > rounding * (1.0 + sizes_.array())).any();
  return moves && amplitude(x) <= share;
}

std::optional<PeriodGrowth> OrbitTrend::period_growth() const {
  if (!(still_.period > 0.0 && last_.period > growth * still_.period)) return std::nullopt;
  return PeriodGrowth{still_.period, last_.period, last_.parameter, size_};
}

namespace {

using Eigen::VectorXd;

/// Distances are shares of the states' ranges over the orbit. Where the parameter stands still to 1e-6 an orbit misses
/// the equilibrium of its limit by about as little.
constexpr double at_rest_nearby = 0.01;

struct Equilibrium {
  int field = 1;
  VectorXd state;
  double distance = 0.0;  ///< of the orbit's slowest point
  Eigen::VectorXcd eigenvalues;
};

/// The largest entry of v as a share of the states' ranges; states that do not move are left out.
double scaled_size(const VectorXd& v, const VectorXd& ranges) {
  double size = 0.0;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (ranges(i) > 0.0) size = std::max(size, std::abs(v(i)) / ranges(i));
  return size;
}

struct SlowPoint {
  int field = 1;
  VectorXd state;
};

SlowPoint slowest_point(const DefiningSystem& system, const Orbit& x, const VectorXd& ranges) {
  SlowPoint slowest;
  VectorXd f(x.shape.dimension);
  double least = std::numeric_limits<double>::infinity();
  for (int s = 0; s < x.shape.segments; ++s)
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      const int field = system.signature()[static_cast<std::size_t>(s)].field;
      system.system().value(FunctionKind::field, field, x.node(s, k), x.par.data(), f.data());
      const double speed = scaled_size(f, ranges);
      if (!(speed < least)) continue;
      least = speed;
      slowest = {field, VectorXd::Map(x.node(s, k), x.shape.dimension)};
    }
  return slowest;
}

/// The equilibrium next to the orbit's slowest point, or, at index `active` of PAR, the fold at which two equilibria
/// have vanished there.
struct Resting {
  std::optional<Equilibrium> equilibrium, fold;
};

Resting near_equilibrium(const DefiningSystem& system, const Orbit& x, double size_of_parameter) {
  const VectorXd ranges = state_ranges(x);
  const SlowPoint start = slowest_point(system, x, ranges);
  if (start.state.size() == 0) return {};
  const auto near = [&](const VectorXd& state, const Eigen::MatrixXd& jacobian) -> std::optional<Equilibrium> {
    const double distance = scaled_size(state - start.state, ranges);
    if (!(distance <= at_rest_nearby)) return std::nullopt;
    return Equilibrium{start.field, state, distance, eigenvalues(jacobian)};
  };
  Resting resting;
  const int active = system.free_parameters().front();
  const VectorXd sizes = sizes_from_ranges(ranges, state_sizes(system.system(), system.signature(), x));
  const auto fold = find_fold(system.system(), start.field, start.state, x.par, active, sizes);
  if (fold && std::abs(fold->parameter - x.par(active - 1)) <= standstill * size_of_parameter)
    resting.fold = near(fold->state, fold->jacobian);
  if (const auto found = find_equilibrium(system.system(), start.field, start.state, x.par.data(), {}, ranges))
    resting.equilibrium = near(found->state, found->jacobian);
  return resting;
}

std::string eigenvalue_text(const Eigen::VectorXcd& values) {
  std::string text;
  for (const std::complex<double> value : values) {
    text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", value.real());
    if (value.imag() != 0.0)
      text += fmt::format(" {} {:.6g} i", value.imag() < 0.0 ? '-' : '+', std::abs(value.imag()));
  }
  return text;
}

/// Without an unstable direction an orbit leaves it by an event alone.
bool is_left_by_flow(const Eigen::VectorXcd& values) {
  const double largest = values.cwiseAbs().maxCoeff();
  const auto parts = values.real().array();
  return (parts >= -level::orbit * largest).any() && (parts <= level::orbit * largest).any();
}

}  // namespace

std::string homoclinic_limit(const DefiningSystem& system, const Orbit& x, const PeriodGrowth& growth,
                             const std::string& parameter_name) {
  const Resting resting = near_equilibrium(system, x, growth.size);
  const std::optional<Equilibrium>& at = resting.fold ? resting.fold : resting.equilibrium;
  if (!at) return "";
  const std::string field =
      fmt::format("field {} ({})", at->field, system.system().function_name(FunctionKind::field, at->field));
  const std::string state = state_text(system.system(), x, at->state.data());
  const std::string grows = fmt::format(
      "the period grows, from {:.5g} to {:.5g}, while {} stays at {:.10g}, and the "
      "orbit comes within {:.1e} of its size to ",
      growth.from, growth.to, parameter_name, growth.parameter, at->distance);
  if (resting.fold)
    return grows + fmt::format(
                       "a fold of the equilibria of {}: {}, eigenvalues {}; so the period grows without bound "
                       "towards a saddle-node on the orbit, or a homoclinic orbit beside it",
                       field, state, eigenvalue_text(at->eigenvalues));
  return grows + fmt::format("an equilibrium of {}: {}, eigenvalues {}; so the period grows without bound {}", field,
                             state, eigenvalue_text(at->eigenvalues),
                             is_left_by_flow(at->eigenvalues)
                                 ? "towards a homoclinic or heteroclinic orbit"
                                 : "towards an orbit that does not leave this equilibrium, which is no saddle");
}

SpecialPoint BranchAnalysis::shrunk(const Orbit&, bool) const { return {}; }

std::string BranchAnalysis::start_advice(const Orbit&) const {
  return "The largest ones say which part of the start, of the parameters or of the signature is wrong; a better "
         "start, a larger NTST or ITNW may help.";
}

}  // namespace tchat
