#include "plugin/cpp_names.hpp"

#include <algorithm>
#include <cctype>

namespace tchat::formulas {

namespace {

const std::set<std::string>& taken_names() {
  static const std::set<std::string> names = {
      // keywords and alternative operators
      "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch", "char",
      "char8_t", "char16_t", "char32_t", "class", "compl", "concept", "const", "consteval", "constexpr", "constinit",
      "const_cast", "continue", "co_await", "co_return", "co_yield", "decltype", "default", "delete", "do", "double",
      "dynamic_cast", "else", "enum", "explicit", "export", "extern", "false", "float", "for", "friend", "goto", "if",
      "inline", "int", "long", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "nullptr", "operator", "or",
      "or_eq", "private", "protected", "public", "register", "reinterpret_cast", "requires", "return", "short",
      "signed", "sizeof", "static", "static_assert", "static_cast", "struct", "switch", "template", "this",
      "thread_local", "throw", "true", "try", "typedef", "typeid", "typename", "union", "unsigned", "using", "virtual",
      "void", "volatile", "wchar_t", "while", "xor", "xor_eq",
      // macros of the standard headers, in small letters
      "alloca", "be16toh", "be32toh", "be64toh", "errno", "htobe16", "htobe32", "htobe64", "htole16", "htole32",
      "htole64", "issubnormal", "le16toh", "le32toh", "le64toh", "linux", "math_errhandling", "offsetof",
      "pthread_cleanup_pop", "pthread_cleanup_pop_restore_np", "pthread_cleanup_push", "pthread_cleanup_push_defer_np",
      "sched_priority", "stderr", "stdin", "stdout", "unix", "va_arg", "va_copy", "va_end", "va_start",
      // what the translation itself uses
      "T", "std", "tchat", "state", "par", "rate", "image", "index", "from", "values", "i", "field", "event", "jump",
      "successors", "user_value", "dimension", "parameters", "fields", "events", "jumps", "user_values", "state_names",
      "parameter_names", "field_names", "event_names", "jump_names", "user_value_names", "initial_parameters",
      "initial_state", "field_derivatives", "event_derivatives", "jump_derivatives", "square", "cube", "larger",
      "smaller", "sign_of", "heaviside", "floor_of", "remainder_of", "pow", "fabs", "sin", "cos", "tan", "asin", "acos",
      "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "exp", "log", "log10", "log2", "sqrt", "cbrt", "atan2",
      "hypot"};
  return names;
}

/// Macros of the standard headers have capitals only, or begin with one and have an underscore (M_PIf, L_ctermid).
bool may_be_macro(const std::string& name) {
  const auto is_small = [](unsigned char c) { return std::islower(c) != 0; };
  const bool capital = std::isupper(static_cast<unsigned char>(name[0])) != 0;
  const bool no_small = std::none_of(name.begin(), name.end(), is_small);
  return capital && name.size() > 1 && (no_small || name.find('_') != std::string::npos);
}

bool is_reserved(const std::string& name) { return name[0] == '_' || name.find("__") != std::string::npos; }

}  // namespace

std::string CppNames::unique(const std::string& name) {
  std::string result = name;
  if (is_reserved(result)) {
    result.erase(std::unique(result.begin(), result.end(), [](char a, char b) { return a == '_' && b == '_'; }),
                 result.end());
    result = "name" + std::string(result[0] == '_' ? "" : "_") + result;
  }
  if (may_be_macro(result) || taken_names().count(result) != 0) result += "_";
  for (std::string free = result;; free = result + std::to_string(used_.size()))
    if (taken_names().count(free) == 0 && used_.insert(free).second) return free;
}

}  // namespace tchat::formulas
