/// What a motion settles on.
#pragma once

#include <optional>
#include <string>

namespace tchat {

enum class AttractorKind {
  none,            ///< not told: the motion has not settled, or its integration failed
  periodic,        ///< repeats itself: a signature and a period
  quasi_periodic,  ///< does not repeat itself, and no exponent is positive
  chaotic,         ///< an exponent is positive
  rest,            ///< the motion dies out
  chattering,      ///< events accumulate, or the contact lasts and the problem has no mode for it
  escape,          ///< no event any more: the motion leaves
};

/// The word for people and files: "quasi-periodic".
std::string to_string(AttractorKind kind);
/// The kind of a word; nothing when it is none.
std::optional<AttractorKind> attractor_kind(const std::string& word);

}  // namespace tchat
