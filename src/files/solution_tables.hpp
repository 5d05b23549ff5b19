/// Labelled solutions as tables for people: what a q-file holds, and one orbit in physical time.
#pragma once

#include <map>
#include <string>

#include "files/point_columns.hpp"
#include "files/recorded_labels.hpp"
#include "files/solution_file_reader.hpp"

namespace tchat {

/// One line for each solution: label, type, branch, point, problem type, segments, mesh, period, the free parameters
/// that are not durations with their values, by their names where there are some, and what a special point is. "-"
/// where an older file does not tell. With what the run recorded: stability, and its own words where they are known;
/// what does not fit 100 columns stands on lines of its own.
std::string format_label_table(const SolutionFile& file, const ProblemNames& names = {},
                               const std::map<int, RecordedLabel>& recorded = {});

/// All segments of an orbit, one after the other, in physical time: '#' heading, then lines
///
///     segment  tau  t  U(1) .. U(n), by their names          t = T_1 + ... + T_{s-1} + tau T_s
///
/// An empty line separates segments. `dimension` is n, for files of the older generation; 0: what the solution says.
/// `name` says whose orbit it is. Throws UserError when n is not known or the states are no whole number of segments.
std::string format_orbit_table(const LabelledSolution& solution, const std::string& name,
                               const ProblemNames& names = {}, int dimension = 0);

/// The same numbers as CSV: segment,tau,t and the states by their names, every number with all the digits it has.
std::string format_orbit_csv(const LabelledSolution& solution, const std::string& name, const ProblemNames& names = {},
                             int dimension = 0);

}  // namespace tchat
