/// Do functions leave something in the upper halves of vector registers? Code for 128 bits is several times slower
/// then.
#pragma once

namespace tchat {

/// True also where the processor does not tell.
template <class Call>
bool leaves_upper_halves_clear(const Call& call) {
#ifdef __x86_64__
  constexpr unsigned tells = 1u << 2, state_of_upper_halves = 1u << 2;
  unsigned a = 0xd, b = 0, c = 1, d = 0;
  if (__builtin_cpu_supports("avx2") != 0) asm volatile("cpuid" : "+a"(a), "=b"(b), "+c"(c), "=d"(d));
  if (__builtin_cpu_supports("avx2") == 0 || (a & tells) == 0) return call(), true;
  asm volatile("vzeroupper");  // what came before leaves nothing; the caller is not compiled for these registers
  call();
  unsigned low = 0, high = 0;
  asm volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(1));
  return (low & state_of_upper_halves) == 0;
#else
  return call(), true;
#endif
}

}  // namespace tchat
