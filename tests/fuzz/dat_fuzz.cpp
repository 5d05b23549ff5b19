// Starting data; the first two bytes of the text choose the numbers of states and of segments.

#include <cmath>

#include "files/dat_file.hpp"
#include "fuzz_target.hpp"
#include "model/parameter_vector.hpp"

using namespace tchat;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const int dimension = 1 + data[0] % 4;
  const int segments = 1 + data[1] % 3;
  DatFile file;
  const auto read = [&] {
    file = parse_dat_file(fuzz::text_of(data + 2, size - 2), fuzz::source, dimension, segments);
  };
  if (!fuzz::accepts(read)) return 0;
  fuzz::require(file.tau.size() >= 2 && file.tau.front() == 0.0 && file.tau.back() == 1.0, "tau from 0 to 1");
  for (std::size_t k = 1; k < file.tau.size(); ++k) fuzz::require(file.tau[k] > file.tau[k - 1], "tau rises");
  fuzz::require(std::isfinite(file.span) && file.span > 0.0, "a span of time");
  fuzz::require(file.states.rows() == dimension * segments, "a row for each state");
  fuzz::require(file.states.cols() == static_cast<Eigen::Index>(file.tau.size()), "a column for each time");
  fuzz::require(file.states.allFinite(), "finite states");
  for (const auto& [index, value] : file.parameters)
    fuzz::require(index >= 1 && index <= most_parameters + max_segments && std::isfinite(value), "a parameter's value");
  for (const auto& [name, value] : file.named_parameters)
    fuzz::require(!name.empty() && std::isfinite(value), "a named parameter's value");
  return 0;
}
