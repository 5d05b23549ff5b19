#include "base/warnings.hpp"

#include "base/printable.hpp"

namespace tchat {

void print_warnings(std::ostream& stream, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) stream << "tchat: warning: " << printable(text) << '\n';
}

}  // namespace tchat
