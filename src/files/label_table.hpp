/// The labelled solutions of a q-file as a table for other programs, one row a label.
///
///     label  type  name  branch  point  problem_type  branch_mode  segments  dimension  mesh_intervals
///     collocation_points  stable  admissible  period  signature  free
///     normal_form  coefficient  uncertainty  verdict  kind
///         type in letters; name as IRS knows it (GR1), several with a blank between; problem_type is IPS,
///         branch_mode ISW; free: the names of the free parameters, with commas between; kind in words;
///         normal_form: the name of the coefficient (settings/normal_form_note.hpp)
///     the parameters by their names: those with a name, those that are not zero, durations
///
/// Not known: stable without a p-file and along curves of special points, admissible and a normal form without a
/// d-file, problem_type, segments, dimension and period in older files, signature without the constants of the run.
#pragma once

#include <map>
#include <string>

#include "files/point_columns.hpp"
#include "files/recorded_labels.hpp"
#include "files/solution_file_reader.hpp"
#include "files/table_writer.hpp"

namespace tchat {

/// `signature` is that of the run, "" where it is not known.
void write_label_table(TableWriter& out, const SolutionFile& file, const ProblemNames& names,
                       const std::map<int, RecordedLabel>& recorded, const std::string& signature);

}  // namespace tchat
