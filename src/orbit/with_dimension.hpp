#pragma once

#include <type_traits>

namespace tchat {

/// Calls work with the dimension as a compile-time number where that is a common one: the loops over states are the
/// innermost ones and short.
template <class Work>
auto with_dimension(int n, Work&& work) {
  switch (n) {
    case 2:
      return work(std::integral_constant<int, 2>{});
    case 3:
      return work(std::integral_constant<int, 3>{});
    case 4:
      return work(std::integral_constant<int, 4>{});
    case 5:
      return work(std::integral_constant<int, 5>{});
    case 6:
      return work(std::integral_constant<int, 6>{});
    default:
      return work(n);
  }
}

}  // namespace tchat
