/// Index vectors and signatures: which field, event function and jump each segment of an orbit uses.
#pragma once

#include <compare>
#include <string>
#include <vector>

namespace tchat {

/// (i, j, k): flow with field i until event function j falls to zero, then apply jump k. All count from 1.
struct IndexVector {
  int field = 1;
  int event = 1;
  int jump = 1;
  auto operator<=>(const IndexVector&) const = default;  // NOLINT(modernize-use-nullptr): of the generated code
};

/// The index vectors of the segments of one period, in order.
using Signature = std::vector<IndexVector>;

/// "{(1,3,2), (1,1,1)}"
std::string to_string(const Signature& signature);

}  // namespace tchat
