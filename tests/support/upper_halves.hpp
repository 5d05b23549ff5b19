/// Do the upper halves of vector registers hold something? Code for 128 bits is several times slower then, so that no
/// function may leave them so.
#pragma once

namespace tchat {

/// False also where the processor does not tell.
inline bool upper_halves_in_use() {
#ifdef __x86_64__
  constexpr unsigned tells = 1u << 2, state_of_upper_halves = 1u << 2;
  unsigned a = 0xd, b = 0, c = 1, d = 0;
  if (__builtin_cpu_supports("avx2") == 0) return false;
  asm volatile("cpuid" : "+a"(a), "=b"(b), "+c"(c), "=d"(d));
  if ((a & tells) == 0) return false;
  unsigned low = 0, high = 0;
  asm volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(1));
  return (low & state_of_upper_halves) != 0;
#else
  return false;
#endif
}

}  // namespace tchat
