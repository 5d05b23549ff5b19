#include "plugin/fortran_problem.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <new>

#include "base/messages.hpp"
#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

void insert(std::vector<int>& ascending, int index) {
  if (index == no_function) return;
  const auto place = std::lower_bound(ascending.begin(), ascending.end(), index);
  if (place == ascending.end() || *place != index) ascending.insert(place, index);
}

}  // namespace

void ProblemSizes::add(const IndexVector& index) {
  insert(fields, index.field);
  insert(events, index.event);
  insert(jumps, index.jump);
}

void ProblemSizes::add_jump(int k) { insert(jumps, k); }

ProblemSizes problem_sizes(const RunSettings& settings) {
  ProblemSizes sizes;
  sizes.dimension = settings.dimension;
  sizes.segments = static_cast<int>(settings.segments.size());
  sizes.derivative_order = settings.derivative_order;
  if (signature_rules(settings).counts_conditions) {
    sizes.boundary_conditions = settings.boundary_conditions;
    sizes.integral_conditions = settings.integral_conditions;
  }
  const ParameterLayout few;  // no more parameters are known without the problem
  const bool has_rotation = family_of(settings).facts().has_rotation;
  for (const int k : settings.free_parameters)
    if (k < few.first_duration() && !(has_rotation && k == few.rotation()))
      sizes.parameters = std::max(sizes.parameters, k);
  for (const SegmentSettings& segment : settings.segments) {
    sizes.add(segment.index);
    for (const int event : segment.monitor) insert(sizes.events, event);
  }
  const bool is_given = settings.grazing_jump != RunSettings{}.grazing_jump;
  if (keeps_contact(settings.problem_type) || is_given) sizes.add_jump(settings.grazing_jump);
  return sizes;
}

namespace {

constexpr std::uint64_t unset_bits = 0x7ff8746368617400;  // a quiet NaN with a payload of its own
constexpr int beyond = 16;                                // states that a library written for a larger N may touch
constexpr int large = 128;                                // states from where second derivatives get room on demand

template <class Function>
Function find(void* library, const char* name) {
  return reinterpret_cast<Function>(dlsym(library, name));
}

template <class Function>
Function require(const std::string& path, void* library, const char* symbol, const char* subroutine, bool is_needed) {
  const Function function = find<Function>(library, symbol);
  if (function != nullptr || !is_needed) return function;
  throw UserError(fmt::format(
      "plugin {}: SUBROUTINE {} is missing (the library does not export {}).\n"
      "  A Fortran problem has GCFUNC (fields), GCBOUND (event functions) and JUMPMAP (jumps), for boundary "
      "value problems GCFUNC, GCBCND (boundary conditions) and, with NINT > 0, GCICND (integrands).",
      path, subroutine, symbol));
}

}  // namespace

bool is_fortran_problem(void* library) {
  return dlsym(library, "gcfunc_") != nullptr || dlsym(library, "gcbound_") != nullptr ||
         dlsym(library, "jumpmap_") != nullptr;
}

void FortranCalls::Free::operator()(double* memory) const { std::free(memory); }

FortranCalls::FortranCalls(const std::string& path, void* library, const ProblemSizes& sizes)
    : n_(sizes.dimension),
      value_room_(std::max(n_, sizes.integral_conditions) + beyond),
      par_room_(ParameterLayout(sizes.parameters).room()),
      field_(require<Derivatives>(path, library, "gcfunc_", "GCFUNC", true)),
      event_(require<Derivatives>(path, library, "gcbound_", "GCBOUND", !sizes.events.empty())),
      integrand_(require<Derivatives>(path, library, "gcicnd_", "GCICND", sizes.integral_conditions > 0)),
      jump_(require<Jump>(path, library, "jumpmap_", "JUMPMAP", !sizes.jumps.empty())),
      starting_values_(find<StartingValues>(library, "gcstpnt_")),
      output_parameters_(find<OutputParameters>(library, "gcpvls_")),
      boundary_(require<Boundary>(path, library, "gcbcnd_", "GCBCND", sizes.boundary_conditions > 0)),
      integrals_(sizes.integral_conditions),
      count_(sizes.boundary_conditions) {
  const bool second = sizes.derivative_order >= 2 || n_ <= large;
  const auto size = static_cast<std::size_t>(n_);
  const auto room = static_cast<std::size_t>(value_room_);
  const auto parameters = static_cast<std::size_t>(par_room_);
  const std::size_t extents[] = {size + beyond,
                                 parameters + beyond,
                                 room,
                                 size * room + beyond,
                                 room * parameters + room,
                                 second ? size * size * room + beyond : 1,
                                 second ? room * size * parameters + room : 1};
  std::size_t total = 0;
  for (const std::size_t extent : extents) total += extent;
  // Large arrays that are never touched cost nothing this way.
  memory_.reset(static_cast<double*>(std::calloc(total, sizeof(double))));
  if (memory_ == nullptr) throw std::bad_alloc();
  double* next = memory_.get();
  double** const arrays[] = {&x_, &par_, &value_, &dx_, &dp_, &dxx_, &dxp_};
  for (std::size_t k = 0; k < std::size(arrays); ++k) {
    *arrays[k] = next;
    next += extents[k];
  }
}

