/// Standard input, output and error that the caller has closed (`tchat run x >&-`).
#pragma once

namespace tchat {

/// Puts /dev/null where a standard descriptor is closed, so that no file of ours gets its number and with it what is
/// printed. It is opened the wrong way round: reading or writing fails as on a closed descriptor, and can be told.
void occupy_standard_descriptors();

}  // namespace tchat
