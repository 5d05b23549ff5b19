/// Texts of q-files, written from the description of the format and sharing no code with the program.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace test_support {

inline std::string real_text(double value, int decimals, std::size_t width) {
  char digits[64];
  std::snprintf(digits, sizeof digits, "%.*E", decimals, value);
  std::string text = digits;
  const auto exponent = text.find('E') + 2;
  while (text.size() - exponent < 3) text.insert(exponent, "0");
  return std::string(width - text.size(), ' ') + text;
}

inline std::string records(const std::vector<double>& numbers, int decimals = 10) {
  std::string text;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (k % 7 == 0) text += k == 0 ? "    " : "\n    ";
    text += real_text(numbers[k], decimals, decimals == 10 ? 19 : 26);
  }
  return text + "\n";
}

/// One entry as AUTO-07p would write it: state r of time point p is 1 + r + p / 8, its direction -r - p / 4, PAR(k) =
/// k.
struct SampleEntry {
  int label = 1;
  int type = 9;
  int dimension = 2;
  int segments = 1;
  int intervals = 2;
  int collocation = 2;
  std::vector<int> free_parameters = {1, 61};
  bool direction = true;
  int parameters = 104;  ///< NPAR, the four internal values included
  std::vector<double> internal = {0, 0, 0, 0};
  int problem_type = 180;
  int parameter_decimals = 10;  ///< 16 in files of ours

  int points() const { return intervals * collocation + 1; }
  int states() const { return dimension * segments; }
  static double state(int row, int point) { return 1.0 + row + point / 8.0; }
  static double state_direction(int row, int point) { return -row - point / 4.0; }

  int lines() const {
    const int nfpr = static_cast<int>(free_parameters.size());
    int count = (states() / 7 + 1) * points() + (parameters + 6) / 7;
    if (direction) count += (nfpr + 19) / 20 + (nfpr + 6) / 7 + (states() + 6) / 7 * points();
    return count;
  }

  std::string text() const {
    char line[200];
    std::snprintf(line, sizeof line, "%6d%6d%6d%6d%6d%6d%8d%6d%8d%5d%5d%5d%5d%5d%5d%5d\n", 1, 10 * label, type, label,
                  static_cast<int>(free_parameters.size()), 1, points(), states() + 1, lines(), intervals, collocation,
                  parameters, static_cast<int>(internal.size()), dimension, problem_type, 0);
    std::string text = line;
    for (int p = 0; p < points(); ++p) {
      std::vector<double> record = {static_cast<double>(p) / (points() - 1)};
      for (int r = 0; r < states(); ++r) record.push_back(state(r, p));
      text += records(record);
    }
    if (direction) text += direction_text();
    std::vector<double> par;
    for (int k = 1; k <= parameters - static_cast<int>(internal.size()); ++k) par.push_back(k);
    par.insert(par.end(), internal.begin(), internal.end());
    return text + records(par, parameter_decimals);
  }

  std::string direction_text() const {
    std::string text;
    std::vector<double> rates;
    char number[16];
    for (const int k : free_parameters) {
      std::snprintf(number, sizeof number, "%5d", k);
      if (!rates.empty() && rates.size() % 20 == 0) text += "\n";
      text += number;
      rates.push_back(k / 4.0);
    }
    text += "\n" + records(rates);
    for (int p = 0; p < points(); ++p) {
      std::vector<double> record;
      for (int r = 0; r < states(); ++r) record.push_back(state_direction(r, p));
      text += records(record);
    }
    return text;
  }
};

}  // namespace test_support
