#pragma once

#include <utility>
#include <vector>

namespace tchat {

/// Sign of a permutation of 0, 1, ..., by its cycles.
inline int permutation_parity(std::vector<int> order) {
  int sign = 1;
  for (std::size_t k = 0; k < order.size(); ++k)
    while (order[k] != static_cast<int>(k)) {
      std::swap(order[k], order[static_cast<std::size_t>(order[k])]);
      sign = -sign;
    }
  return sign;
}

}  // namespace tchat
