#include "benchmark/auto_program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace tchat::benchmark {

namespace {

namespace fs = std::filesystem;

/// Runs a program in a folder with its output in the file "output" there. Returns its processor time; throws when it
/// does not end with status 0.
double run_program(const std::vector<std::string>& command, const fs::path& folder) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process could be started");
  if (child == 0) {
    const int output = chdir(folder.c_str()) == 0 ? open("output", O_WRONLY | O_CREAT | O_TRUNC, 0644) : -1;
    if (output < 0) _exit(126);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    setenv("OMP_NUM_THREADS", "1", 1);
    execvp(arguments.front(), arguments.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(fmt::format("{} failed; what it wrote is in {}", command.front(), folder.string()));
  const auto in_seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return in_seconds(usage.ru_utime) + in_seconds(usage.ru_stime);
}

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

fs::path new_folder() {
  std::string name = (fs::temp_directory_path() / "tchat_benchmark_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder could be made: " + name);
  return name;
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

AutoProgram::AutoProgram(int segments, int intervals) : folder_(new_folder()) {
  settings_.segments = segments;
  settings_.intervals = intervals;
  std::ofstream(folder_ / "problem.f90") << auto_source(segments);
  std::vector<std::string> command{"gfortran", "-O2", "-fopenmp", "problem.f90", "-o", "program"};
  for (const auto& entry : fs::directory_iterator(auto_objects()))
    if (entry.path().extension() == ".o") command.push_back(entry.path().string());
  run_program(command, folder_);
}

AutoProgram::~AutoProgram() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

AutoRun AutoProgram::run(int points, bool details) const {
  AutoSettings settings = settings_;
  settings.points = points;
  settings.details = details;
  std::ofstream(folder_ / "fort.2") << auto_constants(settings);
  for (const char* file : {"fort.7", "fort.8", "fort.9"}) fs::remove(folder_ / file);
  AutoRun result;
  result.processor_seconds = run_program({(folder_ / "program").string()}, folder_);
  const int reached = count_points(folder_ / "fort.7");
  if (reached != points) throw std::runtime_error(fmt::format("AUTO stopped at point {} of {}", reached, points));
  result.last = last_solution(folder_ / "fort.8", 4 * settings.segments);
  if (details) result.iterations = count_iterations(folder_ / "fort.9");
  return result;
}

}  // namespace tchat::benchmark
