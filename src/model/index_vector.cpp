#include "model/index_vector.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "model/parameter_vector.hpp"

namespace tchat {

namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

[[noreturn]] void refuse(std::string_view text, const std::string& option, const std::string& found) {
  throw UserError(fmt::format(
      "{} {}: {}; allowed: index vectors field,event,jump of whole numbers from 1, separated by semicolons, for "
      "example {} \"1,2,1;2,1,2\"",
      option, in_quotes(text), found, option));
}

/// Length of the shortest block of index vectors that makes the signature when it is repeated.
std::size_t repeated_block(const Signature& signature) {
  const auto first = signature.begin();
  for (std::size_t block = 1; block < signature.size(); ++block) {
    const auto second = first + static_cast<std::ptrdiff_t>(block);
    if (signature.size() % block == 0 && std::equal(second, signature.end(), first)) return block;
  }
  return signature.size();
}

std::string power_text(std::size_t repetitions) {
  return repetitions > 1 ? fmt::format("^{}", repetitions) : std::string();
}

/// Reads index vectors character by character, because a power repeats a vector or a group in braces.
class SignatureReader {
 public:
  SignatureReader(std::string_view text, const std::string& option) : text_(text), option_(option) {}

  std::vector<IndexVector> read() {
    while (next_ < text_.size()) take(text_[next_++]);
    finish_vector();
    if (vectors_.empty()) refuse(text_, option_, "found no index vector");
    return vectors_;
  }

 private:
  void take(char c) {
    const bool separates_vectors = c == ',' && vector_.empty();
    if (c == ' ' || c == '(' || separates_vectors) return;
    if (c == '{') open_group();
    if (c == ')' || c == ';' || c == '}' || c == '^') finish_vector();
    if (c == '}') {
      repeated_ = group_;
      is_in_group_ = false;
    }
    if (c == '^') repeat();
    if (std::string_view("{});^").find(c) == std::string_view::npos) vector_ += c;
  }

  void open_group() {
    if (is_in_group_) refuse(text_, option_, "found '{' within braces");
    is_in_group_ = true;
    group_ = vectors_.size();
  }

  void finish_vector() {
    if (vector_.empty()) return;
    std::vector<int> numbers;
    for (const std::string_view word : split(vector_, ',')) {
      const auto value = parse_integer(word);
      if (!value) refuse(text_, option_, fmt::format("found {}", in_quotes(word)));
      numbers.push_back(*value);
    }
    if (numbers.size() != 3)
      refuse(text_, option_, fmt::format("index vector {} has {} numbers", vectors_.size() + 1, numbers.size()));
    repeated_ = vectors_.size();
    vectors_.push_back({numbers[0], numbers[1], numbers[2]});
    vector_.clear();
  }

  /// Appends what the power repeats, once less than its exponent.
  void repeat() {
    const std::size_t end = std::min(text_.find_first_not_of("0123456789", next_), text_.size());
    const std::string_view digits = text_.substr(next_, end - next_);
    const auto exponent = parse_integer(digits);
    if (!exponent || *exponent < 1 || *exponent > max_segments)
      refuse(text_, option_, fmt::format("found the power {}", in_quotes(fmt::format("^{}", digits))));
    const std::vector<IndexVector> block(vectors_.begin() + static_cast<std::ptrdiff_t>(repeated_), vectors_.end());
    if (vectors_.size() + block.size() * static_cast<std::size_t>(*exponent - 1) > max_segments)
      refuse(text_, option_, fmt::format("more than {} segments", max_segments));
    for (int k = 1; k < *exponent; ++k) vectors_.insert(vectors_.end(), block.begin(), block.end());
    next_ = end;
  }

  std::string_view text_;
  const std::string& option_;
  std::size_t next_ = 0;
  std::string vector_;     ///< numbers of the vector that is being read
  std::size_t group_ = 0;  ///< first vector after the last opening brace
  bool is_in_group_ = false;
  std::size_t repeated_ = 0;  ///< first vector that a power would repeat
  std::vector<IndexVector> vectors_;
};

}  // namespace

std::string to_string(const Signature& signature) {
  const std::size_t block = repeated_block(signature);
  std::string text;
  for (std::size_t s = 0; s < block;) {
    std::size_t end = s + 1;
    while (end < block && signature[end] == signature[s]) ++end;
    const IndexVector& v = signature[s];
    text += fmt::format("{}({},{},{}){}", s > 0 ? ", " : "", v.field, v.event, v.jump, power_text(end - s));
    s = end;
  }
  return fmt::format("{{{}}}{}", text, block > 0 ? power_text(signature.size() / block) : "");
}

std::vector<IndexVector> parse_index_vectors(std::string_view text, const std::string& option) {
  return SignatureReader(text, option).read();
}

Signature parse_signature(std::string_view text, const std::string& option) {
  const Signature signature = parse_index_vectors(text, option);
  for (const IndexVector& v : signature)
    for (const int number : {v.field, v.event, v.jump})
      if (number < 1) refuse(text, option, fmt::format("found '{}'", number));
  if (signature.size() > static_cast<std::size_t>(max_segments))
    refuse(text, option, fmt::format("{} segments, at most {} are allowed", signature.size(), max_segments));
  return signature;
}

}  // namespace tchat
