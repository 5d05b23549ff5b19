/// Prefetches memory into the processor's second cache while other work is done. Results do not depend on it.
#pragma once

#include <algorithm>
#include <cstddef>

namespace tchat {

/// `count` entries from `begin` on, 16 KB at most: more would drive out what is being worked on.
template <class T>
void fetch_ahead(const T* begin, std::ptrdiff_t count) {
  constexpr std::ptrdiff_t size = sizeof(T), cache_line = 64;
  static_assert(size <= cache_line);
  constexpr std::ptrdiff_t step = cache_line / size, most = 16384 / size;
  for (std::ptrdiff_t i = 0; i < std::min(count, most); i += step) __builtin_prefetch(begin + i, 0, 2);
  asm volatile("");  // without it compilers remove calls of functions that only prefetch
}

}  // namespace tchat
