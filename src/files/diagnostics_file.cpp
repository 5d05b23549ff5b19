#include "files/diagnostics_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/levels.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr std::string_view end_of_run = "end of run";
constexpr std::string_view auto_end_of_run = "Total Time";
constexpr double stable_modulus = 1.0 + level::on_circle;

constexpr std::string_view bar = "===============================================\n";  // 47

std::string prefix(int branch, int point) {
  std::string text;
  append_branch_and_point(text, branch, point);
  return text;
}

double capped(double value) { return std::clamp(finite(value), -capped_value, capped_value); }

/// AUTO's parser takes every "Multiplier " and "Eigenvalue " for the beginning of a number pair.
std::string harmless(std::string_view text) {
  std::string result(text);
  for (const std::string_view word : {"Multiplier", "Eigenvalue"})
    for (auto at = result.find(word); at != std::string::npos; at = result.find(word, at + 1))
      result[at] = static_cast<char>(result[at] - 'A' + 'a');
  return result;
}

}  // namespace

std::string format_bar() { return std::string(bar); }

std::string format_newton_history(int branch, int point, const std::vector<NewtonLine>& iterations) {
  std::string text = "  BR    PT  IT     PARAMETER      RESIDUAL      PAR. STEP     STATE STEP\n";
  for (const NewtonLine& line : iterations) {
    text += prefix(branch, point) + integer_field(line.iteration, 4);
    text += fmt::format("{:14.5E}{:14.5E}", finite(line.parameter), finite(line.residual));
    if (line.iteration > 0)
      text += fmt::format("{:14.5E}{:15.5E}", finite(line.step_parameters), finite(line.step_states));
    text += '\n';
  }
  return text;
}

std::string format_diagnostics_point(const PointLine& point, const std::vector<PointColumn>& columns) {
  return format_table_heading(columns) + format_table_line(point, columns);
}

std::string format_short_heading(const std::vector<PointColumn>& columns) {
  return format_table_heading({columns.front()});
}

void append_short_point(std::string& text, const PointLine& point, std::string_view heading) {
  text += heading;
  append_branch_and_point(text, point.branch, point.point, point.stable ? -1 : 1);
  text.append(4, ' ');
  append_integer_field(text, point.label, 5);
  text.append(2, ' ');
  append_scientific(text, point.values.front(), 5);
  if (!point.admissible) text += "  inadmissible";
  text += '\n';
}

void append_short_multipliers(std::string& text, std::span<const std::complex<double>> multipliers,
                              bool are_eigenvalues) {
  constexpr int decimals = 10;
  int index = 0;
  for (const std::complex<double>& value : multipliers) {
    text += are_eigenvalues ? "Eigenvalue" : "Multiplier";
    append_integer_field(text, ++index, 0);
    text += are_eigenvalues ? ": " : " ";
    append_scientific(text, capped(value.real()), decimals);
    text += ' ';
    if (value.imag() == 0.0)
      text += '0';
    else
      append_scientific(text, capped(value.imag()), decimals);
    text += '\n';
  }
}

void append_short_tests(std::string& text, std::span<const double> values) {
  if (values.empty()) return;
  constexpr int digits = 5;
  text += "tests:";
  for (const double value : values) {
    text += ' ';
    if (std::isnan(value))
      text += '-';
    else
      append_short(text, value, digits);
  }
  text += '\n';
}

void append_iterations(std::string& text, int branch, int point, int iterations) {
  append_branch_and_point(text, branch, point);
  text += "  Iterations   :";
  append_integer_field(text, iterations, 0);
  text += '\n';
}

void append_next_step(std::string& text, int branch, int point, double step) {
  append_branch_and_point(text, branch, point);
  text += "  Next Step    : ";
  const std::size_t number = text.size();
  append_scientific(text, step, 5);
  text[text.find('E', number)] = 'e';  // no value of a test function: those have E
  text += '\n';
  text += bar;
}

