/// Index vectors and signatures: which field, event function and jump each segment of an orbit uses.
#pragma once

#include <compare>
#include <string>
#include <string_view>
#include <vector>

namespace tchat {

/// In the place of an event or a jump: there is none, as on the segments of boundary value problems. In a ring jump 0
/// is the identity, and no event: an integral phase condition in its place.
inline constexpr int no_function = 0;

/// (i, j, k): flow with field i until event function j falls to zero, then apply jump k. All count from 1, but for
/// `no_function`.
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

/// "1,1,1;2,2,2", blanks, parentheses and braces as wanted. Throws UserError that begins with `option` when it is no
/// list of triples of whole numbers; whether they exist is for the problem to say.
std::vector<IndexVector> parse_index_vectors(std::string_view text, const std::string& option);

/// The same, where all count from 1 and there are no more of them than an orbit has segments.
Signature parse_signature(std::string_view text, const std::string& option = "--signature");

}  // namespace tchat
