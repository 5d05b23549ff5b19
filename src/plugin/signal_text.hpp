/// A message put together in a signal handler: no allocation, no locks, one write at the end.
#pragma once

#include <unistd.h>

#include <array>
#include <cstddef>
#include <string_view>

namespace tchat {

class SignalText {
 public:
  SignalText& operator<<(std::string_view text) noexcept {
    for (const char c : text)
      if (size_ < buffer_.size()) buffer_[size_++] = c;
    return *this;
  }
  SignalText& operator<<(int number) noexcept {
    if (number < 0) return *this << "-" << -number;
    if (number >= 10) *this << number / 10;
    const char digit = static_cast<char>('0' + number % 10);
    return *this << std::string_view(&digit, 1);
  }

  void print_to_standard_error() const noexcept {
    std::size_t written = 0;
    while (written < size_) {
      const ssize_t count = ::write(STDERR_FILENO, buffer_.data() + written, size_ - written);
      if (count <= 0) return;
      written += static_cast<std::size_t>(count);
    }
  }

 private:
  std::array<char, 2048> buffer_;
  std::size_t size_ = 0;
};

}  // namespace tchat
