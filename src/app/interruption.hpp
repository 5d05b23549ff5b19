/// Ctrl-C and SIGTERM for commands that finish what they are at: their files are complete, the exit status is 128 + the
/// signal. A second signal ends the program the ordinary way.
#pragma once

#include <functional>

namespace tchat {

/// Calls `work` with a question it asks now and then: has a signal come? Returns its exit status, or 128 + the signal.
int run_interruptibly(const std::function<int(const std::function<bool()>& interrupted)>& work);

}  // namespace tchat
