/// Which starting solution a run uses, and how it becomes an orbit on the mesh of the run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/dat_file.hpp"
#include "files/run_files.hpp"
#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// From starting data or a labelled solution to an orbit on the mesh of the run.

/// Where a branch begins: an orbit that still has to be corrected, and the direction stored with it, if any.
struct OrbitStart {
  Orbit orbit;
  std::optional<OrbitVector> direction;
};

/// Fits a mesh to the rows of a .dat file and interpolates the states by cubics through four neighbouring rows: the
/// mesh that the rows lie on, when there is one of this shape; that of orbit_from_rows(), when it is not coarser than
/// the rows; otherwise one that equidistributes the estimated error of the data, or, where there are fewer rows than
/// nodes, time and arclength of the scaled states. Where `shape` has own meshes of segments, these equidistribute the
/// error of what is so found. `par` holds the parameters and the durations.
Orbit orbit_from_data(const DatFile& data, const OrbitShape& shape, const ParameterVector& par);

/// Rows that divide mesh intervals of different length into equal parts, as those of a simulated orbit do, are an orbit
/// of piecewise polynomials: that one on a mesh of the same density. Nothing when the rows lie on no mesh.
std::optional<Orbit> orbit_from_rows(const DatFile& data, const OrbitShape& shape, const ParameterVector& par);

/// An equilibrium of the state of a .dat file.
Orbit point_from_data(const DatFile& data, const ParameterVector& par);

/// The labelled solution on a mesh of shape.intervals and shape.collocation: its own where they agree, otherwise one of
/// the same density; on own meshes of segments where `shape` has such, else on one in common. PAR is that of the
/// solution (in_layout()). The direction is kept when it has one and its free problem parameters are `free_parameters`,
/// in any order. An equilibrium is one where `shape` says so. Throws UserError (naming `source`) when the number of
/// states is not n m, and when one is an equilibrium and the other is not.
OrbitStart orbit_from_solution(const LabelledSolution& solution, const OrbitShape& shape,
                               const std::vector<int>& free_parameters, const std::string& source);

/// The sizes of a labelled solution of so many segments as it is stored, on own meshes where it has such.
OrbitShape stored_shape(const LabelledSolution& solution, int dimension, int segments);

/// The other way: an orbit with its direction as an entry of a q-file. Branch, point, label and type are left to the
/// caller. An empty direction is left out. `free_parameters`: those of the direction's globals; `listed`: all free PAR
/// indices in the order to print.
LabelledSolution labelled_solution(const Orbit& orbit, const OrbitVector& direction,
                                   const std::vector<int>& free_parameters, const std::vector<int>& listed);

// Which starting solution a run uses: D.dat or a label of q.S, and the parameter values that go with it (plugin
// < comments in the .dat < q-file < command line).

struct SelectedStart {
  OrbitStart start;
  std::optional<Orbit> second;      ///< the same data on another mesh, for when no correction of the first converges
  std::string source;               ///< the file it came from
  bool from_solution = false;       ///< a label of a q-file
  bool label_start = true;          ///< IRS = 0: the first point gets a label
  bool parameters_changed = false;  ///< the command line changed a value that the label had
  ParameterVector known_parameters = ParameterVector(ParameterLayout());  ///< without the command line's values
  int branch = 1;
  int last_label = 0;      ///< largest label in the start file
  int problem_type = 0;    ///< IPS of the label, 0 if unknown
  int label = 0;           ///< its number
  int type = 0;            ///< its type number, tens digit included
  UserPointKind kind;      ///< of a UZ label
  std::vector<int> types;  ///< basic types of a label that is several things at once, the one asked for first
  std::vector<std::string> warnings;
};

/// Throws UserError: no such file, no such label (listing those there are), data that do not fit.
SelectedStart select_start(const RunRequest& request, const RunSettings& settings, const HybridSystem& system,
                           const std::vector<int>& free_parameters);

}  // namespace tchat
