/// Labelled solutions, and their entries in q-files in AUTO-07p's layout.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/parameter_vector.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

// One solution of a q-file: an orbit with its direction and everything a restart needs. Formats: src/docs/files.md.

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

// The first line of a solution in a q-file: 16 integers, 12 in files of the older generation.

/// How many internal values at the end of PAR say what a UZ label is: kind, segment, index, tau; as many again for
/// each further kind.
inline constexpr int kind_values = 4;
/// In place of a kind, behind the others: so many segments have meshes of their own (segment), of so many points in all
/// (index). These follow, and zeros up to a multiple of kind_values.
inline constexpr int own_mesh_mark = 8;
/// The values behind that mark.
inline std::int64_t own_mesh_values(std::int64_t points) {
  return (points + kind_values - 1) / kind_values * kind_values;
}

/// The integers in the order of the file; the last four are zero in the older generation.
struct SolutionIdentifier {
  std::array<int, 16> values{};
  std::size_t count = 0;

  int branch() const { return magnitude(values[0]); }
  int point() const { return magnitude(values[1]); }
  int type() const { return values[2]; }
  int label() const { return values[3]; }
  std::int64_t free_parameters() const { return values[4]; }       ///< NFPR
  int branch_mode() const { return values[5]; }                    ///< ISW
  std::int64_t time_points() const { return values[6]; }           ///< NTPL
  std::int64_t numbers_per_point() const { return values[7]; }     ///< NAR = 1 + number of states
  std::int64_t lines() const { return values[8]; }                 ///< NROWPR, lines after this one
  std::int64_t mesh_intervals() const { return values[9]; }        ///< NTST
  std::int64_t collocation_points() const { return values[10]; }   ///< NCOL
  std::int64_t parameters() const { return values[11]; }           ///< NPAR
  std::int64_t internal_parameters() const { return values[12]; }  ///< NPARI, the last of the NPAR
  int dimension() const { return values[13]; }                     ///< NDIM, of one segment
  int problem_type() const { return values[14]; }                  ///< IPS
  /// Where PAR has the durations. The last integer is the number of the problem's parameters where the file records it.
  ParameterLayout layout() const { return ParameterLayout(is_ours() ? std::clamp(values[15], 0, most_parameters) : 0); }

  std::int64_t states() const { return numbers_per_point() - 1; }
  /// A line that only carries the largest branch and label.
  bool is_empty_entry() const { return time_points() == 0 && lines() == 0; }
  /// Written by this program; of a problem type that is AUTO's too, where PAR has room for durations.
  bool is_ours() const {
    return is_own_problem_type(problem_type()) &&
           (!is_shared_problem_type(problem_type()) ||
            parameters() - internal_parameters() >= ParameterLayout().first_duration());
  }
  bool has_kind() const { return is_ours() && internal_parameters() > 0 && internal_parameters() % kind_values == 0; }

  /// How many numbers the solution has after this line, and how many lines they take in AUTO's layout.
  std::int64_t numbers(bool direction) const;
  std::int64_t standard_lines(bool direction) const;

 private:
  static int magnitude(int value) { return value < 0 ? -(value + (value < -2147483647 ? 1 : 0)) : value; }
};

/// Throws UserError like check_counts() when branch or label leaves no room for those of a run that goes on from there.
void check_numbering(const SolutionIdentifier& id, const std::string& place);

/// Throws UserError, with `place` (path:line) before the message, when the counts are out of range or contradict each
/// other.
void check_counts(const SolutionIdentifier& id, const std::string& place);

/// For a solution of which the file has fewer lines than announced: throws UserError when the number of lines does not
/// follow from the other counts, so that it is the line that is wrong and not the end of the file that is missing.
void check_line_count(const SolutionIdentifier& id, const std::string& place);

// One labelled solution as an entry of a q-file, in AUTO-07p's layout:
//
//     16 integers:  BR PT TY LAB NFPR ISW NTPL NAR NROWPR NTST NCOL NPAR NPARI NDIM IPS P
//     t, U(1..n m)                    NTPL records, each on lines of at most 7 numbers of 19 columns after 4 blanks,
//                                     or of 26, exact, where segments have their own meshes
//     ICP; d PAR(ICP)/ds; dU/ds       only with direction
//     PAR(1..NPAR)                    at most 7 numbers of 26 columns on a line, exact; the last NPARI = 4 are kind,
//                                     segment, index and tau of a UZ point; more of them are further kinds, and
//                                     meshes of segments (SolutionIdentifier)
//
// NPAR = max(100, 60 + m) + 4: the parameters are padded with zeros. P is the number of the problem's parameters where
// it moves the durations, or the rotation number of a torus, to other places (ParameterLayout); else 0, as AUTO
// writes. NaN and inf are written as 1e99 (capped_value).

/// The entry, every line with its newline. Throws std::invalid_argument when the parts of `solution` do not fit
/// together: NTPL and mesh, states and dimension, direction and free parameters, more parameters than NPAR has room
/// for.
std::string format_solution(const LabelledSolution& solution);

// The labels in a q-file, without the numbers of its solutions: much faster than reading it.

/// The labels of the whole solutions, in file order; a cut last one is left out. Empty when there is no file, nothing
/// when the file is no q-file.
std::optional<std::vector<int>> whole_solution_labels(const std::string& path);

}  // namespace tchat
