#include "model/scales.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "linear/dense_matrix.hpp"

namespace tchat {

StateSizes::StateSizes(const Eigen::MatrixXd& states)
    : largest_(states.cwiseAbs().rowwise().maxCoeff()),
      shares_(Eigen::MatrixXd::Zero(states.rows(), states.rows())),
      in_events_(Eigen::VectorXd::Zero(states.rows())) {}

void StateSizes::add_states(const Eigen::VectorXd& values, const Eigen::MatrixXd& by_state) {
  const Eigen::MatrixXd terms = by_state.cwiseAbs() * largest_.asDiagonal();
  const Eigen::VectorXd sums = terms.rowwise().sum() + values.cwiseAbs();
  for (Eigen::Index j = 0; j < sums.size(); ++j)
    if (sums(j) > 0.0 && std::isfinite(sums(j))) shares_.row(j) = shares_.row(j).cwiseMax(terms.row(j) / sums(j));
}

void StateSizes::add_rates_at_rest(const Eigen::VectorXd& values, const Eigen::MatrixXd& by_state) {
  constexpr double cancelled = 0.01;
  add_states(values, by_state);
  const Eigen::MatrixXd terms = by_state.cwiseAbs() * largest_.asDiagonal();
  in_balance_ = Eigen::VectorXd::Zero(largest_.size());
  for (Eigen::Index j = 0; j < values.size(); ++j) {
    const double sum = terms.row(j).sum();
    if (sum > 0.0 && std::abs(values(j)) <= cancelled * sum)
      in_balance_ = in_balance_->cwiseMax(terms.row(j).transpose() / sum);
  }
}

void StateSizes::add_event(double value, const Eigen::RowVectorXd& by_state, const double* x) {
  const Eigen::VectorXd terms = by_state.transpose().cwiseAbs().cwiseProduct(largest_);
  const double constant = value - by_state.dot(Eigen::Map<const Eigen::VectorXd>(x, largest_.size()));
  const double sum = terms.sum() + std::abs(constant);
  if (sum > 0.0 && std::isfinite(sum)) in_events_ = in_events_.cwiseMax(terms / sum);
}

std::vector<bool> StateSizes::known() const {
  constexpr double small = 1e-9, least_share = 1e-7;
  const Eigen::Index n = largest_.size();
  const auto is_number = [&](Eigen::Index i) {
    const bool is_rounding = in_balance_ && !((*in_balance_)(i) > least_share);
    return !is_rounding && largest_(i) >= std::numeric_limits<double>::min() && std::isfinite(largest_(i));
  };
  // What nothing depends on may be as large as it likes.
  double largest = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double of_others = shares_.col(i).sum() - shares_(i, i) + in_events_(i);
    if (is_number(i) && of_others > 0.0) largest = std::max(largest, largest_(i));
  }
  std::vector<bool> has_size(static_cast<std::size_t>(n));
  const auto known = [&](Eigen::Index i) { return static_cast<bool>(has_size[static_cast<std::size_t>(i)]); };
  for (Eigen::Index i = 0; i < n; ++i)
    has_size[static_cast<std::size_t>(i)] =
        is_number(i) && (largest_(i) > small * largest || in_events_(i) > least_share);
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n && !known(i) && is_number(i); ++j)
        if (known(j) && shares_(j, i) > least_share) has_size[static_cast<std::size_t>(i)] = is_new = true;
  }
  return has_size;
}

Eigen::VectorXd StateSizes::sizes() const {
  const std::vector<bool> has_size = known();
  Eigen::VectorXd result = largest_;
  for (Eigen::Index i = 0; i < result.size(); ++i)
    if (!has_size[static_cast<std::size_t>(i)]) result(i) = 1.0;
  return result;
}

