/// One solution of a q-file: an orbit with its direction and everything a restart needs. Formats: src/docs/files.md.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tchat {

/// Type numbers of AUTO (src/docs/files.md); on two-parameter curves the file adds a tens digit.
enum class PointType {
  ordinary = 0,
  regular = 4,  ///< every NPR points
  user = -4,    ///< UZ and every zero of a monitored function
  fold = 5,
  branch_point = 6,
  period_doubling = 7,
  torus = 8,
  end = 9,
  no_convergence = -9,
  cusp = -2,         ///< on fold curves
  resonance_1 = -5,  ///< 1:1, on fold and torus curves
  resonance_2 = -6,  ///< 1:2, on period-doubling and torus curves
  resonance_3 = -7,  ///< 1:3, on torus curves
  resonance_4 = -8   ///< 1:4, on torus curves
};

/// What a UZ label is: the last PAR entries of a q-file entry, four internal values for each kind. What vanishes with
/// the label's own function has a kind each, after the label's own.
struct UserPointKind {
  enum Kind {
    none = 0,
    user_value = 1,
    contact = 2,
    xi = 3,
    impact_velocity = 4,
    grazing_codimension_two = 5,
    other_type = 6  ///< a point that has a type number of its own, beside the label's
  };
  int kind = none;
  int segment = 0;  ///< from 1
  int index = 0;    ///< event function, n of xi_n, PAR index of a user value, or type number (other_type)
  double tau = 0.0;
  bool operator==(const UserPointKind&) const = default;
};

struct LabelledSolution {
  int branch = 1;
  int point = 1;  ///< point number, positive
  int type = 0;   ///< type number as in the file, tens digit included
  int label = 1;
  int branch_mode = 1;     ///< ISW of the run
  int problem_type = 180;  ///< IPS; 0 in files of the older generation (12 integers)
  int dimension = 0;       ///< n of one segment; 0 in files of the older generation
  int mesh_intervals = 0;
  int collocation_points = 0;

  std::vector<double> tau;                  ///< NTPL = mesh_intervals * collocation_points + 1 values from 0 to 1
  Eigen::MatrixXd states;                   ///< (n m) x NTPL, segment 1's states first
  std::vector<int> free_parameters;         ///< ICP really used, durations included
  std::vector<double> parameter_direction;  ///< d PAR(free_parameters[i]) / ds, ds > 0 on along the branch as
                                            ///< its run went; empty without direction
  Eigen::MatrixXd state_direction;          ///< like states; 0 x 0 without direction
  std::vector<double> parameters;           ///< PAR(1..NPAR - NPARI)
  UserPointKind kind;                       ///< from the NPARI internal values
  std::vector<UserPointKind> further;       ///< likewise, of what vanishes at the same point

  bool has_direction() const { return state_direction.size() > 0; }
};

}  // namespace tchat
