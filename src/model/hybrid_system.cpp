#include "model/hybrid_system.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "base/levels.hpp"

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

std::string fault_of(const tchat_problem& table, const tchat_chatter& mode) {
  const auto outside = [](int number, int count) { return number < 1 || number > count; };
  if (outside(mode.field, table.fields) || outside(mode.contact, table.fields))
    return fmt::format("has the fields {} and {}, there are 1..{}", mode.field, mode.contact, table.fields);
  if (outside(mode.event, table.events) || outside(mode.release, table.events) || outside(mode.margin, table.events) ||
      (mode.time != 0 && outside(mode.time, table.events)))
    return fmt::format("has the event functions {}, {}, {} and {}, there are 1..{}", mode.event, mode.release,
                       mode.margin, mode.time, table.events);
  if (outside(mode.impact, table.jumps) || outside(mode.limit, table.jumps) || outside(mode.leave, table.jumps))
    return fmt::format("has the jumps {}, {} and {}, there are 1..{}", mode.impact, mode.limit, mode.leave,
                       table.jumps);
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

HybridSystem::HybridSystem(const tchat_problem& table, const Scales* scales) : table_(&table), scales_(scales) {
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
  require(
      table.chatter_modes >= 0 && table.chatter_modes <= 1000 && (table.chatter_modes == 0 || table.chatter != nullptr),
      fmt::format("it has {} chatter modes, but its table does not list them", table.chatter_modes));
  for (int k = 0; k < table.chatter_modes; ++k) {
    const std::string fault = fault_of(table, table.chatter[k]);
    require(fault.empty(), "a chatter mode of it " + fault);
  }
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

namespace {

template <class Condition>
const tchat_chatter* find_chatter(const tchat_problem& table, const Condition& condition) {
  const tchat_chatter* const end = table.chatter + table.chatter_modes;
  const tchat_chatter* const found = std::find_if(table.chatter, end, condition);
  return found == end ? nullptr : found;
}

}  // namespace

const tchat_chatter* HybridSystem::chatter_with_limit(int jump) const {
  return find_chatter(*table_, [&](const tchat_chatter& mode) { return mode.limit == jump; });
}

const tchat_chatter* HybridSystem::chatter_in_contact(int field) const {
  return find_chatter(*table_, [&](const tchat_chatter& mode) { return mode.contact == field; });
}

const tchat_chatter* HybridSystem::chatter_of_impact(const IndexVector& index) const {
  return find_chatter(*table_, [&](const tchat_chatter& mode) {
    return IndexVector{mode.field, mode.event, mode.impact} == index;
  });
}

bool HybridSystem::comes_before_limit(const Signature& signature, std::size_t at) const {
  const tchat_chatter* const mode = chatter_of_impact(signature[at]);
  std::size_t next = at;
  do next = (next + 1) % signature.size();
  while (mode != nullptr && next != at && signature[next] == signature[at]);
  return mode != nullptr && signature[next] == IndexVector{mode->field, mode->event, mode->limit};
}

std::vector<std::size_t> HybridSystem::without_chatter(const Signature& signature) const {
  std::vector<std::size_t> segments;
  for (std::size_t s = 0; s < signature.size(); ++s)
    if (!comes_before_limit(signature, s) && chatter_with_limit(signature[s].jump) == nullptr) segments.push_back(s);
  return segments;
}

bool HybridSystem::is_made_by_chatter(FunctionKind kind, int index) const {
  return find_chatter(*table_, [&](const tchat_chatter& mode) {
           return kind == FunctionKind::jump
                      ? index == mode.limit || index == mode.leave
                      : kind == FunctionKind::event && (index == mode.margin || index == mode.time);
         }) != nullptr;
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

int HybridSystem::successors(const IndexVector& from, const double* x, const double* par,
                             std::span<std::int32_t> to) const {
  if (!has_successors()) return -1;
  const std::array<std::int32_t, 3> last{from.field, from.event, from.jump};
  return table_->successors(table_->self, last.data(), x, par, to.data(), static_cast<int>(to.size() / 3));
}

std::optional<std::vector<IndexVector>> HybridSystem::successors(const IndexVector& from, const double* x,
                                                                 const double* par) const {
  std::vector<std::int32_t> to(3 * 64);
  const auto ask = [&] { return successors(from, x, par, to); };
  int count = ask();
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

namespace {

/// Numbers on the stack, as long as they are not too many.
class Column {
 public:
  /// Not set.
  explicit Column(int size) : size_(static_cast<std::size_t>(size)) {
    if (size_ > few_.size()) many_.resize(size_);
    begin_ = size_ > few_.size() ? many_.data() : few_.data();
  }
  Column(const Column& other) : Column(static_cast<int>(other.size_)) { std::copy_n(other.begin_, size_, begin_); }
  Column& operator=(const Column&) = delete;
  ~Column() = default;

  double* data() { return begin_; }
  const double* data() const { return begin_; }
  double& operator[](std::size_t k) { return begin_[k]; }
  std::size_t size() const { return size_; }
  void set_zero() { std::fill_n(begin_, size_, 0.0); }

 private:
  std::array<double, 1000> few_;
  std::vector<double> many_;
  std::size_t size_;
  double* begin_;
};

constexpr double first_step = 2e-3;  // truncation (h^6) and rounding (1/h) are then of a size
constexpr double reduction = 1.0 / 16.0;
constexpr int step_sizes = 4;

/// Relative errors of a function's values, generously: one that is computed, one that is a difference itself.
constexpr double computed = 1e3 * std::numeric_limits<double>::epsilon();
constexpr double differenced = level::differences;

/// A copy of the point that differences may move.
struct MovablePoint {
  Column x;
  Column par;

  MovablePoint(const HybridSystem& system, const double* x0, const double* par0)
      : x(system.dimension()), par(system.layout().room()) {
    std::copy_n(x0, x.size(), x.data());
    std::copy_n(par0, par.size(), par.data());
  }
  double& variable(int c, int n, std::span<const int> active) {
    // No function depends on what is beyond, nor on the last entry.
    if (c < n) return x[static_cast<std::size_t>(c)];
    return par[std::min(static_cast<std::size_t>(active[static_cast<std::size_t>(c - n)]), par.size()) - 1];
  }
};

/// phi'(0) of sixth order from phi(+-h), phi(+-2h), phi(+-3h). True when the fourth-order value agrees.
template <class Function>
bool difference_with_step(const Function& phi, double error, double h, int rows, double* derivative) {
  std::array<Column, 3> odd{Column(rows), Column(rows), Column(rows)};  // phi(kh) - phi(-kh)
  Column size(rows);
  size.set_zero();
  Column value(rows);
  for (std::size_t k = 0; k < 3; ++k) {
    const double t = h * static_cast<double>(k + 1);
    phi(t, odd[k].data());
    phi(-t, value.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(rows); ++i) {
      size[i] = std::max(size[i], std::abs(value[i]));
      odd[k][i] -= value[i];
    }
  }
  bool agrees = true;
  for (std::size_t i = 0; i < static_cast<std::size_t>(rows); ++i) {
    const double sixth = (45.0 * odd[0][i] - 9.0 * odd[1][i] + odd[2][i]) / (60.0 * h);
    const double fourth = (8.0 * odd[0][i] - odd[1][i]) / (12.0 * h);
    derivative[i] = sixth;
    agrees = agrees && std::abs(sixth - fourth) <= level::tolerance * std::abs(sixth) + error * size[i] / h;
  }
  return agrees;
}

/// phi'(0), phi(t, out) writing `rows` numbers with relative error `error` and varying on the scale `unit` of t.
template <class Function>
void difference(const Function& phi, double error, double unit, int rows, double* derivative) {
  double h = first_step * unit;
  for (int k = 0; k < step_sizes; ++k, h *= reduction)
    if (difference_with_step(phi, error, h, rows, derivative)) return;
}

/// F(point, out) itself.
class Value {
 public:
  static constexpr double error = computed;
  Value(const HybridSystem& system, FunctionKind kind, int index) : system_(system), kind_(kind), index_(index) {}
  void operator()(const MovablePoint& at, double* f) const {
    system_.value(kind_, index_, at.x.data(), at.par.data(), f);
  }

 private:
  const HybridSystem& system_;
  FunctionKind kind_;
  int index_;
};

/// Derivative of F(point, out) by one variable of the point.
template <class Function>
void difference_column(const Function& function, MovablePoint& point, double& variable, int rows, double* column) {
  const double at = variable;
  const auto moved = [&](double t, double* out) {
    variable = at + t;
    function(point, out);
  };
  difference(moved, Function::error, 1.0 + std::abs(at), rows, column);
  variable = at;
}

template <class Function>
void difference_columns(const Function& function, const HybridSystem& system, int rows, const double* x,
                        const double* par, std::span<const int> active, double* dx, double* dp) {
  const int n = system.dimension();
  MovablePoint point(system, x, par);
  for (int c = 0; c < n + static_cast<int>(active.size()); ++c)
    difference_column(function, point, point.variable(c, n, active), rows, c < n ? dx + c * rows : dp + (c - n) * rows);
}

/// D = F_x v + F_p w from the table's first derivatives.
class SuppliedDirectional {
 public:
  static constexpr double error = computed;
  SuppliedDirectional(const HybridSystem& system, FunctionKind kind, int index, int rows, std::span<const int> active,
                      const double* direction)
      : system_(system),
        kind_(kind),
        index_(index),
        rows_(static_cast<std::size_t>(rows)),
        active_(active),
        direction_(direction),
        f_(rows_),
        first_(rows_ * (static_cast<std::size_t>(system.dimension()) + active.size())) {}

  void operator()(const MovablePoint& at, double* d) const {
    const auto n = static_cast<std::size_t>(system_.dimension());
    system_.first(kind_, index_, at.x.data(), at.par.data(), active_, f_.data(), first_.data(),
                  first_.data() + rows_ * n);
    std::fill(d, d + rows_, 0.0);
    for (std::size_t c = 0; c < n + active_.size(); ++c)
      for (std::size_t i = 0; i < rows_; ++i) d[i] += first_[c * rows_ + i] * direction_[c];
  }

 private:
  const HybridSystem& system_;
  FunctionKind kind_;
  int index_;
  std::size_t rows_;
  std::span<const int> active_;
  const double* direction_;
  mutable std::vector<double> f_, first_;
};

/// D as a difference of values along the direction.
class DifferencedDirectional {
 public:
  static constexpr double error = differenced;
  DifferencedDirectional(const HybridSystem& system, FunctionKind kind, int index, int rows,
                         std::span<const int> active, const double* direction)
      : system_(system), kind_(kind), index_(index), rows_(rows), active_(active), direction_(direction) {}

  void operator()(const MovablePoint& at, double* d) const {
    const int n = system_.dimension();
    const int variables = n + static_cast<int>(active_.size());
    MovablePoint from = at;
    double unit = INFINITY;  // no variable moves by more than its own scale
    for (int c = 0; c < variables; ++c)
      if (direction_[c] != 0.0)
        unit = std::min(unit, (1.0 + std::abs(from.variable(c, n, active_))) / std::abs(direction_[c]));
    if (!std::isfinite(unit)) {
      std::fill(d, d + rows_, 0.0);
      return;
    }
    MovablePoint point = at;
    const auto along = [&](double t, double* out) {
      for (int c = 0; c < variables; ++c)
        point.variable(c, n, active_) = from.variable(c, n, active_) + t * direction_[c];
      system_.value(kind_, index_, point.x.data(), point.par.data(), out);
    };
    difference(along, computed, unit, rows_, d);
  }

 private:
  const HybridSystem& system_;
  FunctionKind kind_;
  int index_;
  int rows_;
  std::span<const int> active_;
  const double* direction_;
};

}  // namespace

void difference_first(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                      std::span<const int> active, double* out, double* dx, double* dp) {
  difference_columns(Value(system, kind, index), system, system.rows(kind), x, par, active, dx, dp);
  system.value(kind, index, x, par, out);
}

void difference_by_parameter(const HybridSystem& system, FunctionKind kind, int index, const double* x,
                             const double* par, int k, double* column) {
  MovablePoint point(system, x, par);
  double& variable = point.variable(system.dimension(), system.dimension(), std::span(&k, 1));
  difference_column(Value(system, kind, index), point, variable, system.rows(kind), column);
}

void difference_second(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                       std::span<const int> active, const double* direction, double* out, double* dx, double* dp) {
  const int rows = system.rows(kind);
  const MovablePoint here(system, x, par);
  const auto differentiate = [&](const auto& directional) {
    directional(here, out);
    difference_columns(directional, system, rows, x, par, active, dx, dp);
  };
  if (system.table().derivative_order >= 1)
    differentiate(SuppliedDirectional(system, kind, index, rows, active, direction));
  else
    differentiate(DifferencedDirectional(system, kind, index, rows, active, direction));
}

void difference_third(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                      double* out) {
  const Eigen::Index n = system.dimension();
  const Eigen::Index r = system.rows(kind);
  const Eigen::Map<const Eigen::MatrixXd> at(x, n, 8);
  Eigen::Map<Eigen::MatrixXd> of(out, r, 8);
  Eigen::VectorXd value(r), along(r);
  Eigen::MatrixXd fx(r, n), matrix(r, n);
  system.first(kind, index, x, par, {}, value.data(), fx.data(), nullptr);
  const auto second = [&](const Eigen::VectorXd& state, int m) -> const Eigen::MatrixXd& {
    system.second(kind, index, state.data(), par, {}, at.col(m).data(), along.data(), matrix.data(), nullptr);
    return matrix;
  };
  of.col(0) = value;
  of.rightCols(7).noalias() = fx * at.rightCols(7);
  const Eigen::VectorXd state = at.col(0);
  const Eigen::MatrixXd by_first = second(state, 1);
  const Eigen::MatrixXd by_second = second(state, 2);
  of.col(3) += by_first * at.col(2);
  of.col(5) += by_first * at.col(4);
  of.col(6) += by_second * at.col(4);
  of.col(7) += by_first * at.col(6) + by_second * at.col(5) + second(state, 4) * at.col(3);
  const double size = at.col(4).norm();
  if (size == 0.0 || at.col(1).isZero(0.0) || at.col(2).isZero(0.0)) return;
  const double step = 1e-3 * (1.0 + state.norm()) / size;
  const auto difference = [&](double h) {
    const Eigen::VectorXd ahead = second(state + h * at.col(4), 1) * at.col(2);
    return Eigen::VectorXd((ahead - second(state - h * at.col(4), 1) * at.col(2)) / (2.0 * h));
  };
  of.col(7) += (4.0 * difference(0.5 * step) - difference(step)) / 3.0;
}

void difference_boundary(const HybridSystem& system, const OrbitEnds& at, std::span<const int> active, double* out,
                         double* dstarts, double* dends, double* dp) {
  const int rows = system.boundary_conditions();
  const auto count = static_cast<std::size_t>(system.dimension()) * static_cast<std::size_t>(at.segments);
  std::vector<double> starts(at.starts, at.starts + count);
  std::vector<double> ends(at.ends, at.ends + count);
  std::vector<double> par(at.par, at.par + system.layout().room(at.segments));
  const OrbitEnds near{at.segments, starts.data(), ends.data(), par.data()};
  const auto column = [&](double& variable, double* derivative) {
    const double here = variable;
    const auto moved = [&](double t, double* values) {
      variable = here + t;
      system.boundary(near, values);
    };
    difference(moved, computed, 1.0 + std::abs(here), rows, derivative);
    variable = here;
  };
  for (std::size_t c = 0; c < count; ++c) {
    const std::size_t place = c * static_cast<std::size_t>(rows);
    column(starts[c], dstarts + place);
    column(ends[c], dends + place);
  }
  for (const int k : active) {
    column(par[static_cast<std::size_t>(k - 1)], dp);
    dp += rows;
  }
  system.boundary(at, out);
}

}  // namespace tchat
