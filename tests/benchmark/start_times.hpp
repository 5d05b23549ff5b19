/// Table (h): what a run costs besides its numerics: the program's start, files, the end.
#pragma once

namespace tchat::benchmark {

/// The least of `rounds` runs of each kind, in turn; `quick`: instructions are not counted, which takes seconds.
void print_start_times(int rounds, bool quick);

}  // namespace tchat::benchmark
