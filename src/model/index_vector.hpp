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

/// "{(1,3,2), (1,1,1)}". Repetitions are powers: "{(1,1,2), (1,2,1)}^16" has 32 segments, "{(1,1,1)^3, (2,2,2)}" four.
std::string to_string(const Signature& signature);

/// Reads "1,1,1;2,2,2" and what to_string writes; blanks, parentheses, braces and powers are optional. Does not check
/// that the problem has these functions. Throws UserError that starts with `option` when the text is no list of triples
/// of whole numbers.
std::vector<IndexVector> parse_index_vectors(std::string_view text, const std::string& option);

/// The same for numbers that all count from 1 and at most max_segments vectors.
Signature parse_signature(std::string_view text, const std::string& option = "--signature");

}  // namespace tchat