Eigen::VectorXd sizes_at(const HybridSystem& system, int field, const Eigen::VectorXd& x, const Eigen::VectorXd& par) {
  const Eigen::Index n = x.size();
  Eigen::VectorXd f(n);
  Eigen::MatrixXd by_state(n, n);
  system.first(FunctionKind::field, field, x.data(), par.data(), {}, f.data(), by_state.data(), nullptr);
  Eigen::VectorXd sizes = x.cwiseAbs();
  if (!f.allFinite() || !by_state.allFinite()) return sizes;
  const Eigen::VectorXd accelerations = by_state * f;
  constexpr double never = std::numeric_limits<double>::infinity(), rounding = 1e-6;
  const auto shorter = [](double time, double other) { return other > 0.0 && other < time ? other : time; };
  const double by_itself = shorter(never, 1.0 / eigenvalues(by_state).cwiseAbs().maxCoeff());
  Eigen::VectorXd times(n);
  for (Eigen::Index i = 0; i < n; ++i)
    times(i) = shorter(shorter(by_itself, sizes(i) / std::abs(f(i))), std::sqrt(sizes(i) / std::abs(accelerations(i))));
  // That of a state which is rounding of zero is far shorter than others.
  double longest = 0.0, shortest = never;
  for (const double time : times)
    if (std::isfinite(time)) longest = std::max(longest, time);
  for (const double time : times)
    if (time > rounding * longest) shortest = std::min(shortest, time);
  return std::isfinite(shortest) ? Eigen::VectorXd(sizes.cwiseMax(shortest * f.cwiseAbs())) : sizes;
}

bool is_ordinary(double size) {
  constexpr double ordinary = 1024.0;
  size = std::abs(size);
  const bool is_known = size >= std::numeric_limits<double>::min() && std::isfinite(size);
  return !is_known || (size <= ordinary && size >= 1.0 / ordinary);
}

double default_weight(double size) { return is_ordinary(size) ? 1.0 : 1.0 / (size * size); }

Eigen::VectorXd units_of(const Eigen::VectorXd& sizes) {
  constexpr double alike = 64.0;
  if (sizes.maxCoeff() <= alike && sizes.minCoeff() >= 1.0 / alike) return Eigen::VectorXd::Ones(sizes.size());
  return sizes.unaryExpr([](double size) { return std::exp2(std::round(std::log2(size))); });
}

Eigen::VectorXd units_of_states(const HybridSystem& system) {
  Eigen::VectorXd units(system.dimension());
  for (int k = 1; k <= system.dimension(); ++k) units(k - 1) = system.unit_of(k);
  return units;
}

namespace {

/// Room on each thread for the numbers of one call, which does not allocate once it is large enough.
template <int Number>
double* room(std::size_t size) {
  thread_local std::vector<double> numbers;
  if (numbers.size() < size) numbers.resize(size);
  return numbers.data();
}

/// Entry k of each of `points` arrays of n numbers, which are `lanes` side by side, times factor k.
void scale(double* values, const double* factors, int n, std::size_t points, int lanes = 1) {
  for (std::size_t p = 0; p < points; ++p)
    for (int k = 0; k < n; ++k)
      for (int l = 0; l < lanes; ++l) *values++ *= factors[k];
}

}  // namespace

struct ScaledProblem::Implementation {
  const tchat_problem* base;
  Scales scales;
  const Eigen::VectorXd& units = scales.units;
  Eigen::VectorXd inverse, initial;
  tchat_problem table;
  std::optional<HybridSystem> system;
  int n;

  Implementation(const HybridSystem& of, Scales given)
      : base(&of.table()), scales(std::move(given)), inverse(units.cwiseInverse()), table(*base), n(base->dimension) {
    system.emplace(table, &scales);
    if (units == Eigen::VectorXd::Ones(n)) return;  // the problem's own functions, no detour
    table.self = this;
    table.value = &value;
    if (base->first != nullptr) table.first = &first;
    if (base->second != nullptr) table.second = &second;
    if (base->successors != nullptr) table.successors = &successors;
    if (base->user_value != nullptr) table.user_value = &user_value;
    if (base->output_parameters != nullptr) table.output_parameters = &output_parameters;
    if (base->boundary != nullptr) table.boundary = &boundary;
    if (base->boundary_first != nullptr) table.boundary_first = &boundary_first;
    if (base->first_at_points != nullptr) table.first_at_points = &first_at_points;
    if (base->second_at_points != nullptr) table.second_at_points = &second_at_points;
    if (base->first_in_lanes != nullptr) table.first_in_lanes = &first_in_lanes;
    if (base->third != nullptr) table.third = &third;
    if (base->third_at_points != nullptr) table.third_at_points = &third_at_points;
    if (base->initial_state != nullptr) {
      initial = Eigen::Map<const Eigen::VectorXd>(base->initial_state, n).cwiseQuotient(units);
      table.initial_state = initial.data();
    }
  }

