#include "benchmark/chain_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "benchmark/branch_walk.hpp"

namespace tchat::benchmark {

namespace {

std::string data_text(const Orbit& x) {
  std::string text;
  for (int k = 0; k < 5; ++k) text += fmt::format("# PAR({}) = {:.17g}\n", k + 1, x.par(k));
  for (int s = 0; s < x.shape.segments; ++s)
    text += fmt::format("# PAR({}) = {:.17g}\n", ParameterLayout().first_duration() + s, x.duration(s));
  for (int k = 0; k < x.shape.nodes(); ++k) {
    text += fmt::format("{:.17g}", x.tau(k));
    for (int s = 0; s < x.shape.segments; ++s)
      for (int i = 0; i < x.shape.dimension; ++i) text += fmt::format(" {:.17g}", x.node(s, k)[i]);
    text += '\n';
  }
  return text;
}

std::string constants_text(const OrbitShape& shape, int points) {
  const std::vector<int> ones(static_cast<std::size_t>(shape.segments), 1);
  const std::string list = fmt::format("[{}]", fmt::join(ones, ", "));
  return fmt::format("NDIM = {}, IPS = 180, IRS = 0\nICP = [1, {}]\n", shape.dimension,
                     ParameterLayout().first_duration()) +
         fmt::format("NTST = {}, NCOL = {}, IAD = 3, NMX = {}\n", shape.intervals, shape.collocation, points) +
         fmt::format("DS = {}, DSMAX = {}\n", step_length(shape.segments), 4 * step_length(shape.segments)) +
         fmt::format("GCFIND = {0}, GCHIND = {0}, GCGIND = {0}, GCSEGTYP = {0}\n", list);
}

/// "" where there is no such file.
std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

std::string chain_source(int n) {
  return fmt::format("#include \"{}\"\nusing Chain = tchat::benchmark::OscillatorChain<{}>;\nTCHAT_PROBLEM(Chain)\n",
                     OSCILLATOR_CHAIN_HEADER, (n - 2) / 2);
}

void write_chain_files(const std::filesystem::path& folder, const Orbit& x, int points) {
  const std::string source = chain_source(x.shape.dimension);
  // A source that is written again is compiled again.
  if (contents(folder / "chain.cpp") != source) std::ofstream(folder / "chain.cpp") << source;
  std::ofstream(folder / "gc.chain") << constants_text(x.shape, points);
  std::ofstream(folder / "chain.dat") << data_text(x);
}

std::string tchat_executable() {
  const char* const named = std::getenv("TCHAT_EXECUTABLE");
  return named != nullptr ? named : TCHAT_EXECUTABLE;
}

}  // namespace tchat::benchmark