void FortranCalls::boundary(const OrbitEnds& at, int order) {
  const auto states = static_cast<std::size_t>(n_) * static_cast<std::size_t>(at.segments);
  const auto count = static_cast<std::size_t>(count_);
  starts_.assign(at.starts, at.starts + states);
  ends_.assign(at.ends, at.ends + states);
  std::copy_n(at.par, par_room_, par_);
  conditions_.assign(count + beyond, unset());
  by_starts_.assign(count * states + beyond, 0.0);
  by_ends_.assign(count * states + beyond, 0.0);
  by_par_.assign(count * static_cast<std::size_t>(par_room_) + beyond, 0.0);
  Integer n = n_;
  Integer segments = at.segments;
  Integer wanted = order;
  Integer rows = count_;
  boundary_(&n, &segments, starts_.data(), ends_.data(), par_, &wanted, &rows, conditions_.data(), by_starts_.data(),
            by_ends_.data(), by_par_.data());
}

bool FortranCalls::wrote_beyond_conditions() const {
  return !std::all_of(conditions_.begin() + count_, conditions_.end(), [](double value) { return is_unset(value); });
}

double FortranCalls::unset() { return std::bit_cast<double>(unset_bits); }

bool FortranCalls::is_unset(double value) { return std::bit_cast<std::uint64_t>(value) == unset_bits; }

void FortranCalls::load(const double* x, const double* par) {
  std::copy(x, x + n_, x_);
  std::fill(x_ + n_, x_ + n_ + beyond, NAN);  // a library written for more states then gives NaN
  std::copy_n(par, par_room_, par_);
}

void FortranCalls::clear_derivatives(int order, std::span<const int> active) {
  const std::ptrdiff_t n = n_;
  std::fill(dx_, dx_ + rows_ * n, 0.0);
  for (const int k : active) std::fill_n(dp_ + rows_ * column(k - 1), rows_, 0.0);
  if (order < 2) return;
  std::fill(dxx_, dxx_ + rows_ * n * n, 0.0);
  for (const int k : active) std::fill_n(dxp_ + rows_ * n * column(k - 1), rows_ * n, 0.0);
}

void FortranCalls::evaluate(FunctionKind kind, int index, const double* x, const double* par, int order,
                            std::span<const int> active) {
  rows_ = kind == FunctionKind::event ? 1 : kind == FunctionKind::integrand ? integrals_ : n_;
  load(x, par);
  std::fill(value_, value_ + value_room_, unset());
  clear_derivatives(order, active);
  Integer n = n_;
  Integer wanted = order;
  Integer number = index;
  if (kind == FunctionKind::jump) {
    double restitution = unset();  // COEFFRES, which nothing reads
    jump_(&n, x_, par_, value_, &restitution, dx_, dp_, &number);
    return;
  }
  const Derivatives function = kind == FunctionKind::field       ? field_
                               : kind == FunctionKind::integrand ? integrand_
                                                                 : event_;
  function(&n, x_, par_, &wanted, value_, dx_, dp_, dxx_, dxp_, &number);
}

bool FortranCalls::left_unset(int i) const { return is_unset(value_[i]); }

bool FortranCalls::wrote_beyond() const {
  return !std::all_of(value_ + rows_, value_ + value_room_, [](double value) { return is_unset(value); });
}

int FortranCalls::parameter_count(const std::string& path, void* library) {
  const auto function = find<void (*)(Integer*)>(library, "gcnpar_");
  if (function == nullptr) return 0;
  Integer count = -1;
  function(&count);
  if (count >= 1 && count <= most_parameters) return count;
  throw UserError(
      fmt::format("plugin {}: GCNPAR sets NPAR to {}, allowed are 1 to {}.\n"
                  "  Set it to the number of parameters, or leave GCNPAR out where 60 are enough.",
                  path, count, most_parameters));
}

