#include "benchmark/compiled_problem.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <map>
#include <memory>

#include "benchmark/child_process.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"

namespace tchat::benchmark {

namespace {

struct CompiledProblem {
  explicit CompiledProblem(const std::string& source) {
    const std::string file = folder.path() / "problem.cpp";
    std::ofstream(file) << source;
    library = std::make_unique<ProblemLibrary>(resolve_plugin(file));
  }

  ScratchFolder folder;
  std::unique_ptr<ProblemLibrary> library;
};

using Problems = std::map<std::string, std::unique_ptr<CompiledProblem>>;  // by source

Problems& problems() {
  static Problems all;
  return all;
}

}  // namespace

CompiledProblems::CompiledProblems() { problems().clear(); }
CompiledProblems::~CompiledProblems() { problems().clear(); }

const HybridSystem& compiled_problem(const std::string& source) {
  std::unique_ptr<CompiledProblem>& problem = problems()[source];
  if (problem == nullptr) problem = std::make_unique<CompiledProblem>(source);
  return problem->library->system();
}

const HybridSystem& problem_of_repository(const std::string& name) {
  std::ifstream file(fmt::format("{0}/{1}/{1}.cpp", PROBLEMS_FOLDER, name));
  return compiled_problem({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
}

}  // namespace tchat::benchmark