  static const Implementation& of(const void* self) { return *static_cast<const Implementation*>(self); }

  bool has_state_values(std::int32_t kind) const { return kind == TCHAT_FIELD || kind == TCHAT_JUMP; }
  int rows(std::int32_t kind) const {
    if (has_state_values(kind)) return n;
    return kind == TCHAT_EVENT ? 1 : base->integral_conditions;
  }
  /// x = u y of arrays of states, in the room of that number.
  template <int Number>
  const double* states(const double* y, std::size_t points, int lanes = 1) const {
    const std::size_t size = points * static_cast<std::size_t>(n) * static_cast<std::size_t>(lanes);
    double* const x = room<Number>(size);
    std::copy_n(y, size, x);
    scale(x, units.data(), n, points, lanes);
    return x;
  }
  /// F, one point after the other, as that of the scaled problem.
  void scale_values(std::int32_t kind, double* out, std::size_t points, int lanes = 1) const {
    if (has_state_values(kind)) scale(out, inverse.data(), n, points, lanes);
  }
  /// The same of derivatives of one point by states, rows x n, and by `active` parameters.
  void scale_derivatives(std::int32_t kind, double* dx, double* dp, int active, int lanes = 1) const {
    const int r = rows(kind);
    for (int c = 0; c < n; ++c)
      for (int k = 0; k < r * lanes; ++k) *dx++ *= units(c) * (has_state_values(kind) ? inverse(k / lanes) : 1.0);
    if (dp != nullptr) scale_values(kind, dp, static_cast<std::size_t>(active), lanes);
  }

  static void value(const void* self, std::int32_t kind, std::int32_t index, const double* y, const double* par,
                    double* out) {
    const Implementation& p = of(self);
    p.base->value(p.base->self, kind, index, p.states<0>(y, 1), par, out);
    p.scale_values(kind, out, 1);
  }

  static void first(const void* self, std::int32_t kind, std::int32_t index, const double* y, const double* par,
                    const std::int32_t* active, std::int32_t count, double* out, double* dy, double* dp) {
    const Implementation& p = of(self);
    p.base->first(p.base->self, kind, index, p.states<0>(y, 1), par, active, count, out, dy, dp);
    p.scale_values(kind, out, 1);
    p.scale_derivatives(kind, dy, dp, count);
  }

  static void first_at_points(const void* self, std::int32_t kind, std::int32_t index, std::int32_t points,
                              const double* y, const double* par, const std::int32_t* active, std::int32_t count,
                              double* out, double* dy, double* dp) {
    const Implementation& p = of(self);
    const auto all = static_cast<std::size_t>(points);
    p.base->first_at_points(p.base->self, kind, index, points, p.states<0>(y, all), par, active, count, out, dy, dp);
    p.scale_values(kind, out, all);
    const int r = p.rows(kind);
    for (std::int32_t k = 0; k < points; ++k, dy += r * p.n, dp += r * count) p.scale_derivatives(kind, dy, dp, count);
  }

  static void first_in_lanes(const void* self, std::int32_t kind, std::int32_t index, std::int32_t sets,
                             const double* y, const double* par, const std::int32_t* active, std::int32_t count,
                             double* out, double* dy, double* dp) {
    constexpr int lanes = TCHAT_POINTS_OF_SET;
    const Implementation& p = of(self);
    const auto all = static_cast<std::size_t>(sets);
    p.base->first_in_lanes(p.base->self, kind, index, sets, p.states<0>(y, all, lanes), par, active, count, out, dy,
                           dp);
    p.scale_values(kind, out, all, lanes);
    const int r = lanes * p.rows(kind);
    for (std::int32_t k = 0; k < sets; ++k, dy += r * p.n, dp += r * count)
      p.scale_derivatives(kind, dy, dp, count, lanes);
  }

  /// direction = (v, w), v in units as y.
  static void second(const void* self, std::int32_t kind, std::int32_t index, const double* y, const double* par,
                     const std::int32_t* active, std::int32_t count, const double* direction, double* out, double* dy,
                     double* dp) {
    const Implementation& p = of(self);
    double* const along = room<1>(static_cast<std::size_t>(p.n + count));
    std::copy_n(direction, p.n + count, along);
    scale(along, p.units.data(), p.n, 1);
    p.base->second(p.base->self, kind, index, p.states<0>(y, 1), par, active, count, along, out, dy, dp);
    p.scale_values(kind, out, 1);
    p.scale_derivatives(kind, dy, dp, count);
  }

