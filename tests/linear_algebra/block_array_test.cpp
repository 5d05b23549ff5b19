#include "linear_algebra/block_array.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>

using namespace tchat;

TEST_CASE("block array: blocks of zeros one behind the other") {
  BlockArray<double> array(3, 4);
  for (int b = 0; b < 3; ++b)
    for (int k = 0; k < 4; ++k) {
      CHECK(array[b][k] == 0.0);
      array[b][k] = 10.0 * b + k;
    }
  CHECK(array[1] - array[0] == 4);
  CHECK(array[2][3] == 23.0);
  const BlockArray<int> empty(0, 7);
  CHECK_NOTHROW(BlockArray<int>(5, 0));
}

TEST_CASE("block array: more than memory can hold is refused before anything is multiplied") {
  constexpr std::ptrdiff_t large = std::ptrdiff_t{1} << 40;
  CHECK_THROWS_AS(BlockArray<double>(large, large), std::length_error);
  CHECK_THROWS_AS(BlockArray<double>(-1, 3), std::length_error);
}

TEST_CASE("aligned memory of any size is that of its own: below, at and above what gets large pages") {
  for (const std::size_t count : {1UL, 7UL, 1UL << 19, (1UL << 19) + 1, (1UL << 20) + 13}) {
    CAPTURE(count);
    std::vector<double, AlignedAllocator<double>> one(count, 1.0), other(count, 2.0);
    CHECK(reinterpret_cast<std::uintptr_t>(one.data()) % 64 == 0);
    other.back() = 3.0;
    one.resize(2 * count, 4.0);
    CHECK(std::count(one.begin(), one.end(), 1.0) == static_cast<std::ptrdiff_t>(count));
    CHECK(std::count(other.begin(), other.end(), 2.0) == static_cast<std::ptrdiff_t>(count - 1));
  }
  CHECK_THROWS_AS(AlignedAllocator<double>().allocate(static_cast<std::size_t>(-1) / 4), std::bad_array_new_length);
}
