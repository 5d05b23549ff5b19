/// Orbits whose segments have meshes of their own, on a mesh that all segments have in common, as files store them; and
/// back.
///
/// The mesh in common is so fine that each interval of each segment has c + 1 of its nodes at least. So the polynomial
/// on that interval passes through these, and is found again from them to rounding. Between its nodes the orbit in
/// common has the error of interpolation on finer intervals, of order c + 1.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "orbit/orbit.hpp"

namespace tchat {

/// An orbit with a mesh in common as one whose segments have this mesh each.
Orbit with_own_meshes(Orbit x);

/// Do all segments have the same mesh?
bool have_one_mesh(const OrbitShape& shape, const std::vector<double>& mesh);

/// A mesh in common for orbits on own meshes: that which all have, or a finer one.
std::vector<double> mesh_in_common(const OrbitShape& own, const std::vector<double>& own_mesh);

/// The other way: states (n x columns) on own meshes from those on a mesh in common.
Eigen::MatrixXd states_on_own_meshes(const Eigen::MatrixXd& states, const OrbitShape& common,
                                     const std::vector<double>& common_mesh, const OrbitShape& own,
                                     const std::vector<double>& own_mesh);

}  // namespace tchat