  /// Weights belong to values u^-1 F.
  static void second_at_points(const void* self, std::int32_t kind, std::int32_t index, std::int32_t points,
                               std::int32_t directions, const double* y, const double* par, const std::int32_t* active,
                               std::int32_t count, const double* v, const double* q, const double* weights, double* out,
                               double* gradient) {
    const Implementation& p = of(self);
    const auto all = static_cast<std::size_t>(points), each = static_cast<std::size_t>(directions);
    const std::size_t numbers = all * (each + 1) * static_cast<std::size_t>(p.rows(kind));
    double* const scaled_weights = room<2>(numbers);
    std::copy_n(weights, numbers, scaled_weights);
    p.scale_values(kind, scaled_weights, all * (each + 1));
    p.base->second_at_points(p.base->self, kind, index, points, directions, p.states<0>(y, all), par, active, count,
                             p.states<1>(v, all * each), q, scaled_weights, out, gradient);
    p.scale_values(kind, out, all * each);
    for (std::int32_t k = 0; k < points; ++k, gradient += p.n + count) scale(gradient, p.units.data(), p.n, 1);
  }

  static void third(const void* self, std::int32_t kind, std::int32_t index, const double* y, const double* par,
                    double* out) {
    const Implementation& p = of(self);
    p.base->third(p.base->self, kind, index, p.states<0>(y, 8), par, out);
    p.scale_values(kind, out, 8);
  }

  static void third_at_points(const void* self, std::int32_t kind, std::int32_t index, std::int32_t points,
                              const double* y, const double* par, double* out) {
    const Implementation& p = of(self);
    const std::size_t all = 8 * static_cast<std::size_t>(points);
    p.base->third_at_points(p.base->self, kind, index, points, p.states<0>(y, all), par, out);
    p.scale_values(kind, out, all);
  }

  static std::int32_t successors(const void* self, const std::int32_t from[3], const double* y, const double* par,
                                 std::int32_t* to, std::int32_t capacity) {
    const Implementation& p = of(self);
    return p.base->successors(p.base->self, from, p.states<0>(y, 1), par, to, capacity);
  }

  static void user_value(const void* self, const double* y, const double* par, double* out) {
    const Implementation& p = of(self);
    p.base->user_value(p.base->self, p.states<0>(y, 1), par, out);
  }

  static void output_parameters(const void* self, std::int32_t segment, const double* y, double* par) {
    const Implementation& p = of(self);
    p.base->output_parameters(p.base->self, segment, p.states<0>(y, 1), par);
  }

  static void boundary(const void* self, std::int32_t segments, const double* starts, const double* ends,
                       const double* par, double* out) {
    const Implementation& p = of(self);
    const auto all = static_cast<std::size_t>(segments);
    p.base->boundary(p.base->self, segments, p.states<0>(starts, all), p.states<1>(ends, all), par, out);
  }

  static void boundary_first(const void* self, std::int32_t segments, const double* starts, const double* ends,
                             const double* par, const std::int32_t* active, std::int32_t count, double* out,
                             double* dstarts, double* dends, double* dp) {
    const Implementation& p = of(self);
    const auto all = static_cast<std::size_t>(segments);
    p.base->boundary_first(p.base->self, segments, p.states<0>(starts, all), p.states<1>(ends, all), par, active, count,
                           out, dstarts, dends, dp);
    for (double* const derivative : {dstarts, dends}) p.scale_columns(derivative, segments * p.n);
  }

  /// Of boundary conditions: column c belongs to state c modulo n.
  void scale_columns(double* derivative, int columns) const {
    for (int c = 0; c < columns; ++c)
      for (int r = 0; r < base->boundary_conditions; ++r) *derivative++ *= units(c % n);
  }
};

ScaledProblem::ScaledProblem(const HybridSystem& base, Scales scales)
    : p_(std::make_unique<Implementation>(base, std::move(scales))) {}
ScaledProblem::~ScaledProblem() = default;

const HybridSystem& ScaledProblem::system() const { return *p_->system; }
const Eigen::VectorXd& ScaledProblem::units() const { return p_->units; }

}  // namespace tchat
