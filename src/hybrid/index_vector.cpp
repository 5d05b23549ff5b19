#include "hybrid/index_vector.hpp"

#include <fmt/format.h>

namespace tchat {

std::string to_string(const Signature& signature) {
  std::string text = "{";
  for (const IndexVector& v : signature)
    text += fmt::format("{}({},{},{})", text.size() > 1 ? ", " : "", v.field, v.event, v.jump);
  return text + "}";
}

}  // namespace tchat
