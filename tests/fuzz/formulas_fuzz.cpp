// Files of formulas: what is accepted becomes the same C++ again, also with other line ends, and its braces close.

#include <algorithm>

#include "fuzz_target.hpp"
#include "plugin/cpp_writer.hpp"

using namespace tchat;

namespace {

std::string with_carriage_returns(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return result;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(fuzz::text_of(data, size));
  std::string cpp;
  const bool accepted = fuzz::accepts([&] {
    const Translation translation = translate_formulas(text, fuzz::source);
    for (const std::string& remark : translation.remarks) fuzz::require_readable(remark);
    cpp = translation.cpp;
  });
  if (!accepted) return 0;
  fuzz::require(std::count(cpp.begin(), cpp.end(), '{') == std::count(cpp.begin(), cpp.end(), '}') &&
                    std::count(cpp.begin(), cpp.end(), '(') == std::count(cpp.begin(), cpp.end(), ')'),
                "parentheses and braces close:\n" + cpp);
  fuzz::require(fuzz::accepts([&] {
                  fuzz::require(translate_formulas(with_carriage_returns(text), fuzz::source).cpp == cpp,
                                "line ends of Windows change nothing");
                }),
                "accepted formulas are accepted with line ends of Windows");
  return 0;
}
