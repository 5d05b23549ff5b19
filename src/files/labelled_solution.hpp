/// One solution of a q-file: an orbit with its direction and everything a restart needs. Formats: src/docs/files.md.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "model/parameter_layout.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_id.hpp"

namespace tchat {

struct LabelledSolution {
  int branch = 1;
  int point = 1;  ///< point number, positive
  int type = 0;   ///< type number as in the file, tens digit included
  int label = 1;
  int branch_mode = periodic_orbit.branch_mode;  ///< ISW of the run
  int problem_type = periodic_orbit.number;      ///< IPS; 0 in files of the older generation (12 integers)
  int dimension = 0;                             ///< n of one segment; 0 in files of the older generation
  ParameterLayout layout;                        ///< of the parameters
  int mesh_intervals = 0;
  int collocation_points = 0;

  std::vector<double> tau;                  ///< NTPL = mesh_intervals * collocation_points + 1 values from 0 to 1
  Eigen::MatrixXd states;                   ///< (n m) x NTPL, segment 1's states first
  std::vector<double> own_mesh;             ///< where segments have meshes of their own: the points of these meshes in
                                            ///< a row, each from 0 to 1; `tau` is so fine that states on them follow
                                            ///< from `states` (mesh_adaptation.hpp). Else empty
  std::vector<int> free_parameters;         ///< ICP really used, durations included
  std::vector<double> parameter_direction;  ///< d PAR(free_parameters[i]) / ds, ds > 0 on along the branch as
                                            ///< its run went; empty without direction
  Eigen::MatrixXd state_direction;          ///< like states; 0 x 0 without direction
  std::vector<double> parameters;           ///< PAR(1..NPAR - NPARI)
  UserPointKind kind;                       ///< from the NPARI internal values
  std::vector<UserPointKind> further;       ///< likewise, of what vanishes at the same point

  bool has_direction() const { return state_direction.size() > 0; }
};

std::string type_name(const LabelledSolution& solution);
/// All names of a point that is several things at once, each once, its own first: {"GR", "UZ"}.
std::vector<std::string> type_names(const LabelledSolution& solution);

/// The basic type numbers of a solution (PointType): that of the name it was asked for by first, then its own.
std::vector<int> basic_types(const LabelledSolution& solution, const std::string& asked_for = "");

/// The kinds of a UZ point, or of what vanishes together with a point of another type; its own first.
std::vector<UserPointKind> all_kinds(const LabelledSolution& solution);

/// What a solution is, in words, of all its kinds, joined by "; ". `parameter_name` names PAR(k).
std::string description(const LabelledSolution& solution, const std::function<std::string(int)>& parameter_name);

}  // namespace tchat