void FortranCalls::starting_values(int segment, double* x, double* par) {
  load(x, par);
  Integer n = n_;
  Integer number = segment;
  double time = 0.0;
  starting_values_(&n, x_, par_, &time, &number);
  std::copy(x_, x_ + n_, x);
  std::copy_n(par_, par_room_, par);
}

void FortranCalls::output_parameters(int segment, const double* x, double* par) {
  load(x, par);
  Integer n = n_;
  Integer number = segment;
  output_parameters_(&n, x_, par_, &number);
  std::copy_n(par_, par_room_, par);
}

namespace {

constexpr std::array<const char*, 4> subroutines = {"GCFUNC", "GCBOUND", "JUMPMAP", "GCICND"};
constexpr std::array<const char*, 4> outputs = {"FI", "H", "UJUMP", "FI"};

FunctionKind kind_of(std::int32_t kind) { return static_cast<FunctionKind>(kind); }

std::size_t place(FunctionKind kind) { return static_cast<std::size_t>(kind); }

int last_of(const std::vector<int>& indices, int least) { return indices.empty() ? least : indices.back(); }

/// With the number of parameters that the library itself gives.
ProblemSizes sizes_of(const std::string& path, void* library, ProblemSizes sizes) {
  sizes.parameters = std::max(sizes.parameters, FortranCalls::parameter_count(path, library));
  return sizes;
}

std::span<const int> list(const std::int32_t* active, std::int32_t count) {
  return {active, static_cast<std::size_t>(count)};
}

}  // namespace

FortranProblem::FortranProblem(const std::string& path, void* library, const ProblemSizes& sizes)
    : sizes_(sizes_of(path, library, sizes)),
      name_(std::filesystem::path(path).stem().string()),
      calls_(path, library, sizes_) {
  read_starting_values(path);
  fill_table();
  try_functions(path);
}

void FortranProblem::read_starting_values(const std::string& path) {
  std::vector<double> x(static_cast<std::size_t>(sizes_.dimension), FortranCalls::unset());
  const ParameterLayout layout(sizes_.parameters);
  std::vector<double> par(static_cast<std::size_t>(layout.room()), FortranCalls::unset());
  std::vector<double> from_zero(par.size(), 0.0);  // tells an entry left unset from one computed of such
  for (std::vector<double>* const start : {&from_zero, &par})
    for (int segment = sizes_.segments; segment >= 1 && calls_.has_starting_values(); --segment)
      calls_.starting_values(segment, x.data(), start->data());  // segment 1 has the last word
  for (int k = 1; k <= layout.room(); ++k) {
    const double value = par[static_cast<std::size_t>(k - 1)];
    const double other = from_zero[static_cast<std::size_t>(k - 1)];
    if (FortranCalls::is_unset(value) && other == 0.0) continue;
    if (!std::isfinite(value))
      throw UserError(
          fmt::format("plugin {}: GCSTPNT sets PAR({}) to a value that is not finite.\n"
                      "  Compute it from entries of PAR that are set before it, or leave it out.",
                      path, k));
    if (k < layout.first_duration()) sizes_.parameters = std::max(sizes_.parameters, k);
  }
  for (int k = 1; k <= sizes_.parameters; ++k) {
    const double value = par[static_cast<std::size_t>(k - 1)];
    parameters_.push_back(FortranCalls::is_unset(value) ? 0.0 : value);
  }
  for (int s = 0; s < sizes_.segments; ++s) {
    const double value = par[static_cast<std::size_t>(layout.duration(s) - 1)];
    durations_.push_back(FortranCalls::is_unset(value) ? NAN : value);
  }
  const bool gives_state = std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); });
  for (std::size_t i = 0; !gives_state && i < x.size(); ++i) x[i] = 0.1 + 0.3 * std::sin(1.0 + static_cast<double>(i));
  state_ = x;
}

