// KEY=VALUE words of the command line, one on each line of the text, with names of parameters: all or nothing.

#include <vector>

#include "base/words.hpp"
#include "fuzz_target.hpp"
#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"
#include "settings/settings_check.hpp"

using namespace tchat;

namespace {

constexpr std::string_view base_text =
    "NDIM = 2\nICP = [1, 61, 62]\nGCFIND = [1, 2]\nGCHIND = [1, 2]\nGCGIND = [1, 2]\n";

int index_of(const std::string& name, const std::string& where) {
  if (name == "alpha") return 1;
  if (name == "omega") return 2;
  throw UserError(where + ": there is no parameter " + in_quotes(name) + "; allowed: alpha, omega");
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::string> words = lines_of(fuzz::text_of(data, size));
  RunSettings settings = read_constants_text(base_text, fuzz::source);
  const std::string before = positional_text(settings);
  Warnings warnings;
  const bool accepted = fuzz::accepts([&] { apply_overrides(settings, words, &warnings); }, "command line");
  if (!accepted) {
    fuzz::require(positional_text(settings) == before, "refused overrides change nothing");
    return 0;
  }
  if (!fuzz::accepts([&] { resolve_names(settings, ParameterLayout(), index_of); }, "command line")) return 0;
  const std::string after = positional_text(settings);
  fuzz::require(fuzz::accepts([&] {
                  fuzz::require(positional_text(read_constants_text(after, fuzz::source)) == after, "same again");
                }),
                "settings with accepted overrides can be written and read:\n" + after);
  return 0;
}
