/// The end condition of a contact segment, divided by its duration.
///
/// A contact segment s (model/contact_segment.hpp) begins on the surface h_s = 0 by the end condition of the segment
/// before it, and ends there. Where it lasts no time the row h_s(x_s(1)) = 0 says the same as that one, and Newton's
/// matrix is singular: the orbits with contact meet those that are merely cut twice at one place, T_s = 0. Divided,
///
///     (h_s(x_s(1), p) - h_s(x_s(0), p)) / T_s = mean of h_x f along the segment = 0,
///
/// it has the same solutions with T_s != 0 and at T_s = 0 it says h_x f = 0, the tangency. So one branch passes T_s = 0
/// regularly, with T_s = -2 h_x f / (h_x f)_x f to first order: duration and velocity of the contact are proportional
/// to the arclength there, the parameter moves like their square. Counts of equations and unknowns stay.
#pragma once

#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "orbit/surface_rate.hpp"

namespace tchat {

/// Allocates nothing after construction.
class ContactRow {
 public:
  ContactRow(int dimension, int free_count);

  /// For segment s (from 0) with index vector v.
  double value(const HybridSystem& system, const IndexVector& v, const Orbit& x, int s,
               const std::vector<int>& free_parameters);
  /// With the derivatives by x_s(0), x_s(1), T_s and the free parameters, n + n + 1 + q numbers, written to `entries`;
  /// returns the place behind the last one.
  double* derivatives(const HybridSystem& system, const IndexVector& v, const Orbit& x, int s,
                      const std::vector<int>& free_parameters, double& value, double* entries);

 private:
  SurfaceRate start_, end_;
};

}  // namespace tchat