void FortranProblem::fill_table() {
  table_.abi_version = TCHAT_PROBLEM_ABI;
  table_.struct_size = sizeof(tchat_problem);
  table_.dimension = sizes_.dimension;
  table_.parameters = sizes_.parameters;
  const int least = sizes_.boundary_conditions > 0 ? 0 : 1;
  table_.fields = last_of(sizes_.fields, 1);
  table_.events = last_of(sizes_.events, least);
  table_.jumps = last_of(sizes_.jumps, least);
  table_.derivative_order = sizes_.derivative_order;
  table_.name = name_.c_str();
  table_.initial_parameters = parameters_.data();
  table_.durations = sizes_.segments;
  table_.initial_durations = durations_.data();
  table_.self = this;
  table_.value = [](const void* pointer, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    double* out) {
    const auto& problem = *static_cast<const FortranProblem*>(pointer);
    problem.calls_.evaluate(kind_of(kind), index, x, par, 0, {});
    std::copy_n(problem.calls_.value(), problem.rows(kind_of(kind)), out);
  };
  table_.first = [](const void* pointer, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    const std::int32_t* active, std::int32_t count, double* out, double* dx, double* dp) {
    static_cast<const FortranProblem*>(pointer)->first(kind_of(kind), index, x, par, list(active, count), out, dx, dp);
  };
  table_.second = [](const void* pointer, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                     const std::int32_t* active, std::int32_t count, const double* direction, double* out, double* dx,
                     double* dp) {
    static_cast<const FortranProblem*>(pointer)->second(kind_of(kind), index, x, par, list(active, count), direction,
                                                        out, dx, dp);
  };
  add_conditions();
  if (calls_.has_output_parameters())
    table_.output_parameters = [](const void* pointer, std::int32_t segment, const double* x, double* par) {
      static_cast<const FortranProblem*>(pointer)->calls_.output_parameters(segment, x, par);
    };
  first_order_ = table_;
  first_order_.derivative_order = std::min(sizes_.derivative_order, 1);
  first_order_system_.emplace(first_order_);
}

void FortranProblem::add_conditions() {
  table_.boundary_conditions = sizes_.boundary_conditions;
  table_.integral_conditions = sizes_.integral_conditions;
  table_.boundary = [](const void* pointer, std::int32_t segments, const double* starts, const double* ends,
                       const double* par, double* out) {
    const auto& problem = *static_cast<const FortranProblem*>(pointer);
    problem.calls_.boundary({segments, starts, ends, par}, 0);
    std::copy_n(problem.calls_.conditions(), problem.sizes_.boundary_conditions, out);
  };
  table_.boundary_first = [](const void* pointer, std::int32_t segments, const double* starts, const double* ends,
                             const double* par, const std::int32_t* active, std::int32_t count, double* out,
                             double* dstarts, double* dends, double* dp) {
    const auto& problem = *static_cast<const FortranProblem*>(pointer);
    const int rows = problem.sizes_.boundary_conditions;
    const int states = rows * problem.sizes_.dimension * segments;
    problem.calls_.boundary({segments, starts, ends, par}, 1);
    std::copy_n(problem.calls_.conditions(), rows, out);
    std::copy_n(problem.calls_.by_starts(), states, dstarts);
    std::copy_n(problem.calls_.by_ends(), states, dends);
    for (const int k : list(active, count)) dp = std::copy_n(problem.calls_.by_boundary_parameter(k - 1), rows, dp);
  };
}

void FortranProblem::first(FunctionKind kind, int index, const double* x, const double* par,
                           std::span<const int> active, double* out, double* dx, double* dp) const {
  const int rows = this->rows(kind);
  calls_.evaluate(kind, index, x, par, 1, active);
  std::copy_n(calls_.value(), rows, out);
  std::copy_n(calls_.by_state(), rows * sizes_.dimension, dx);
  for (std::size_t a = 0; a < active.size(); ++a)
    std::copy_n(calls_.by_parameter(active[a] - 1), rows, dp + static_cast<int>(a) * rows);
  if (kind != FunctionKind::jump) return;
  std::vector<double> column(static_cast<std::size_t>(rows));
  for (std::size_t a = 0; a < active.size(); ++a) {
    double* const supplied = dp + static_cast<int>(a) * rows;
    if (std::find(supplied, supplied + rows, 0.0) == supplied + rows) continue;
    difference_by_parameter(*first_order_system_, kind, index, x, par, active[a], column.data());
    for (int i = 0; i < rows; ++i)
      if (supplied[i] == 0.0) supplied[i] = column[static_cast<std::size_t>(i)];
  }
}

