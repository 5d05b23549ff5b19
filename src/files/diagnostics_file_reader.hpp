/// Reads d-files (fort.9) for what the p-file does not hold: the multipliers of every point, the letters of its type,
/// whether the orbit is one of the model, which xi_n vanish there, and how many Newton iterations it took.
///
/// Only what AUTO's own readers rely on is looked at: the bars of 47 `=` between blocks, the line below a
/// `BR PT TY LAB` heading, lines `Multiplier k re im`, `Eigenvalue k: re im` and `Iterations : n`; and of this program
/// the word `inadmissible` and notes, among them `xi_1 = 0, xi_2 = 0` and that of a normal form.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "settings/normal_form_note.hpp"

namespace tchat {

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
};

/// The points in file order; lines that are not understood are skipped. Throws UserError when the file cannot be read.
std::vector<DiagnosticPoint> read_diagnostics_file(const std::string& path);

/// The same for text already read.
std::vector<DiagnosticPoint> parse_diagnostics(std::string_view text);

}  // namespace tchat
