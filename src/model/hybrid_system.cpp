#include "model/hybrid_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "model/difference_derivatives.hpp"

namespace tchat {

namespace {

void require(bool condition, const std::string& what) {
  if (!condition) throw std::invalid_argument(what);
}

/// "" or what is wrong with the numbers of a sliding mode.
std::string fault_of(const tchat_problem& table, const tchat_sliding& mode) {
  const auto outside = [](int number, int count) { return number < 1 || number > count; };
  if (outside(mode.field, table.fields) || outside(mode.minus, table.fields) || outside(mode.plus, table.fields))
    return fmt::format("has the fields {}, {} and {}, there are 1..{}", mode.field, mode.minus, mode.plus,
                       table.fields);
  if (outside(mode.surface, table.events) || outside(mode.to_minus, table.events) ||
      outside(mode.to_plus, table.events))
    return fmt::format("has the event functions {}, {} and {}, there are 1..{}", mode.surface, mode.to_minus,
                       mode.to_plus, table.events);
  if (mode.field == mode.minus || mode.field == mode.plus || mode.minus == mode.plus)
    return fmt::format("has the fields {}, {} and {}, which must differ", mode.field, mode.minus, mode.plus);
  return "";
}

std::string name_or(const char* const* names, int count, int k, const char* fallback) {
  if (names != nullptr && k >= 1 && k <= count && names[k - 1] != nullptr) return names[k - 1];
  return fmt::format(fmt::runtime(fallback), k);
}

void identity_first(int n, const double* x, int active, double* out, double* dx, double* dp) {
  std::copy_n(x, n, out);
  std::fill_n(dx, n * n, 0.0);
  for (int a = 0; a < n; ++a) dx[a * n + a] = 1.0;
  if (dp != nullptr) std::fill_n(dp, n * active, 0.0);
}

void identity_second(int n, int active, const double* direction, double* out, double* dx, double* dp) {
  std::copy_n(direction, n, out);
  std::fill_n(dx, n * n, 0.0);
  if (dp != nullptr) std::fill_n(dp, n * active, 0.0);
}

}  // namespace

HybridSystem::HybridSystem(const tchat_problem& table) : table_(&table) {
  require(
      table.abi_version == TCHAT_PROBLEM_ABI,
      fmt::format("its interface version is {}, this tchat reads version {}", table.abi_version, TCHAT_PROBLEM_ABI));
  require(table.struct_size == sizeof(tchat_problem),
          fmt::format("its table has {} bytes, this tchat expects {}", table.struct_size, sizeof(tchat_problem)));
  require(table.name != nullptr, "its table has no name");
  require(table.dimension >= 1 && table.dimension <= most_states,
          fmt::format("its dimension is {}, allowed are 1..{}", table.dimension, most_states));
  require(table.parameters >= 0 && table.parameters <= most_parameters,
          fmt::format("it has {} parameters, allowed are 0..{}", table.parameters, most_parameters));
  // Smooth problems and boundary value problems need no events and jumps.
  require(table.fields >= 1 && table.events >= 0 && table.jumps >= 0,
          fmt::format("it has {} fields, {} events and {} jumps, at least one field is needed", table.fields,
                      table.events, table.jumps));
  require(table.boundary_conditions >= 0 && table.boundary_conditions <= most_states &&
              table.integral_conditions >= 0 && table.integral_conditions <= most_states,
          fmt::format("it has {} boundary and {} integral conditions, allowed are 0..{} of each",
                      table.boundary_conditions, table.integral_conditions, most_states));
  require(table.boundary_conditions == 0 || table.boundary != nullptr, "its table has no function `boundary`");
  require(table.value != nullptr, "its table has no function `value`");
  require(table.derivative_order < 1 || table.first != nullptr, "its table has no function `first`");
  require(table.derivative_order < 2 || table.second != nullptr, "its table has no function `second`");
  require(table.user_values == 0 || (table.user_values > 0 && table.user_value != nullptr),
          "its table has no function `user_value`");
  require(
      table.sliding_modes >= 0 && table.sliding_modes <= 1000 && (table.sliding_modes == 0 || table.sliding != nullptr),
      fmt::format("it has {} sliding modes, but its table does not list them", table.sliding_modes));
  const auto is_dimension = [&](std::int32_t k) { return k >= 1 && k <= table.dimension; };
  require((table.field_dimensions == nullptr) == (table.jump_dimensions == nullptr) || table.jumps == 0,
          "its table gives the dimensions of fields or of jumps, but not both");
  if (has_modes())
    require(
        std::all_of(table.field_dimensions, table.field_dimensions + table.fields, is_dimension) &&
            (table.jumps == 0 || std::all_of(table.jump_dimensions, table.jump_dimensions + table.jumps, is_dimension)),
        fmt::format("the dimension of a field or of what a jump leads to is not in 1..{}", table.dimension));
  for (const tchat_sliding& mode : sliding_modes()) {
    const std::string fault = fault_of(table, mode);
    require(fault.empty(), "a sliding mode of it " + fault);
  }
}

const tchat_sliding* HybridSystem::sliding_mode(int field) const {
  for (const tchat_sliding& mode : sliding_modes())
    if (mode.field == field) return &mode;
  return nullptr;
}

int HybridSystem::count(FunctionKind kind) const {
  switch (kind) {
    case FunctionKind::field:
      return table_->fields;
    case FunctionKind::event:
      return table_->events;
    case FunctionKind::jump:
      return table_->jumps;
    default:
      return table_->integral_conditions > 0 ? max_segments : 0;
  }
}

std::string HybridSystem::state_name(int k) const { return name_or(table_->state_names, dimension(), k, "U({})"); }

std::string HybridSystem::parameter_name(int k) const {
  if (k == layout().rotation()) return rotation_name;
  if (layout().is_duration(k, max_segments)) return layout().duration_name(k);
  return name_or(table_->parameter_names, parameters(), k, "PAR({})");
}

std::string HybridSystem::function_name(FunctionKind kind, int index) const {
  switch (kind) {
    case FunctionKind::field:
      return name_or(table_->field_names, table_->fields, index, "field {}");
    case FunctionKind::event:
      if (index == no_function) return "phase condition";
      return name_or(table_->event_names, table_->events, index, "event {}");
    case FunctionKind::jump:
      if (index == no_function) return "identity";
      return name_or(table_->jump_names, table_->jumps, index, "jump {}");
    default:
      return fmt::format("integrand on segment {}", index);
  }
}

int HybridSystem::parameter_index(const std::string& name) const {
  const char* const* const names = table_->parameter_names;
  for (int k = 1; names != nullptr && k <= parameters(); ++k)
    if (names[k - 1] != nullptr && name == names[k - 1]) return k;
  return name == rotation_name ? layout().rotation() : 0;
}

std::optional<std::vector<IndexVector>> HybridSystem::successors(const IndexVector& from, const double* x,
                                                                 const double* par) const {
  if (!has_successors()) return std::nullopt;
  const std::array<std::int32_t, 3> last{from.field, from.event, from.jump};
  std::vector<std::int32_t> to(3 * 64);
  const auto ask = [&] {
    return table_->successors(table_->self, last.data(), x, par, to.data(), static_cast<int>(to.size() / 3));
  };
  std::int32_t count = ask();
  if (static_cast<std::size_t>(std::max(count, 0)) > to.size() / 3) {
    if (count > 10000) return std::nullopt;
    to.resize(3 * static_cast<std::size_t>(count));
    count = std::min(ask(), count);
  }
  if (count < 0) return std::nullopt;
  std::vector<IndexVector> next;
  for (std::size_t v = 0; v < static_cast<std::size_t>(count); ++v)
    next.push_back({to[3 * v], to[3 * v + 1], to[3 * v + 2]});
  return next;
}

void HybridSystem::first(FunctionKind kind, int index, const double* x, const double* par, std::span<const int> active,
                         double* out, double* dx, double* dp) const {
  if (is_identity(kind, index))
    identity_first(dimension(), x, static_cast<int>(active.size()), out, dx, dp);
  else if (table_->derivative_order >= 1)
    table_->first(table_->self, static_cast<int>(kind), index, x, par, active.data(), static_cast<int>(active.size()),
                  out, dx, dp);
  else
    difference_first(*this, kind, index, x, par, active, out, dx, dp);
}

void HybridSystem::first_at_points(FunctionKind kind, int index, int points, const double* x, const double* par,
                                   std::span<const int> active, double* out, double* dx, double* dp) const {
  const int n = dimension();
  const int r = rows(kind);
  if (table_->derivative_order >= 1 && table_->first_at_points != nullptr && !is_identity(kind, index))
    return table_->first_at_points(table_->self, static_cast<int>(kind), index, points, x, par, active.data(),
                                   static_cast<int>(active.size()), out, dx, dp);
  for (int k = 0; k < points; ++k, x += n, out += r, dx += r * n, dp += static_cast<std::size_t>(r) * active.size())
    first(kind, index, x, par, active, out, dx, dp);
}

void HybridSystem::second(FunctionKind kind, int index, const double* x, const double* par, std::span<const int> active,
                          const double* direction, double* out, double* dx, double* dp) const {
  if (is_identity(kind, index))
    identity_second(dimension(), static_cast<int>(active.size()), direction, out, dx, dp);
  else if (table_->derivative_order >= 2)
    table_->second(table_->self, static_cast<int>(kind), index, x, par, active.data(), static_cast<int>(active.size()),
                   direction, out, dx, dp);
  else
    difference_second(*this, kind, index, x, par, active, direction, out, dx, dp);
}

void HybridSystem::third(FunctionKind kind, int index, const double* x, const double* par, double* out) const {
  if (is_identity(kind, index))
    std::copy_n(x, 8 * dimension(), out);
  else if (has_third())
    table_->third(table_->self, static_cast<int>(kind), index, x, par, out);
  else
    difference_third(*this, kind, index, x, par, out);
}

void HybridSystem::third_at_points(FunctionKind kind, int index, int points, const double* x, const double* par,
                                   double* out) const {
  if (table_->third_at_points != nullptr && !is_identity(kind, index))
    return table_->third_at_points(table_->self, static_cast<int>(kind), index, points, x, par, out);
  for (int k = 0; k < points; ++k, x += 8 * dimension(), out += 8 * rows(kind)) third(kind, index, x, par, out);
}

void HybridSystem::boundary_first(const OrbitEnds& at, std::span<const int> active, double* out, double* dstarts,
                                  double* dends, double* dp) const {
  if (table_->derivative_order >= 1 && table_->boundary_first != nullptr)
    table_->boundary_first(table_->self, at.segments, at.starts, at.ends, at.par, active.data(),
                           static_cast<int>(active.size()), out, dstarts, dends, dp);
  else
    difference_boundary(*this, at, active, out, dstarts, dends, dp);
}

int least_dimension(const HybridSystem& system, const Signature& signature) {
  int least = system.dimension();
  for (const IndexVector& v : signature) least = std::min(least, system.dimension_of(v.field));
  return least;
}

bool all_finite(const double* values, int count) {
  // The sum of x - x is zero exactly when every entry is finite; one pass without branches.
  double sum = 0.0;
  for (int i = 0; i < count; ++i) sum += values[i] - values[i];
  return sum == 0.0;
}

}  // namespace tchat
