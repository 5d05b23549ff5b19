#include "model/undefined_value.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tchat {

std::string named_state(const HybridSystem& system, const double* x) {
  constexpr int most_shown = 8;
  std::string text;
  for (int k = 1; k <= std::min(system.dimension(), most_shown); ++k)
    text += fmt::format("{}{} = {:.6g}", k > 1 ? ", " : "", system.state_name(k), x[k - 1]);
  if (system.dimension() > most_shown) text += fmt::format(" and {} more", system.dimension() - most_shown);
  return text;
}

std::string undefined_value(const HybridSystem& system, FunctionKind kind, int index, const double* x) {
  return fmt::format("{} has no finite value at {}; {}", system.function_name(kind, index), named_state(system, x),
                     undefined_value_advice);
}

}  // namespace tchat
