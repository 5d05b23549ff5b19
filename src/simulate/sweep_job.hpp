/// A sweep without how its values are computed: cutting it into parts, doing them by workers, keeping a journal, going
/// on with it, gathering parts, numbering attractors, writing O.sweep.
///
/// The bytes of O.sweep depend on the job alone, not on workers, parts or interruptions: every unit (a value with all
/// its starts, or, following, a chain of neighbours from one start) is computed from the job and its own results, and
/// whatever compares units is done at the end, in the order of the index.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "simulate/sample_record.hpp"
#include "simulate/sweep_file.hpp"
#include "simulate/sweep_journal.hpp"

namespace tchat {

/// Which columns beside index, values, start, attractor, kind, period, time and impacts.
struct SweepColumns {
  bool event = false;  ///< of each recorded state
  bool penetration = false;
  int exponents = 0;                 ///< how many, each with its error
  std::vector<std::string> largest;  ///< names of the states whose largest values have columns
  std::vector<std::string> states;   ///< names; empty: no states are recorded
};

/// Where a start's values begin.
enum class Following {
  none,  ///< each value at the given start
  up,    ///< the first at the given start, each further one at the end of the one before
  down,  ///< the same from the last value to the first
};

struct SweepJob {
  SweepTable heading;                ///< problem, over, parameters, starts
  std::vector<Following> following;  ///< of each start, 1, 2, ...
  SweepColumns columns;
  SweepIdentity identity;  ///< what the results depend on
  RecordLimits limits;     ///< of what journals and parts may hold: dimension and functions of the problem
  std::vector<SampleFunction> functions;  ///< one for each worker
  /// Values, not more than there are, that are computed first, all the way, to learn which attractors there are; 0
  /// none.
  std::size_t first_values = 0;
  /// Is told the attractors found by the first values before any other value is computed: a sample may then be a mere
  /// `known`. Asks whether it has been interrupted.
  std::function<void(const std::vector<AttractorSample>& known, const std::function<bool()>& interrupted)> learn;
};

/// Into so many parts a sweep can be cut at most.
inline constexpr int most_parts = 100'000;

struct SweepTask {
  std::string output;  ///< O
  int workers = 1;
  int part = 0, parts = 1;  ///< part 0: all of it, or gather
  bool gather = false;
  bool fresh = false;   ///< an older journal is thrown away
  std::string command;  ///< as it was given, without --part and --gather, for messages
};

/// What has been done, for the summary on the screen.
struct SweepOutcome {
  bool is_complete = false;                ///< false: interrupted
  std::size_t values = 0;                  ///< of this part
  std::size_t computed = 0;                ///< now
  std::size_t kept = 0;                    ///< from the journal
  std::string written;                     ///< the file; the journal when interrupted
  std::vector<SweepAttractor> attractors;  ///< not of a part
  std::vector<std::size_t> found;          ///< in how many (value, start) each was
  std::vector<long> least_events;          ///< over which each was seen; 0: not told
  std::size_t without = 0;                 ///< (value, start) without attractor
  std::size_t first_without = 0;           ///< index of the first of them
  std::string first_message;               ///< why it has none
};

/// Throws UserError (another sweep's journal, missing parts) and ComputationError. `progress` may be null.
SweepOutcome run_sweep(const SweepJob& job, const SweepTask& task, const std::function<bool()>& interrupted,
                       std::ostream* progress, std::ostream& screen);

}  // namespace tchat