void FortranProblem::second(FunctionKind kind, int index, const double* x, const double* par,
                            std::span<const int> active, const double* direction, double* out, double* dx,
                            double* dp) const {
  const int n = sizes_.dimension;
  const int rows = this->rows(kind);
  const int parameters = static_cast<int>(active.size());
  const double* const v = direction;
  const double* const w = direction + n;
  const bool along_parameters = std::any_of(w, w + parameters, [](double entry) { return entry != 0.0; });
  // By differences: everything for a jump; F_pp w, which comes in dp when the direction is (0, w).
  if (kind == FunctionKind::jump) {
    difference_second(*first_order_system_, kind, index, x, par, active, direction, out, dx, dp);
    return;
  }
  if (along_parameters) {
    std::vector<double> only_parameters(direction, direction + n + parameters);
    std::fill_n(only_parameters.begin(), n, 0.0);
    difference_second(*first_order_system_, kind, index, x, par, active, only_parameters.data(), out, dx, dp);
  } else {
    std::fill_n(dp, rows * parameters, 0.0);
  }
  calls_.evaluate(kind, index, x, par, 2, active);
  for (int i = 0; i < rows; ++i) {
    out[i] = 0.0;
    for (int c = 0; c < n; ++c) out[i] += calls_.by_state()[c * rows + i] * v[c];
    for (int a = 0; a < parameters; ++a) out[i] += calls_.by_parameter(active[a] - 1)[i] * w[a];
    for (int j = 0; j < n; ++j) {
      double& entry = dx[j * rows + i];
      entry = 0.0;
      for (int k = 0; k < n; ++k) entry += calls_.by_states(i, j, k) * v[k];
      for (int a = 0; a < parameters; ++a) {
        const double mixed = calls_.by_state_and_parameter(i, j, active[a] - 1);
        entry += mixed * w[a];
        dp[a * rows + i] += mixed * v[j];
      }
    }
  }
}

void FortranProblem::try_functions(const std::string& path) const {
  for (const int i : sizes_.fields) try_function(path, FunctionKind::field, i);
  for (const int j : sizes_.events) try_function(path, FunctionKind::event, j);
  for (const int k : sizes_.jumps) try_function(path, FunctionKind::jump, k);
  for (int s = 1; sizes_.integral_conditions > 0 && s <= sizes_.segments; ++s)
    try_function(path, FunctionKind::integrand, s);
  if (sizes_.boundary_conditions > 0) try_boundary(path);
}

void FortranProblem::try_function(const std::string& path, FunctionKind kind, int index) const {
  const char* const subroutine = subroutines[place(kind)];
  const char* const output = outputs[place(kind)];
  const ParameterLayout layout(sizes_.parameters);
  std::vector<double> par(static_cast<std::size_t>(layout.room()), 0.0);
  std::copy(parameters_.begin(), parameters_.end(), par.begin());
  calls_.evaluate(kind, index, state_.data(), par.data(), 0, {});
  const int n = sizes_.dimension;
  if (calls_.wrote_beyond())
    throw UserError(
        fmt::format("plugin {}: {} with SEGNO = {} sets more than {} = {} entries of {}.\n"
                    "  It is written for more: set {} in the constants file to their number.",
                    path, subroutine, index, kind == FunctionKind::integrand ? "NINT" : "GCNDIM", rows(kind), output,
                    kind == FunctionKind::integrand ? "NINT" : "NDIM"));
  const int rows = this->rows(kind);
  for (int i = 0; i < rows; ++i) {
    if (!calls_.left_unset(i)) continue;
    const std::string entry = kind == FunctionKind::event ? output : fmt::format("{}({})", output, i + 1);
    throw UserError(
        fmt::format("plugin {}: {} with SEGNO = {} leaves {} unset.\n"
                    "  Set it there, or correct NDIM = {} or the index {} of {} in the constants file.",
                    path, subroutine, index, entry, n, index,
                    kind == FunctionKind::field   ? "GCFIND"
                    : kind == FunctionKind::event ? "GCHIND or GCHGRZIND"
                    : kind == FunctionKind::jump  ? "GCGIND or GRJUMP"
                                                  : "GCNOSEG"));
  }
}

void FortranProblem::try_boundary(const std::string& path) const {
  const ParameterLayout layout(sizes_.parameters);
  std::vector<double> par(static_cast<std::size_t>(layout.room()), 0.0);
  std::copy(parameters_.begin(), parameters_.end(), par.begin());
  std::fill_n(par.begin() + layout.first_duration() - 1, sizes_.segments, 1.0);
  std::vector<double> states;
  for (int s = 0; s < sizes_.segments; ++s) states.insert(states.end(), state_.begin(), state_.end());
  calls_.boundary({sizes_.segments, states.data(), states.data(), par.data()}, 0);
  if (calls_.wrote_beyond_conditions())
    throw UserError(
        fmt::format("plugin {}: GCBCND sets more than NBC = {} entries of FB.\n"
                    "  Set NBC in the constants file to their number.",
                    path, sizes_.boundary_conditions));
  for (int i = 0; i < sizes_.boundary_conditions; ++i)
    if (calls_.left_condition_unset(i))
      throw UserError(
          fmt::format("plugin {}: GCBCND leaves FB({}) unset.\n"
                      "  Set it there, or correct NBC = {} in the constants file.",
                      path, i + 1, sizes_.boundary_conditions));
}

}  // namespace tchat
