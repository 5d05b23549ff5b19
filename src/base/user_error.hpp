/// The one exception of tchat's edges: something the user gave is wrong. Caught once, in main; exit status 2.
#pragma once

#include <stdexcept>
#include <string>

#include "base/printable.hpp"

namespace tchat {

/// what() is the whole message: file and line where there is one, what was found, what is allowed, the cure. Printable:
/// words of files may hold any byte, and a zero byte would end the message.
class UserError : public std::runtime_error {
 public:
  explicit UserError(const std::string& message) : std::runtime_error(printable(message)) {}
};

/// The input was good but the computation failed (no convergence at the first point, disk full); exit status 1.
class ComputationError : public std::runtime_error {
 public:
  explicit ComputationError(const std::string& message) : std::runtime_error(printable(message)) {}
};

}  // namespace tchat
