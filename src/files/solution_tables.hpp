/// Tables of labelled solutions, of one orbit in physical time, and of the types of points.
#pragma once

#include <map>
#include <string>

#include "files/point_file.hpp"
#include "files/recorded_labels.hpp"
#include "files/solution_file_reader.hpp"
#include "files/table_writer.hpp"

namespace tchat {

// The labelled solutions of a q-file as a table for other programs, one row a label.
//
//     label  type  name  branch  point  problem_type  branch_mode  segments  dimension  mesh_intervals
//     collocation_points  stable  admissible  period  signature  free
//     normal_form  coefficient  uncertainty  verdict  kind
//         type in letters; name as IRS knows it (GR1), several with a blank between; problem_type is IPS,
//         branch_mode ISW; free: the names of the free parameters, with commas between; kind in words;
//         normal_form: the name of the coefficient (settings/point_type.hpp)
//     the parameters by their names: those with a name, those that are not zero, durations
//
// Not known: stable without a p-file and along curves of special points, admissible and a normal form without a
// d-file, problem_type, segments, dimension and period in older files, signature without the constants of the run.

/// `signature` is that of the run, "" where it is not known.
void write_label_table(TableWriter& out, const SolutionFile& file, const ProblemNames& names,
                       const std::map<int, RecordedLabel>& recorded, const std::string& signature);

// Labelled solutions as tables for people: what a q-file holds, and one orbit in physical time.

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

// The types of points as a table: letters, number and kind in files, meaning.

void write_point_types(TableWriter& out);

}  // namespace tchat
