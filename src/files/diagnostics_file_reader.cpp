#include "files/diagnostics_file_reader.hpp"

#include <algorithm>
#include <optional>

#include "base/number.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

using Words = std::vector<std::string_view>;

bool is_bar(const Words& words) { return words.size() == 1 && words[0] == std::string_view(std::string(47, '=')); }

bool is_heading(const Words& words) {
  return words.size() >= 4 && words[0] == "BR" && words[1] == "PT" && words[2] == "TY" && words[3] == "LAB";
}

/// `BR PT [TY] LAB ...`: an ordinary point has no letters.
std::optional<DiagnosticPoint> read_point(const Words& words) {
  if (words.size() < 4) return std::nullopt;
  const auto branch = parse_integer(words[0]);
  const auto point = parse_integer(words[1]);
  const auto third = parse_integer(words[2]);
  const auto label = third ? third : parse_integer(words[3]);
  if (!branch || !point || !label) return std::nullopt;
  DiagnosticPoint result;
  result.branch = *branch;
  result.point = *point;
  result.type = third ? "" : std::string(words[2]);
  result.label = *label;
  result.admissible = words.back() != "inadmissible";
  const std::size_t first_value = third ? 3 : 4;
  if (first_value < words.size()) result.parameter = parse_fortran_real(words[first_value]);
  return result;
}

/// The multipliers and the iterations of a block may stand before or after its point.
class Blocks {
 public:
  void read(std::string_view line) {
    const Words words = split_words(line);
    if (words.empty()) return;
    if (after_heading_)
      take_point(words);
    else if (is_bar(words))
      close();
    else if (contains(words, "Multipliers:") || contains(words, "Eigenvalues:"))
      multipliers_.clear();
    else if (contains(words, "NOTE:"))
      take_note(line, words);
    else if (contains(words, "Iterations"))
      take_iterations(words);
    else
      take_multiplier(words);
    after_heading_ = is_heading(words);
  }

  std::vector<DiagnosticPoint> finish() {
    close();
    return std::move(points_);
  }

 private:
  void take_point(const Words& words) {
    const auto point = read_point(words);
    if (!point) return;
    if (open_) close();
    points_.push_back(*point);
    open_ = true;
  }

  static bool contains(const Words& words, std::string_view wanted) {
    return std::find(words.begin(), words.end(), wanted) != words.end();
  }

  void take_note(std::string_view line, const Words& words) {
    if (!open_) return;
    const std::size_t text = line.find_first_not_of(' ', line.find("NOTE:") + 5);
    if (text != std::string_view::npos) points_.back().notes.emplace_back(line.substr(text));
    if (const auto note = parse_normal_form(line)) points_.back().normal_form = note;
    take_xi_zeros(words);
  }

  /// `... xi_1 = 0, xi_2 = 0`
  void take_xi_zeros(const Words& words) {
    for (std::size_t k = 0; k + 2 < words.size(); ++k) {
      if (!words[k].starts_with("xi_") || words[k + 1] != "=" || (words[k + 2] != "0" && words[k + 2] != "0,"))
        continue;
      if (const auto n = parse_integer(words[k].substr(3))) points_.back().xi_zeros.push_back(*n);
    }
  }

  /// `Iterations : n`, after the numbers of branch and point.
  void take_iterations(const Words& words) {
    const auto at = std::find(words.begin(), words.end(), "Iterations");
    if (words.end() - at >= 3 && at[1] == ":") iterations_ = parse_integer(at[2]);
  }

  /// `Multiplier k re im` or, of equilibria, `Eigenvalue k: re im`, in AUTO's files after the numbers of branch and
  /// point.
  void take_multiplier(const Words& words) {
    auto at = std::find(words.begin(), words.end(), "Multiplier");
    if (at == words.end()) at = std::find(words.begin(), words.end(), "Eigenvalue");
    if (words.end() - at < 4 || !parse_integer(at[1].substr(0, at[1].find(':')))) return;
    const auto real = parse_fortran_real(at[2]);
    const auto imaginary = parse_fortran_real(at[3]);
    if (real && imaginary) multipliers_.emplace_back(*real, *imaginary);
  }

  void close() {
    if (open_) {
      points_.back().multipliers = std::move(multipliers_);
      points_.back().iterations = iterations_;
    }
    multipliers_.clear();
    iterations_.reset();
    open_ = false;
  }

  std::vector<DiagnosticPoint> points_;
  std::vector<std::complex<double>> multipliers_;
  std::optional<int> iterations_;
  bool after_heading_ = false;
  bool open_ = false;  // the last point's block goes on
};

}  // namespace

std::vector<DiagnosticPoint> parse_diagnostics(std::string_view text) {
  Blocks blocks;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    blocks.read(without_carriage_return(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return blocks.finish();
}

std::vector<DiagnosticPoint> read_diagnostics_file(const std::string& path) {
  return parse_diagnostics(read_text_file(path, "diagnostics of a run", "a run writes them to d.NAME"));
}

}  // namespace tchat
