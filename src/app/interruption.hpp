/// Ctrl-C and SIGTERM for commands that finish what they are at: their files are complete, the exit status is 128 + the
/// signal. Where that takes too long (a plugin that never returns), the program is ended at once, with the same status:
/// by a second signal, or some seconds after the first: 5, or three times the longest time that it has taken so far
/// from one question to the next.
#pragma once

#include <functional>

namespace tchat {

/// Calls `work` with a question it asks now and then: has a signal come? Returns its exit status, or 128 + the signal.
int run_interruptibly(const std::function<int(const std::function<bool()>& interrupted)>& work);

}  // namespace tchat
