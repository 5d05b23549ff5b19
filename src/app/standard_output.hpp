/// What a command prints is part of its result: when it is lost, that is told.
#pragma once

#include <string>

namespace tchat {

/// Flushes standard output. "" when everything printed so far has arrived, otherwise a message: disk full, closed.
std::string lost_output();

}  // namespace tchat
