/// The d-file (fort.9): what happened at each point, with its multipliers; its writer and its reader.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/point_file.hpp"
#include "settings/point_type.hpp"

namespace tchat {

// The d-file: what happened at each point, for people; AUTO's parser finds points, labels and multipliers in it.
//
// A block belongs to one point and ends with a bar of 47 '='. Texts never hold times of day, durations of the
// computation or paths: files of two equal runs are equal.
//
// A branch has thousands of ordinary points and some labels. The block of a label, and of the first point, has
// everything under its name; that of an ordinary point is short and written without an allocation.

/// One Newton iteration; iteration 0 is the predictor and has no steps.
struct NewtonLine {
  int iteration = 0;
  double parameter = 0.0;        ///< the first free problem parameter after the iteration
  double residual = 0.0;         ///< largest residual before the iteration
  double step_parameters = 0.0;  ///< largest |dp| / (1 + |p|)
  double step_states = 0.0;      ///< max |du| / (1 + max |u|)
};

/// One test function at a point; not `valid`: undefined there (no candidate left, detection suspended).
struct TestFunctionLine {
  std::string name;
  double value = 0.0;
  bool valid = true;
};

/// The bar between blocks.
std::string format_bar();

/// The Newton iterations of one step: a `BR PT IT` table.
std::string format_newton_history(int branch, int point, const std::vector<NewtonLine>& iterations);

/// The `BR PT TY LAB` headings and the line of the point.
std::string format_diagnostics_point(const PointLine& point, const std::vector<PointColumn>& columns);

/// An ordinary point in short. `heading` is that of its first column: `BR PT TY LAB` and its name.
std::string format_short_heading(const std::vector<PointColumn>& columns);
void append_short_point(std::string& text, const PointLine& point, std::string_view heading);

/// `Multiplier 1 6.7454951082E-01 1.1387608377E-01`, or `Eigenvalue 1: ...`, a line for each; a real one ends in 0.
void append_short_multipliers(std::string& text, std::span<const std::complex<double>> multipliers,
                              bool are_eigenvalues);

/// In the order in which the block of the first point names the functions; NaN: undefined. Without values no line.
void append_short_tests(std::string& text, std::span<const double> values);

/// How many iterations of Newton's method it took to come to a point, and the step that is tried from it next.
void append_iterations(std::string& text, int branch, int point, int iterations);
void append_next_step(std::string& text, int branch, int point, double step);

/// `Multipliers:` with the number of stable ones (|mu| <= 1 + 1e-5), then one line for each in the order given: index,
/// real and imaginary part, modulus. Sizes that are not finite or exceed 1e99 are written as 1e99.
std::string format_multipliers(std::span<const std::complex<double>> multipliers);

/// `Eigenvalues:` of an equilibrium with the number of stable ones, then one line for each: index, real and imaginary
/// part.
std::string format_eigenvalues(std::span<const std::complex<double>> eigenvalues, int stable);

std::string format_test_functions(const std::vector<TestFunctionLine>& functions);

/// `    1    12  NOTE: text`, further lines of the text indented.
std::string format_note(int branch, int point, std::string_view text);

/// `    1    12  END bound: text`: why the branch has no further points in this direction. `reason` is a word; `text`
/// is written on one line.
std::string format_branch_end(int branch, int point, std::string_view reason, std::string_view text);

/// `    1    12  LOST from to: text`: between these values of ICP(1) a special point may be missing; `text` is written
/// on one line.
std::string format_lost_point(int branch, int point, double from, double to, std::string_view text);

/// Bar and the last line of a complete file. Nothing may follow but another run's part.
std::string format_end_of_run();

/// True when the text ends like a complete file: with our end of run, or AUTO's total time.
bool ends_complete_run(std::string_view text);

// Reads d-files (fort.9) for what the p-file does not hold: the multipliers of every point, the letters of its type,
// whether the orbit is one of the model, which xi_n vanish there, and how many Newton iterations it took.
//
// Only what AUTO's own readers rely on is looked at: the bars of 47 `=` between blocks, the line below a
// `BR PT TY LAB` heading, lines `Multiplier k re im`, `Eigenvalue k: re im` and `Iterations : n`; and of this program
// the word `inadmissible`, notes, among them `xi_1 = 0, xi_2 = 0` and that of a normal form, where a special
// point may be missing, and why a branch ends.

/// Why a branch has no further points in one direction.
struct RecordedEnd {
  std::string reason;  ///< a word: end_word() (run/branch_writer.hpp)
  std::string text;    ///< for people
};

/// Where a special point may be missing, on the way to a point.
struct RecordedLoss {
  double from = 0.0, to = 0.0;  ///< values of ICP(1), in the direction of the branch
  std::string text;             ///< for people
};

struct DiagnosticPoint {
  int branch = 0;
  int point = 0;     ///< signed: negative when stable
  std::string type;  ///< letters, "" for an ordinary point
  int label = 0;
  bool admissible = true;
  std::vector<std::string> notes;                 ///< the first line of each, in their order
  std::optional<NormalFormNote> normal_form;      ///< of its notes
  std::vector<int> xi_zeros;                      ///< n of every xi_n = 0 in its notes
  std::vector<std::complex<double>> multipliers;  ///< of an equilibrium the eigenvalues
  std::optional<double> parameter;                ///< the first number after the label: ICP(1), to 6 digits
  std::optional<int> iterations;                  ///< Newton iterations
  std::optional<RecordedEnd> end;                 ///< the branch ends here
  std::vector<RecordedLoss> lost;                 ///< special points that may be missing before it
};

/// The points in file order; lines that are not understood are skipped. Throws UserError when the file cannot be read.
std::vector<DiagnosticPoint> read_diagnostics_file(const std::string& path);

/// The same for text already read.
std::vector<DiagnosticPoint> parse_diagnostics(std::string_view text);

}  // namespace tchat