std::string format_multipliers(std::span<const std::complex<double>> multipliers) {
  const auto stable = std::count_if(multipliers.begin(), multipliers.end(),
                                    [](const std::complex<double>& mu) { return std::abs(mu) <= stable_modulus; });
  std::string text = fmt::format(" Multipliers:     Stable: {:3}\n", stable);
  int index = 0;
  for (const std::complex<double>& mu : multipliers)
    text += fmt::format("   Multiplier{}{}{}   Abs. Val.{}\n", integer_field(++index, 4), e19(capped(mu.real())),
                        e19(capped(mu.imag())), e19(capped(std::abs(mu))));
  return text;
}

std::string format_eigenvalues(std::span<const std::complex<double>> eigenvalues, int stable) {
  std::string text = fmt::format(" Eigenvalues:     Stable: {:3}\n", stable);
  int index = 0;
  for (const std::complex<double>& value : eigenvalues)
    text += fmt::format("   Eigenvalue {}:{}{}\n", integer_field(++index, 3), e19(capped(value.real())),
                        e19(capped(value.imag())));
  return text;
}

std::string format_test_functions(const std::vector<TestFunctionLine>& functions) {
  std::string text;
  for (const TestFunctionLine& function : functions)
    text += fmt::format("   {:<44} {}\n", harmless(function.name) + ":",
                        function.valid ? e19(function.value) : fmt::format("{:>19}", "undefined"));
  return text;
}

namespace {

std::string on_one_line(std::string_view text) {
  std::string line = harmless(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

}  // namespace

std::string format_note(int branch, int point, std::string_view text) {
  const std::string start = prefix(branch, point) + "  NOTE: ";
  std::string note = start;
  for (const char c : harmless(text)) note += c == '\n' ? "\n" + std::string(start.size(), ' ') : std::string(1, c);
  return note + '\n';
}

std::string format_branch_end(int branch, int point, std::string_view reason, std::string_view text) {
  return fmt::format("{}  END {}: {}\n", prefix(branch, point), reason, on_one_line(text));
}

std::string format_lost_point(int branch, int point, double from, double to, std::string_view text) {
  return fmt::format("{}  LOST {:.8g} {:.8g}: {}\n", prefix(branch, point), from, to, on_one_line(text));
}

std::string format_end_of_run() { return format_bar() + std::string(end_of_run) + '\n'; }

bool ends_complete_run(std::string_view text) {
  const auto last = text.find_last_not_of(" \t\r\n");
  if (last == std::string_view::npos || text.find('\n', last) == std::string_view::npos) return false;
  text = text.substr(0, last + 1);
  const auto line_end = text.rfind('\n');
  std::string_view line = line_end == std::string_view::npos ? text : text.substr(line_end + 1);
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  return line == end_of_run || line.starts_with(auto_end_of_run);
}

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
    else if (words.size() > 4 && words[2] == "LOST" && words[4].ends_with(':'))
      take_loss(line, words);
    else if (contains(words, "NOTE:"))
      take_note(line, words);
    else if (words.size() > 3 && words[2] == "END" && words[3].ends_with(':'))
      take_end(line, words);
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

  /// `1  12  END bound: text`
  void take_end(std::string_view line, const Words& words) {
    if (points_.empty()) return;
    const std::string_view reason = words[3].substr(0, words[3].size() - 1);
    points_.back().end = RecordedEnd{std::string(reason), text_behind(line, words[3])};
  }

  /// `1  12  LOST 3.1 3.2: text`
  void take_loss(std::string_view line, const Words& words) {
    const auto from = parse_fortran_real(words[3]), to = parse_fortran_real(words[4].substr(0, words[4].size() - 1));
    if (!points_.empty() && from && to) points_.back().lost.push_back({*from, *to, text_behind(line, words[4])});
  }

  static std::string text_behind(std::string_view line, std::string_view word) {
    return std::string(trimmed(line.substr(static_cast<std::size_t>(word.data() + word.size() - line.data()))));
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
