/// Do functions leave something in the upper halves of vector registers? Code for 128 bits is several times slower
/// then.
#pragma once

namespace tchat {

#ifdef __x86_64__
/// Of a processor that tells; false where it does not.
inline bool upper_halves_in_use() {
  constexpr unsigned tells = 1u << 2, state_of_upper_halves = 1u << 2;
  unsigned a = 0xd, b = 0, c = 1, d = 0;
  asm volatile("cpuid" : "+a"(a), "=b"(b), "+c"(c), "=d"(d));
  if ((a & tells) == 0) return false;
  unsigned low = 0, high = 0;
  asm volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(1));
  return (low & state_of_upper_halves) != 0;
}
#endif

/// True also where that is not known.
template <class Call>
bool leaves_upper_halves_clear(const Call& call) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") != 0) {
    asm volatile("vzeroupper");  // what came before leaves nothing; the caller is not compiled for these registers
    const bool always = upper_halves_in_use();
    call();
    return always || !upper_halves_in_use();
  }
#endif
  call();
  return true;
}

}  // namespace tchat
