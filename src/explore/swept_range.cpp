#include "explore/swept_range.hpp"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "plugin/problem_setup.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

SweptRange read_swept_range(const std::string& option, const std::string& text, bool may_have_count) {
  const auto refuse = [&] {
    throw UserError(fmt::format("{} {}: a parameter with the range of its values is needed, as alpha=2.9:3.3{}", option,
                                in_quotes(text),
                                may_have_count ? ", or with the number of values, alpha=2.9:3.3:401" : ""));
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse();
  SweptRange range{text.substr(0, equals)};
  std::vector<std::string> parts;
  for (std::size_t from = equals + 1; from <= text.size();) {
    const std::size_t to = std::min(text.find(':', from), text.size());
    parts.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  if (parts.size() < 2 || parts.size() > (may_have_count ? 3 : 2)) refuse();
  const std::optional<double> a = parse_real(parts[0]), b = parse_real(parts[1]);
  const std::optional<int> count = parts.size() == 3 ? parse_integer(parts[2]) : std::optional(range.count);
  if (!a || !b || !(*a < *b) || !count || *count < 2) refuse();
  range.from = *a, range.to = *b, range.count = *count;
  return range;
}

int find_parameter(const std::string& option, const HybridSystem& system, SweptRange& range) {
  range.parameter = bare_name(range.parameter);
  const int number = parameter_index(system, range.parameter, option);
  if (number > system.parameters())
    throw UserError(fmt::format("{} {}: a duration is no parameter of a simulation", option, range.parameter));
  if (const std::string name = system.parameter_name(number); system.parameter_index(name) == number)
    range.parameter = name;
  return number;
}

}  // namespace tchat
