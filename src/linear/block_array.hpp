/// Equally large blocks one behind the other, by their number: the arrays of large problems exceed the range of int,
/// and no place computes an offset by itself. The first block begins at an address that vector registers are loaded
/// from.
#pragma once

#include <cassert>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include "linear/aligned_allocator.hpp"

namespace tchat {

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

}  // namespace tchat
