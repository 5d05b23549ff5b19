/// Memory that begins where a line of the processor's cache does, for arrays that are read in whole vectors. Long
/// arrays are given large pages where the system has them to give: of small ones they fill more than the processor's
/// table of addresses holds.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>

namespace tchat {

template <class T>
struct AlignedAllocator {
  using value_type = T;

  AlignedAllocator() = default;
  template <class U>
  explicit AlignedAllocator(const AlignedAllocator<U>&) {}

  T* allocate(std::size_t count) {
    if (count > (static_cast<std::size_t>(-1) - large_page) / sizeof(T)) throw std::bad_array_new_length();
    void* const memory = ::operator new(size(count), alignment(count));
#ifdef MADV_HUGEPAGE
    if (is_long(count)) madvise(memory, size(count), MADV_HUGEPAGE);  // refused: as it was
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) { ::operator delete(memory, alignment(count)); }
  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }

 private:
  static constexpr std::size_t cache_line = 64, large_page = std::size_t{2} << 20;
  static bool is_long(std::size_t count) { return count * sizeof(T) >= large_page / 2; }
  /// In bytes: whole pages, as the rest of an array would have small ones.
  static std::size_t size(std::size_t count) {
    return is_long(count) ? (count * sizeof(T) + large_page - 1) / large_page * large_page : count * sizeof(T);
  }
  static std::align_val_t alignment(std::size_t count) {
    return std::align_val_t{is_long(count) ? large_page : cache_line};
  }
};

}  // namespace tchat
