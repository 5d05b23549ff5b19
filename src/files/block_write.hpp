/// How a block reaches the end of an open file: whole or not at all.
#pragma once

#include <string_view>

namespace tchat {

struct BlockOutcome {
  int error = 0;      ///< errno of what failed, 0: the block is stored
  bool whole = true;  ///< false: a part of the block is stored and could not be removed again
};

/// Appends the block to a file opened with O_APPEND. What was stored of a block that does not fit is removed again.
BlockOutcome append_block(int descriptor, std::string_view block);

/// The same, and a SIGKILL that ends this process meanwhile leaves no part of the block either. Linux looks for a
/// deadly signal between two pages of a write, so a block that lies in more than one page is written by a process of
/// its own, which shares the memory and ends with the write (some 70 microseconds).
BlockOutcome append_block_through_kill(int descriptor, std::string_view block);

}  // namespace tchat
