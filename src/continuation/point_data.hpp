/// What is known about a converged point besides the orbit.
#pragma once

#include <string>
#include <vector>

#include "continuation/path_point.hpp"
#include "orbit/event_minima.hpp"
#include "stability/test_function.hpp"

namespace tchat {

struct PointData {
  FloquetMultipliers multipliers;
  std::vector<double> transversalities;  ///< h_x f / (|h_x| |f|) at the end of each segment
  double singular_distance = 1.0;        ///< as in TestedPoint
  double estimated_error = 0.0;          ///< of the states between mesh points, relative
  std::vector<EventCourse> courses;      ///< of the monitored event functions
  std::vector<TestValue> tests;          ///< one for each test function
  std::vector<std::string> details;      ///< of a labelled point
};

/// A test function that is zero within its uncertainty all along a branch.
struct VanishingFunction {
  std::string name;
  std::string reason;  ///< "" where none is known
};

/// A converged step of length ds and what is known of the point that it has come to.
struct Candidate {
  PathPoint point;
  double ds = 0.0;
  PointData data;
};

}  // namespace tchat
