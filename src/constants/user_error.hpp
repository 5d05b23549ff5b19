/// The one exception of tchat's edges: something the user gave is wrong. Caught once, in main; exit status 2.
#pragma once

#include <stdexcept>
#include <string>

namespace tchat {

/// what() is the whole message: file and line where there is one, what was found, what is allowed, the cure.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input was good but the computation failed (no convergence at the first point, disk full); exit status 1.
class ComputationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tchat
