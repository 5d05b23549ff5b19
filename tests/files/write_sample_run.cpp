// Without arguments: writes the files p.sample, q.sample, d.sample of a made-up run into the current folder, and what
// they hold to expected.txt, one `kind: values` line for each fact, for auto_readers.py to compare.
// With the name of a q-file: prints all that our reader finds in it.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "files/diagnostics_file.hpp"
#include "files/point_file.hpp"
#include "files/run_files.hpp"
#include "files/sample_orbits.hpp"
#include "files/solution_file.hpp"
#include "files/solution_file_reader.hpp"
#include "files/solution_tables.hpp"

using namespace tchat;

namespace {

RunSettings settings() {
  RunSettings s;
  s.dimension = 4;
  s.free_parameters = {1, 61, 62};
  s.segments.resize(2);
  s.segments[0].index = {1, 3, 2};
  s.parameter_weights = {{61, 0.0}};
  s.user_values = {{1, 2.5, false}, {1, 3.0, false}, {2, 4.0, true}};
  s.stop_rules = {{"PD", 1}};
  s.parameter_min = -1.7976931348623157e308;
  s.parameter_max = 1e300;
  s.mesh_intervals = 6;
  s.collocation_points = 3;
  return s;
}

struct Sample {
  PointLine line;
  LabelledSolution orbit;
  std::vector<std::complex<double>> multipliers;
};

/// 12 points; some labelled, the first ones stable.
std::vector<Sample> samples(std::size_t columns, int first_label, int first_type) {
  std::vector<Sample> all;
  const int types[] = {first_type, 0, 0, -4, 0, 7, 0, 4, 0, -4, 0, 9};
  int label = first_label;
  for (int k = 1; k <= 12; ++k) {
    Sample sample;
    PointLine& line = sample.line;
    line = {2, k, k < 6, types[k - 1], types[k - 1] != 0 ? label++ : 0, {}};
    for (std::size_t c = 0; c < columns; ++c)
      line.values.push_back(c == 2 ? 1e-150 : 0.1 * k - 1.5 * static_cast<double>(c));
    if (k == 4) line.kind = {UserPointKind::contact, 2, 1, 0.5};
    if (k == 10) line.kind = {UserPointKind::user_value, 0, 1, 0.0};
    sample.orbit = test_support::sample_orbit(4, 2, 6, 3);
    sample.orbit.point = k;
    sample.orbit.type = line.type;
    sample.orbit.label = line.label;
    sample.orbit.kind = line.kind;
    sample.orbit.parameters[0] = 0.1 * k;
    if (k == 8) {  // a label without direction
      sample.orbit.state_direction.resize(0, 0);
      sample.orbit.parameter_direction.clear();
    }
    if (k == 6 || k == 10) {  // these have all digits in the file, of which AUTO's writer keeps ten
      sample.orbit.own_mesh = {0.0, 0.3, 1.0, 0.0, 0.1, 0.2, 0.7, 1.0};
      for (Eigen::MatrixXd* states : {&sample.orbit.states, &sample.orbit.state_direction})
        *states = (256.0 * *states).array().round() / 256.0;
      for (double& tau : sample.orbit.tau) tau = std::round(256.0 * tau) / 256.0;
    }
    sample.multipliers = {{0.1 * k, 0.5}, {0.1 * k, -0.5}, {-3.0 * k, 0.0}, {1e-12, 0.0}};
    all.push_back(sample);
  }
  return all;
}

std::string label_block(const Sample& sample, const std::vector<PointColumn>& columns) {
  std::string block = format_newton_history(sample.line.branch, sample.line.point, {{0, 1.0, 2.0, 0.0, 0.0}});
  block += format_diagnostics_point(sample.line, columns) + format_multipliers(sample.multipliers);
  block += format_test_functions({{"period doubling", -1.0, true}});
  block += format_note(sample.line.branch, sample.line.point, "Multiplier 0 is a figure of accuracy");
  return block + format_bar();
}

std::string ordinary_block(const Sample& sample, const std::vector<PointColumn>& columns) {
  std::string block;
  append_short_point(block, sample.line, format_short_heading(columns));
  append_short_multipliers(block, sample.multipliers, false);
  append_short_tests(block, std::vector<double>{-1.0});
  append_iterations(block, sample.line.branch, sample.line.point, 2);
  append_next_step(block, sample.line.branch, sample.line.point, 0.01);
  return block;
}

std::string joined(const std::vector<double>& values) { return fmt::format("{}", fmt::join(values, " ")); }

void write_expected(std::FILE* expected, const Sample& sample) {
  const PointLine& line = sample.line;
  fmt::print(expected, "point: {} {} {} {} {}\n", line.branch, line.stable ? -line.point : line.point, line.type,
             line.label, joined(line.values));
  std::vector<double> multipliers;
  for (const auto& mu : sample.multipliers) multipliers.insert(multipliers.end(), {mu.real(), mu.imag()});
  fmt::print(expected, "multipliers: {} {} {}\n", line.point, line.label, joined(multipliers));
  if (line.label == 0) return;
  const LabelledSolution& orbit = sample.orbit;
  fmt::print(expected, "solution: {} {} {} {} {} {}\n", orbit.branch, orbit.point, orbit.type, orbit.label,
             orbit.mesh_intervals, orbit.collocation_points);
  fmt::print(expected, "parameters: {}\n", joined(orbit.parameters));
  fmt::print(expected, "internal: {} {} {} {}{}\n", orbit.kind.kind, orbit.kind.segment, orbit.kind.index,
             orbit.kind.tau, orbit.own_mesh.empty() ? "" : fmt::format(" 8 2 8 0 {}", joined(orbit.own_mesh)));
  fmt::print(expected, "rates: {}\n", joined(orbit.parameter_direction));
  for (Eigen::Index p = 0; p < orbit.states.cols(); ++p) {
    const std::vector<double> states(orbit.states.col(p).begin(), orbit.states.col(p).end());
    fmt::print(expected, "states: {} {}\n", orbit.tau[static_cast<std::size_t>(p)], joined(states));
  }
}

void write_section(RunFiles& files, std::FILE* expected, const PointFileHeader& header, int first_label,
                   int first_type) {
  const auto columns = point_columns(header.settings, header.names);
  files.add_points(format_point_header(header, columns));
  fmt::print(expected, "section:\n");
  for (const PointColumn& column : columns) fmt::print(expected, "column: {}\n", column.name);
  for (const Sample& sample : samples(columns.size(), first_label, first_type)) {
    files.add_points(format_point(sample.line));
    if (sample.line.label > 0) files.add_solution(format_solution(sample.orbit));
    files.add_diagnostics(sample.line.label > 0 ? label_block(sample, columns) : ordinary_block(sample, columns));
    write_expected(expected, sample);
  }
}

int print_solutions(const std::string& path) {
  const SolutionFile file = read_solution_file(path);
  fmt::print("{} {}\n{}", file.last_branch, file.last_label, format_label_table(file));
  for (const LabelledSolution& solution : file.solutions) {
    fmt::print("{}{}\n", format_orbit_table(solution, "q"), fmt::join(solution.parameter_direction, " "));
    const auto& direction = solution.state_direction;
    fmt::print("{}\n", fmt::join(direction.data(), direction.data() + direction.size(), " "));
  }
  return 0;
}

int write_sample() {
  std::FILE* expected = std::fopen("expected.txt", "w");
  if (expected == nullptr) return 1;
  PointFileHeader header{settings(), {1, 61, 62}, {{"x1", "x2", "y1", "y2"}, {"alpha", "omega"}, {"energy"}}, 0};
  RunFiles files("sample");
  files.open("constants\n");
  write_section(files, expected, header, 1, 9);
  header.curve_type = 5;
  header.settings.branch_mode = 2;
  header.settings.free_parameters = {1, 2, 61, 62};
  write_section(files, expected, header, 100, 0);
  files.finish();
  std::fclose(expected);
  return 0;
}

}  // namespace

int main(int count, char** arguments) { return count > 1 ? print_solutions(arguments[1]) : write_sample(); }
