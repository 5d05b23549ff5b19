#include "benchmark/auto_program.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace tchat::benchmark {

namespace {

namespace fs = std::filesystem;

/// Reads AUTO's solution file (a header of 16 or more integers; rows of tau and states; parameters last) to its end.
AutoSolution last_solution(const fs::path& file, int states) {
  std::ifstream in(file);
  AutoSolution last;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::vector<int> header;
    for (int value = 0; words >> value;) header.push_back(value);
    if (header.size() < 12) throw std::runtime_error("AUTO's solution file has an unexpected header: " + line);
    const int length = header[8];
    double tau = 0.0;
    last.start.assign(static_cast<std::size_t>(states), 0.0);
    std::streampos body = in.tellg();
    in >> tau;
    for (double& value : last.start) in >> value;
    in.seekg(body);
    // The parameters are the last lines of the body, seven to a line; alpha is the first of them.
    const int parameter_lines = (header[11] + 6) / 7;
    for (int i = 0; i < length && std::getline(in, line); ++i)
      if (i == length - parameter_lines) last.alpha = std::strtod(line.c_str(), nullptr);
  }
  if (last.start.empty()) throw std::runtime_error("AUTO stored no solution");
  return last;
}

/// The number of points in AUTO's point file: the second column of its last line counts them.
int count_points(const fs::path& file) {
  std::ifstream in(file);
  int points = 0;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    int branch = 0;
    int point = 0;
    if (words >> branch >> point && branch != 0) points = std::abs(point);
  }
  return points;
}

/// The Newton iterations in AUTO's diagnostics file: lines "branch point iteration ...", iteration 0 the prediction.
int count_iterations(const fs::path& file) {
  std::ifstream in(file);
  int iterations = 0;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    int branch = 0;
    int point = 0;
    int iteration = 0;
    double parameter = 0.0;
    if (words >> branch >> point >> iteration >> parameter && branch > 0 && point > 1 && iteration > 0) ++iterations;
  }
  return iterations;
}

}  // namespace

fs::path auto_objects() {
  if (const char* folder = std::getenv("AUTO_DIR"))
    if (fs::exists(fs::path(folder) / "lib" / "main.o")) return fs::path(folder) / "lib";
  FILE* pipe = popen("dpkg -L auto-07p 2>/dev/null", "r");
  if (pipe == nullptr) return {};
  fs::path found;
  std::array<char, 1024> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), pipe) != nullptr) {
    std::string name = line.data();
    while (!name.empty() && name.back() == '\n') name.pop_back();
    if (name.ends_with("/lib/main.o")) found = fs::path(name).parent_path();
  }
  pclose(pipe);
  return found;
}

AutoProgram::AutoProgram(const Orbit& start) : shape_(start.shape) {
  const bool chain = shape_.dimension > 4;
  const fs::path& folder = folder_.path();
  std::ofstream(folder / "problem.f90") << (chain ? auto_chain_source(shape_.dimension, shape_.intervals)
                                                  : auto_source(shape_.segments));
  if (chain) std::ofstream(folder / "start") << auto_chain_start(start);
  std::vector<std::string> command{"gfortran", "-O2", "-fopenmp", "problem.f90", "-o", "program"};
  for (const auto& entry : fs::directory_iterator(auto_objects()))
    if (entry.path().extension() == ".o") command.push_back(entry.path().string());
  run_child(command, folder);
}

AutoRun AutoProgram::run(const AutoRequest& request) const {
  const fs::path& folder = folder_.path();
  std::ofstream(folder / "fort.2") << auto_constants(shape_, request);
  for (const char* file : {"fort.7", "fort.8", "fort.9"}) fs::remove(folder / file);
  AutoRun result;
  result.processor_seconds = run_child({(folder / "program").string()}, folder).processor;
  const int reached = count_points(folder / "fort.7");
  if (reached != request.points)
    throw std::runtime_error(fmt::format("AUTO stopped at point {} of {}", reached, request.points));
  result.last = last_solution(folder / "fort.8", shape_.dimension * shape_.segments);
  if (request.diagnostics > 0) result.iterations = count_iterations(folder / "fort.9");
  return result;
}

}  // namespace tchat::benchmark
