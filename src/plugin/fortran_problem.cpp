#include "plugin/fortran_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "base/user_error.hpp"
#include "model/difference_derivatives.hpp"
#include "model/parameter_layout.hpp"

namespace tchat {

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
