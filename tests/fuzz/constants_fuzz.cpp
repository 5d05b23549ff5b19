// Constants files, both forms: what is accepted can be written in either form and read back to the same settings.

#include "fuzz_target.hpp"
#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"

using namespace tchat;

namespace {

RunSettings read(std::string_view text) {
  Warnings warnings;
  RunSettings settings = read_constants_text(text, fuzz::source, &warnings);
  for (const std::string& warning : warnings) fuzz::require_readable(warning);
  return settings;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string positional;
  std::string keyword;
  const bool accepted = fuzz::accepts([&] {
    const RunSettings settings = read(fuzz::text_of(data, size));
    positional = positional_text(settings);
    keyword = keyword_text(settings);
  });
  if (!accepted) return 0;
  fuzz::require(fuzz::accepts([&] { fuzz::require(positional_text(read(positional)) == positional, "same again"); }),
                "the positional form of accepted constants is accepted:\n" + positional);
  fuzz::require(fuzz::accepts([&] { fuzz::require(keyword_text(read(keyword)) == keyword, "same again"); }),
                "the keyword form of accepted constants is accepted:\n" + keyword);
  return 0;
}
