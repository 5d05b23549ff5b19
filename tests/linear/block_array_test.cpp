#include "linear/memory.hpp"

#include <catch2/catch.hpp>

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
  CHECK(array.behind(1) == array[2]);
  CHECK(array.behind(2) == nullptr);
  CHECK(array.before(1) == array[0]);
  CHECK(array.before(0) == nullptr);
  const BlockArray<int> empty(0, 7);
  CHECK_NOTHROW(BlockArray<int>(5, 0));
}

TEST_CASE("block array: more than memory can hold is refused before anything is multiplied") {
  constexpr std::ptrdiff_t large = std::ptrdiff_t{1} << 40;
  CHECK_THROWS_AS(BlockArray<double>(large, large), std::length_error);
  CHECK_THROWS_AS(BlockArray<double>(-1, 3), std::length_error);
}
