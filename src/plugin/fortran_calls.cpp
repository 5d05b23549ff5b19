#include "plugin/fortran_calls.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "base/user_error.hpp"
#include "model/parameter_layout.hpp"

namespace tchat {

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

}  // namespace tchat
