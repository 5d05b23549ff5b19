/// The whole program: parses the command line, calls the library, and turns errors into messages and exit statuses.
#pragma once

namespace tchat {

/// Exit status. Throws nothing.
int run_program(int argc, char** argv);

}  // namespace tchat
