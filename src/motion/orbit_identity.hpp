/// Are two periodic orbits the same, and is one the mirror image of the other?
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

#include "model/index_vector.hpp"

namespace tchat {

// Orbits cut by the same events are compared by their states at these: the same when these agree for some rotation of
// the signature, compared until both orbits are back at their start. Of others, and of smooth orbits, points of each
// are compared with the nearest ones on the curve of the other: those do not depend on where an orbit is cut. Two long
// orbits may pass the same places in another order, or more often: periods that are no multiples of each other, to
// 1e-5, are those of two orbits.
//
// Distances are in units of the sizes of both orbits, the larger of the two (sizes_of_differences()). How small one has
// to be is up to how well the orbits are known.

struct ComparedOrbit {
  Signature signature;                    ///< m index vectors, with its repetitions
  Eigen::MatrixXd ends;                   ///< states of each event, on the same side of its jump for all orbits, n x m
  Eigen::VectorXd sizes;                  ///< of differences, n; infinite: left out
  std::vector<Eigen::MatrixXd> segments;  ///< nodes of each, n x (number of them); empty: not known
  std::vector<double> tau;                ///< of the nodes of every segment
  double period = NAN;                    ///< with repetitions; NaN: not known
};

/// The part that a signature repeats, beginning where that is least in the order of index vectors, and how often.
struct PrimitiveWord {
  Signature word;
  int repetitions = 1;
};
PrimitiveWord primitive_word(const Signature& signature);

/// b as it is nearest to a where both are cut.
struct CutComparison {
  double distance = INFINITY;  ///< the largest of a state; infinite where signatures differ
  Eigen::Index shift = 0;      ///< the state of b with the first one of a
};
CutComparison compare_cuts(const ComparedOrbit& a, const ComparedOrbit& b);

/// Largest distance of two orbits. Infinite where they cannot be compared, as what is not cut alike is not known
/// between events.
double orbit_distance(const ComparedOrbit& a, const ComparedOrbit& b);

/// Which states change their signs in the reflection that makes one orbit of the other, to within `tolerance`; nothing
/// where there is none of that kind.
std::optional<std::vector<bool>> reflection(const ComparedOrbit& a, const ComparedOrbit& b, double tolerance);

}  // namespace tchat
