/// Which values of a sweep have the same attractor: a pass over all results in the order of their index, so that
/// numbers do not depend on who has computed what.
///
/// At one parameter value attractors are the same when their orbits are (the same kind and signature, section states
/// that agree). From one value of a swept parameter to the next an attractor goes on in the nearest one of the same
/// kind and signature that is not further away than a tenth of its range, or up to its range where the states of three
/// neighbouring values lie on a line, as those of a branch do. Over two parameters a number stands for a
/// kind and signature. Impacts up to a limit (tchat/chatter.hpp), of which there may be more or fewer on one orbit, are
/// left out of all that.
#pragma once

#include <vector>

#include "simulate/sample_record.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

/// Largest difference of section states, in sizes of their differences (motion/orbit_identity.hpp); infinite for
/// another kind or signature. Of motions that do not repeat themselves the difference of the means.
double attractor_distance(const AttractorSample& a, const AttractorSample& b);
/// Nearer than what recognition leaves open.
bool is_same_attractor(const AttractorSample& a, const AttractorSample& b);
/// Chattering, escape and what has not settled are no attractors.
bool is_attractor(AttractorKind kind);

/// Attractors that differ, in order.
std::vector<AttractorSample> distinct_attractors(const std::vector<SampleRecord>& records);

struct AttractorNumbers {
  std::vector<int> of_record;  ///< 0: none
  /// Of a chaotic motion that is no attractor, as others at the same values have left what they were on after as many
  /// events, or half of them: those events; 0 of others. A transient that is chaotic ends at random.
  std::vector<long> left_after;
  std::vector<SweepAttractor> attractors;
};

/// `records` in the order of index and start; one with `known` = K is the attractor K of `known`.
AttractorNumbers number_attractors(const std::vector<SampleRecord>& records, const std::vector<AttractorSample>& known,
                                   const SweepGrid& grid);

}  // namespace tchat
