/// What a label says of its normal form, as a sentence and as data.
///
///     normal form NAME = VALUE +- UNCERTAINTY[, VERDICT[: or ; EXPLANATION]]
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tchat {

struct NormalFormNote {
  std::string name;  ///< of the coefficient: a, c, Re d, l_1
  double value = 0.0;
  double uncertainty = 0.0;
  std::string verdict = {};  ///< "supercritical", "subcritical", "transcritical", ...; "" where there is none to say

  /// Is what is born unstable, beside the stable solution that it is born from?
  bool is_subcritical() const { return verdict.starts_with("subcritical"); }
};

/// `explanation`, where there is one, begins with ':' or ';'.
std::string format_normal_form(const NormalFormNote& note, std::string_view explanation);

/// The sentence in a line that may have others before and behind it, separated by "; ". Nothing where there is none.
std::optional<NormalFormNote> parse_normal_form(std::string_view line);

}  // namespace tchat
