#include "linear/lane_kernel.hpp"

#include <algorithm>
#include <cassert>

namespace tchat {

namespace {

struct LaneSizes {
  int rows, pivots, width;
  int stride;  // from one row to the next
};

}  // namespace

struct LaneFunctions {
  unsigned (*eliminate)(const LaneSizes&, double*, int, int*, const double*);
  void (*forward)(const LaneSizes&, const double*, int, const int*, double*, const double*);
  void (*forward_transposed)(const LaneSizes&, const double*, const int*, double*);
  void (*backward)(const LaneSizes&, const double*, const double*, double*, const double*);
  void (*backward_of_two)(const LaneSizes&, const double*, double* const*, const double*);
  void (*backward_of_three)(const LaneSizes&, const double*, double* const*, const double*);
  void (*gather)(const double* const*, int, double*);
  void (*scatter)(const double*, int, double* const*);
  void (*interpolate)(const LaneCollocation&, const double*, double*, double*);
  bool (*fill)(const LaneCollocation&, int, double*, double*, double*);
  void (*join)(const LaneJoin&, const LanePiece&, const LanePiece&, double*);
};

#define TCHAT_VECTOR_NAMESPACE lane_sets
#define TCHAT_VECTOR_FUNCTIONS "linear/lane_functions.inc"
#include "linear/each_vector_set.inc"
#undef TCHAT_VECTOR_FUNCTIONS
#undef TCHAT_VECTOR_NAMESPACE

namespace {

const LaneFunctions* lane_functions(VectorSet set) {
#ifdef __x86_64__
  if (set == VectorSet::avx2) return &lane_sets::avx2::functions;
  if (set == VectorSet::avx512) return &lane_sets::avx512::functions;
#endif
  static_cast<void>(set);
  return &lane_sets::baseline::functions;
}

/// While registers of 512 bits are in use the processor's clock is slower: narrow blocks lose elsewhere what they gain.
VectorSet set_for(int width, VectorSet set) {
  constexpr int least_width = 40;
  return set == VectorSet::avx512 && width < least_width ? VectorSet::avx2 : set;
}

/// Pairs of columns begin where a line of the cache does.
int stride_for(int width, VectorSet set) { return set == VectorSet::avx512 ? (width + 1) / 2 * 2 : width; }

}  // namespace

std::vector<VectorSet> available_vector_sets() {
  std::vector<VectorSet> sets = {VectorSet::baseline};
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") != 0) sets.push_back(VectorSet::avx2);
  if (__builtin_cpu_supports("avx512vl") != 0) sets.push_back(VectorSet::avx512);
#endif
  return sets;
}

LaneKernel::LaneKernel(int rows, int pivots, int width, VectorSet set)
    : rows_(rows),
      pivots_(pivots),
      width_(width),
      stride_(stride_for(width, set_for(width, set))),
      functions_(lane_functions(set_for(width, set))) {}

unsigned LaneKernel::eliminate(double* a, int border, int* swaps, const double* next) const {
  return functions_->eliminate({rows_, pivots_, width_, stride_}, a, border, swaps, next);
}

void LaneKernel::forward(const double* a, int border, const int* swaps, double* rhs, const double* next) const {
  functions_->forward({rows_, pivots_, width_, stride_}, a, border, swaps, rhs, next);
}

void LaneKernel::forward_transposed(const double* a, const int* swaps, double* weights) const {
  functions_->forward_transposed({rows_, pivots_, width_, stride_}, a, swaps, weights);
}

void LaneKernel::backward(const double* a, const double* rhs, double* x, const double* next) const {
  functions_->backward({rows_, pivots_, width_, stride_}, a, rhs, x, next);
}

void LaneKernel::backward_of_several(const double* a, std::span<double* const> x, const double* next) const {
  assert(x.size() >= 2);
  const LaneSizes sizes = {rows_, pivots_, width_, stride_};
  for (; x.size() > 3; x = x.subspan(2)) functions_->backward_of_two(sizes, a, x.data(), nullptr);
  (x.size() == 2 ? functions_->backward_of_two : functions_->backward_of_three)(sizes, a, x.data(), next);
}

LaneAssembly::LaneAssembly(VectorSet set) : functions_(lane_functions(set)) {}

void LaneAssembly::gather(const double* const (&from)[lanes], int count, double* to) const {
  functions_->gather(from, count, to);
}

void LaneAssembly::scatter(const double* from, int count, double* const (&to)[lanes]) const {
  functions_->scatter(from, count, to);
}

void LaneAssembly::interpolate(const LaneCollocation& at, const double* nodes, double* points,
                               double* derivatives) const {
  functions_->interpolate(at, nodes, points, derivatives);
}

bool LaneAssembly::fill(const LaneCollocation& at, int stride, double* blocks, double* jacobian,
                        double* residual) const {
  return functions_->fill(at, stride, blocks, jacobian, residual);
}

void LaneAssembly::join(const LaneJoin& at, const LanePiece& left, const LanePiece& right, double* target) const {
  functions_->join(at, left, right, target);
}

}  // namespace tchat
