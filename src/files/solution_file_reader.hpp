/// Reads q-files: labelled solutions of this program, of AUTO-07p (16 integers before each solution) and of AUTO 97
/// and TC-HAT (12 integers).
///
/// Numbers are list-directed (any width; `1.0-100`, `E+000`, `D+00`). A last solution that was cut off is left out with
/// a warning. Every count in the file is checked against the file before memory is asked for.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "files/solution_file.hpp"
#include "settings/point_type.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

struct SolutionFile {
  std::vector<LabelledSolution> solutions;  ///< in file order
  int last_branch = 0;                      ///< largest in the file, a trailing empty entry included; 0 without any
  int last_label = 0;                       ///< likewise
  std::size_t complete_bytes = 0;           ///< where the last complete entry ends, its newline included
  std::vector<std::string> warnings;        ///< complete messages with path and line
};

/// Throws UserError with path:line, what was found and the cure: file missing, not a q-file, counts that contradict
/// each other or the file, tokens that are no finite numbers. An empty file holds no solutions and is no error.
SolutionFile read_solution_file(const std::string& path);

/// The same for text already read; `path` is for the messages.
SolutionFile parse_solution_file(std::string_view text, const std::string& path);

/// The same with those solutions alone that `label` may mean, which is much faster; where none is meant, with all of
/// them. Numbers of solutions that are passed over are not looked at; their first lines are, and warnings, branch and
/// label are those of the whole file.
SolutionFile read_solution_file(const std::string& path, const StartLabel& label);
SolutionFile parse_solution_file(std::string_view text, const std::string& path, const StartLabel& label);

/// `path`, or q.NAME in the same folder when there is no file NAME but that one.
std::string resolve_solution_path(const std::string& path);

/// The solution with a label number, or the n-th one of a type (PD1, UZ2, GR1; a number below 1 counts as 1). UZ means
/// user values only, GR contacts and impact velocities zero, XI zeros of xi_n. A solution that is several things at
/// once has all their names. Throws UserError that lists the labels there are.
const LabelledSolution& find_solution(const std::vector<LabelledSolution>& solutions, const StartLabel& label,
                                      const std::string& path);

/// By which names find_solution() finds each solution, its own first: {"GR1", "UZ3"}.
std::vector<std::vector<std::string>> counted_names(const std::vector<LabelledSolution>& solutions);

/// A label as users name it: a number, or a type with its count, GR1. Throws UserError.
StartLabel read_label(const std::string& word);

/// Number of segments m: rows / n; for files of the older generation the number of durations among the free parameters.
/// 0 when neither tells.
int segment_count(const LabelledSolution& solution);

/// The same solution for a problem of another number of parameters: those that both have, durations and rotation number
/// go to their places in `layout`.
LabelledSolution in_layout(LabelledSolution solution, const ParameterLayout& layout);

/// PAR(k); 0 where the solution has none.
double stored_parameter(const LabelledSolution& solution, int k);

/// Of segment s, from 0: PAR(61+s), or behind more than 60 parameters. Orbits of AUTO itself have their period in
/// PAR(11), and its boundary value problems are on the interval from 0 to 1.
double duration(const LabelledSolution& solution, int s);

/// Sum of the durations; 0 for an equilibrium, and when the number of segments is not known.
double period(const LabelledSolution& solution);

}  // namespace tchat
