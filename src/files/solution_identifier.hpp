/// The first line of a solution in a q-file: 16 integers, 12 in files of the older generation.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "model/parameter_layout.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

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

}  // namespace tchat
