#include "model/scaled_problem.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace tchat {

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

}  // namespace tchat
