/// One value of a sweep: what goes into its computation, what is computed, and its line in the journal.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/messages.hpp"
#include "model/index_vector.hpp"
#include "motion/growth_series.hpp"

namespace tchat {

// One value of a sweep: what goes into its computation and what comes out. A sweep knows nothing of how it is done: by
// simulation, or by iterating a composite map.
//
// Each worker calls a function of its own, in its own thread: it may keep memory, but what it returns must depend on
// its argument alone, to the last bit.

/// Where a motion can be taken up again.
struct MotionState {
  Eigen::VectorXd x;
  std::vector<IndexVector> watched;  ///< what is watched from there; empty: what the problem says of a start
};

struct SweepPoint {
  std::size_t index = 0;          ///< of the value, from 0; the first swept quantity runs fastest
  Eigen::VectorXd values;         ///< of the swept quantities, in their order
  int start = 1;                  ///< number of the start, from 1
  std::optional<MotionState> at;  ///< the neighbour's final state, which is gone on from; nothing: the given start
};

/// What a value has settled on. What was not asked for is left as it is here.
struct AttractorSample {
  AttractorKind kind = AttractorKind::none;
  Signature signature;                ///< of one period, cut where it is least; empty: not periodic
  double period = NAN;                ///< time of one period; NaN: not periodic
  int impacts = -1;                   ///< per period: events whose jump is not the identity; -1: not periodic
  double penetration = NAN;           ///< minus the least value of a monitored event function over the attractor; NaN
  Eigen::VectorXd exponents, errors;  ///< Lyapunov exponents, descending, with their error bars
  Eigen::MatrixXd sections;           ///< recorded states, n x (number of them), in the order of time
  std::vector<int> section_events;    ///< the event function of each, where several are recorded; else empty
  Eigen::VectorXd section_penetrations;  ///< of each, on P (h_J,x f = 0), or of the contact beside it; else empty
  /// max(x_k) for each recorded state, n x (number of them, 1 without any): over the period; at rest x_k; without a
  /// period up to the next recorded state of the same event function, NaN behind the last one. NaN of ignorable states
  /// too. Empty: not asked for, or no attractor.
  Eigen::MatrixXd largest;
  /// Section states by which equal attractors are known; periodic: one period, of every event in the order of
  /// compared_signature(); at rest the equilibrium. n x (number of them)
  Eigen::MatrixXd identity;
  /// Without impacts up to a limit, of which there may be more or fewer on one orbit; empty: `signature`.
  Signature without_chatter;
  Eigen::VectorXd sizes;  ///< of differences of each state over the attractor, at rest the sizes of the states; n
  MotionState last;       ///< to go on from at a neighbouring value; x is empty where there is nothing to go on from
  long events = 0;        ///< over which it was seen, from the start to the verdict; 0: not told
  int known = 0;          ///< number, from 1, of the known attractor that has captured it, which is then all there is
  std::string message;    ///< why it has not settled, one line; empty when there is nothing to say

  const Signature& compared_signature() const { return without_chatter.empty() ? signature : without_chatter; }
};

/// Thrown where a value has been given up because of a signal.
class SampleInterrupted : public ComputationError {
 public:
  SampleInterrupted() : ComputationError("interrupted") {}
};

/// Throws SampleInterrupted, and then nothing of that value is kept.
using SampleFunction = std::function<AttractorSample(const SweepPoint&)>;

// A computed value as one line of a journal: what is read back is the same to the last bit.

struct SampleRecord {
  std::size_t index = 0;
  int start = 1;
  AttractorSample sample;
};

/// `text` with its hash behind it and a newline: a line of a journal.
std::string hashed_line(const std::string& text);
/// Ends in a hash of the line and a newline.
std::string record_line(const SampleRecord& record);
/// Nothing for a line that is damaged or cut.
std::optional<SampleRecord> read_record(const std::string& line);

}  // namespace tchat
