#include "linear_algebra/aligned_allocator.hpp"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace tchat {

namespace {

constexpr std::size_t cache_line = 64;
constexpr std::size_t large_page = std::size_t{2} << 20;

/// Less than that would leave much of its last page unused.
bool is_large(std::size_t bytes) { return bytes >= 2 * large_page; }

std::align_val_t alignment(std::size_t bytes) { return std::align_val_t{is_large(bytes) ? large_page : cache_line}; }

}  // namespace

void* allocate_aligned(std::size_t bytes) {
  void* const memory = ::operator new(bytes, alignment(bytes));
#ifdef __linux__
  // A wish: where it is not granted, pages are small.
  if (is_large(bytes)) static_cast<void>(madvise(memory, bytes / large_page * large_page, MADV_HUGEPAGE));
#endif
  return memory;
}

void release_aligned(void* memory, std::size_t bytes) { ::operator delete(memory, alignment(bytes)); }

}  // namespace tchat
