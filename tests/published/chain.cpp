#include "published/chain.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <utility>

#include "published/kept_folder.hpp"

namespace test_support {

namespace {

bool is_number(const std::string& word) { return !word.empty() && std::isdigit(static_cast<unsigned char>(word[0])); }

/// "   2    -3  PD   46   3.0E+00 ..." with or without the type.
DiagnosticPoint read_point(const std::string& line) {
  const std::vector<std::string> words = words_of(line);
  REQUIRE(words.size() > 3);
  const std::size_t typed = is_number(words[2]) ? 0 : 1;
  return {
      std::stoi(words[0]), std::stoi(words[1]), std::stoi(words[2 + typed]), typed == 1 ? words[2] : "", {}, {}, {}};
}

/// "   h_x f at the end of segment 1:    -7.5E-003" of a label or the first point, or "tests: -7.5e-3 ..." of another
/// point in their order; undefined values are no numbers and left out.
class TestReader {
 public:
  void begin_point() { names_are_new_ = true; }
  void read(const std::string& line, DiagnosticPoint& point) {
    if (line.compare(0, 6, "tests:") == 0) return read_short(words_of(line.substr(6)), point);
    const auto colon = line.find(": ");
    if (line.compare(0, 3, "   ") != 0 || colon == std::string::npos) return;
    const std::vector<std::string> value = words_of(line.substr(colon + 1));
    if (value.size() != 1 || (value[0] != "undefined" && value[0].find('E') == std::string::npos)) return;
    if (std::exchange(names_are_new_, false)) names_.clear();
    names_.push_back(line.substr(3, colon - 3));
    if (value[0] != "undefined") point.tests[names_.back()] = std::stod(value[0]);
  }

 private:
  /// Values whose names are not known are left out.
  void read_short(const std::vector<std::string>& values, DiagnosticPoint& point) const {
    if (values.size() != names_.size()) return;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (values[k] != "-") point.tests[names_[k]] = std::stod(values[k]);
  }

  std::vector<std::string> names_;
  bool names_are_new_ = true;
};

}  // namespace

namespace {

/// tchat run linosc ARGUMENTS -o NAME, or a copy of what it has written in another test.
void run_once(const Workspace& workspace, const std::string& arguments, const std::string& name) {
  namespace fs = std::filesystem;
  const KeptFolder kept("linosc_" + name, files_of({LINOSC_CONSTANTS, LINOSC_LIBRARY}), arguments);
  const fs::path complete = kept.path() / "complete";
  const auto copy = [&](const fs::path& from, const fs::path& to) {
    for (const char* const kind : {"p.", "q.", "d.", "r."})
      if (fs::exists(from / (kind + name)))
        fs::copy_file(from / (kind + name), to / (kind + name), fs::copy_options::overwrite_existing);
  };
  if (fs::exists(complete)) return copy(kept.path(), workspace.file(""));
  workspace.run(arguments + " -o " + name);
  copy(workspace.file(""), kept.path());
  fs::create_directory(complete);
}

}  // namespace

void run_to_grazing_curve(const Workspace& workspace) {
  run_once(workspace, "-c to_grazing -d nonimpacting", "grazing");
  run_once(workspace, "-c grazing_curve -s grazing --both", "grazing_curve");
}

void run_impacting(const Workspace& workspace, const std::string& omega) {
  run_to_grazing_curve(workspace);
  run_once(workspace, "-c impacting_" + omega + " -s grazing_curve", "impacting_" + omega);
}

std::vector<DiagnosticPoint> read_diagnostics(const std::string& text) {
  std::vector<DiagnosticPoint> points;
  TestReader tests;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.compare(0, 20, "  BR    PT  TY  LAB ") == 0 && std::getline(in, line)) {
      points.push_back(read_point(line));
      tests.begin_point();
    } else if (points.empty())
      continue;
    else if (line.find("Multiplier ") != std::string::npos && line.find("NOTE: ") == std::string::npos)
      points.back().multipliers.emplace_back(std::stod(words_of(line).at(2)), std::stod(words_of(line).at(3)));
    else if (const auto note = line.find("NOTE: "); note != std::string::npos)
      points.back().notes.push_back(line.substr(note + 6));
    else
      tests.read(line, points.back());
  }
  return points;
}

const DiagnosticPoint& with_label(const std::vector<DiagnosticPoint>& points, int label) {
  for (const DiagnosticPoint& point : points)
    if (point.label == label) return point;
  FAIL("no label " << label << " in the d-file");
  return points.front();
}

std::vector<DiagnosticPoint> of_type(const std::vector<DiagnosticPoint>& points, const std::string& type) {
  std::vector<DiagnosticPoint> found;
  std::copy_if(points.begin(), points.end(), std::back_inserter(found),
               [&](const DiagnosticPoint& point) { return point.type == type; });
  return found;
}

SolutionEntry only(const Workspace& workspace, const std::string& name, const std::string& type) {
  const auto found = of_type(read_diagnostics(workspace.read("d." + name)), type);
  INFO(type << " in d." << name);
  REQUIRE(found.size() == 1);
  return with_label(workspace.solutions(name), found.front().label);
}

double distance_to(const std::vector<std::complex<double>>& multipliers, std::complex<double> value) {
  REQUIRE_FALSE(multipliers.empty());
  double nearest = std::abs(multipliers.front() - value);
  for (const auto& mu : multipliers) nearest = std::min(nearest, std::abs(mu - value));
  return nearest;
}

int first_iterations(const std::string& diagnostics) {
  const auto at = diagnostics.find("Iterations   :");
  REQUIRE(at != std::string::npos);
  return std::stoi(diagnostics.substr(at + 14));
}

double difference(const SolutionEntry& a, const SolutionEntry& b) {
  REQUIRE(a.t.size() == b.t.size());
  REQUIRE(a.par.size() == b.par.size());
  const auto relative = [](double x, double y) { return std::abs(x - y) / (1.0 + std::abs(x)); };
  double largest = 0.0;
  std::vector<double> sizes(a.states.front().size(), 0.0);
  for (const std::vector<double>& x : a.states)
    for (std::size_t i = 0; i < x.size(); ++i) sizes.at(i) = std::max(sizes.at(i), std::abs(x[i]));
  for (std::size_t k = 0; k < a.t.size(); ++k) {
    largest = std::max(largest, std::abs(a.t[k] - b.t[k]));
    for (std::size_t i = 0; i < sizes.size(); ++i)
      largest = std::max(largest, std::abs(a.states[k].at(i) - b.states[k].at(i)) / (1.0 + sizes[i]));
  }
  for (std::size_t k = 0; k < a.par.size(); ++k) largest = std::max(largest, relative(a.par[k], b.par[k]));
  return largest;
}

}  // namespace test_support
