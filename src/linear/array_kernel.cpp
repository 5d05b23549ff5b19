#include "linear/array_kernel.hpp"

namespace tchat {

#define TCHAT_VECTOR_NAMESPACE array_sets
#define TCHAT_VECTOR_FUNCTIONS "linear/array_functions.inc"
#include "linear/each_vector_set.inc"
#undef TCHAT_VECTOR_FUNCTIONS
#undef TCHAT_VECTOR_NAMESPACE

const ArrayFunctions& array_functions(VectorSet set) {
#ifdef __x86_64__
  if (set == VectorSet::avx2) return array_sets::avx2::functions;
  if (set == VectorSet::avx512) return array_sets::avx512::functions;
#endif
  static_cast<void>(set);
  return array_sets::baseline::functions;
}

const ArrayFunctions& array_functions() {
  static const ArrayFunctions& chosen = array_functions(available_vector_sets().back());
  return chosen;
}

}  // namespace tchat
