/// A p-file joined with the q-file and d-file of its run, and its points as one table for other programs.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "files/diagnostics_file.hpp"
#include "files/point_file_reader.hpp"
#include "files/solution_file.hpp"
#include "files/table_writer.hpp"

namespace tchat {

// A p-file with what the q-file and d-file of the run add: names of UZ points, values of fixed parameters,
// multipliers, Newton iterations, and which points violate the model.
//
// Points of the three files belong together by branch, point and label; the first number of each, ICP(1), tells files
// of another run apart.

/// The states at which the segments of an orbit begin and end.
struct SegmentEnds {
  Eigen::MatrixXd first;  ///< n x m
  Eigen::MatrixXd last;   ///< n x m, before the jumps
};

/// One continuous branch: rows [begin, end) of a section.
struct BranchPiece {
  std::size_t section = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct BranchFile {
  std::string path;
  std::string name;  ///< without folder and "p."
  std::vector<PointSection> sections;
  std::vector<BranchPiece> pieces;
  std::vector<std::vector<std::string>> types;  ///< letters of each point by section and row; "" for an ordinary point
  std::vector<std::vector<bool>> admissible;    ///< true where the d-file does not say otherwise
  std::map<int, std::vector<int>> xi_zeros;     ///< by label: the n of every xi_n that vanishes there
  std::vector<std::map<int, double>> parameters;  ///< by section: PAR(k) at one of its labels, if the q-file is there
  std::vector<LabelledSolution> solutions;        ///< of the q-file, without mesh, states and direction
  std::vector<SegmentEnds> ends;                  ///< of each solution; empty matrices where m is not known
  std::vector<DiagnosticPoint> diagnostics;       ///< of the d-file
  std::vector<std::vector<int>> solution;         ///< by section and row: where in `solutions`, -1 without
  std::vector<std::vector<int>> diagnostic;       ///< likewise in `diagnostics`
  std::vector<std::string> warnings;

  /// What the q-file and the d-file have of a point; nullptr when they have nothing.
  const LabelledSolution* solution_of(std::size_t section, std::size_t row) const;
  const SegmentEnds* ends_of(std::size_t section, std::size_t row) const;
  const DiagnosticPoint* diagnostic_of(std::size_t section, std::size_t row) const;
};

/// Reads p.NAME, and q.NAME and d.NAME if they are beside it, can be read and are of the same run (a warning if not).
BranchFile read_branch_file(const std::string& path);

/// The same with a q-file and a d-file that the user has named; "" for the one beside the p-file. Throws UserError when
/// a named one cannot be read or is of another run.
BranchFile read_branch_file(const std::string& path, const std::string& solutions, const std::string& diagnostics);

// The points of a run as one table for other programs, one row a point, from p-, q- and d-file together.
//
//     section  branch  point  type  name  label  kind  stable  admissible
//         section from 1; type in letters, name as IRS knows it (GR1), kind in words; point positive
//     the columns of the p-file, by their names in full
//     the other parameters: those of the run that do not change, and durations where they are known
//     multiplier1_re  multiplier1_im  ...  newton_iterations
//
// Not known: stable along curves of special points; admissible, multipliers and iterations without a block of the
// d-file; name and kind without a label of the q-file. 1e99, which stands for "not finite" in the files, is infinite
// for a multiplier and otherwise not known.

/// One row for each point; the multipliers are a list.
void write_branch_table(TableWriter& out, const BranchFile& file);

}  // namespace tchat
