/// Memory of matrices and vectors: aligned arrays, blocks, arrays on the stack, and prefetching.
#pragma once

#include <sys/mman.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cassert>
#include <cstddef>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

namespace tchat {

// Memory that begins where a line of the processor's cache does, for arrays that are read in whole vectors. Long
// arrays are given large pages where the system has them to give: of small ones they fill more than the processor's
// table of addresses holds.

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

// Equally large blocks one behind the other, by their number: the arrays of large problems exceed the range of int,
// and no place computes an offset by itself. The first block begins at an address that vector registers are loaded
// from.

template <class T>
class BlockArray {
 public:
  BlockArray() = default;
  /// `count` blocks of `size` zeros. Throws std::length_error when these are more than memory can hold.
  BlockArray(std::ptrdiff_t count, std::ptrdiff_t size) : count_(count), size_(size), values_(checked(count, size)) {}

  /// The first entry of a block.
  T* operator[](std::ptrdiff_t block) { return values_.data() + offset(block); }
  const T* operator[](std::ptrdiff_t block) const { return values_.data() + offset(block); }
  /// The block behind this one, and the one before it, or null.
  const T* behind(std::ptrdiff_t block) const { return block + 1 < count_ ? (*this)[block + 1] : nullptr; }
  const T* before(std::ptrdiff_t block) const { return block > 0 ? (*this)[block - 1] : nullptr; }

 private:
  static std::size_t checked(std::ptrdiff_t count, std::ptrdiff_t size) {
    constexpr std::ptrdiff_t most = std::numeric_limits<std::ptrdiff_t>::max() / static_cast<std::ptrdiff_t>(sizeof(T));
    if (count < 0 || size < 0 || (size > 0 && count > most / size))
      throw std::length_error("a block array larger than memory");
    return static_cast<std::size_t>(count * size);
  }

  std::ptrdiff_t offset(std::ptrdiff_t block) const {
    assert(block >= 0 && (block + 1) * size_ <= static_cast<std::ptrdiff_t>(values_.size()));
    return block * size_;
  }

  std::ptrdiff_t count_ = 0;
  std::ptrdiff_t size_ = 0;
  std::vector<T, AlignedAllocator<T>> values_;
};

// Vectors and matrices for the time of a call, whose entries are on the stack while they are few: a function that is
// called at every point of a branch then allocates nothing, without a workspace that its caller has to keep.

namespace stack_array {

/// Comes before the Map, which needs the address.
template <std::size_t Most>
struct Entries {
  explicit Entries(Eigen::Index count) : entries(static_cast<std::size_t>(count), boost::container::default_init_t()) {}
  boost::container::small_vector<double, Most> entries;
};

}  // namespace stack_array

/// Not set to anything when it is made.
class StackVector : private stack_array::Entries<32>, public Eigen::Map<Eigen::VectorXd> {
 public:
  explicit StackVector(Eigen::Index size) : Entries(size), Map(entries.data(), size) {}
  ~StackVector() = default;
  StackVector(const StackVector&) = delete;
  StackVector& operator=(const StackVector&) = delete;
  using Map::operator=;
};

/// Column by column.
template <std::size_t Most = 256>
class StackMatrix : private stack_array::Entries<Most>, public Eigen::Map<Eigen::MatrixXd> {
 public:
  StackMatrix(Eigen::Index rows, Eigen::Index columns)
      : stack_array::Entries<Most>(rows * columns), Map(this->entries.data(), rows, columns) {}
  ~StackMatrix() = default;
  StackMatrix(const StackMatrix&) = delete;
  StackMatrix& operator=(const StackMatrix&) = delete;
  using Map::operator=;
};

// Prefetches memory into the processor's second cache while other work is done. Results do not depend on it.

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
