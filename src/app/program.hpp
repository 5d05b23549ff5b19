/// The whole program, and the standard descriptors that it writes to.
#pragma once

#include <string>

namespace tchat {

// Standard input, output and error that the caller has closed (`tchat run x >&-`).

/// Puts /dev/null where a standard descriptor is closed, so that no file of ours gets its number and with it what is
/// printed. It is opened the wrong way round: reading or writing fails as on a closed descriptor, and can be told.
void occupy_standard_descriptors();

// What a command prints is part of its result: when it is lost, that is told.

/// Flushes standard output. "" when everything printed so far has arrived, otherwise a message: disk full, closed.
std::string lost_output();

// The whole program: parses the command line, calls the library, and turns errors into messages and exit statuses.

/// Exit status. Throws nothing.
int run_program(int argc, char** argv);

}  // namespace tchat
