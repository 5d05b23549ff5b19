/// A strict reader of q-files, written from the description of the format alone; a violation fails the test that reads.
#pragma once

#include <string>
#include <vector>

namespace test_support {

struct SolutionEntry {
  int branch = 0, point = 0, type = 0, label = 0, branch_mode = 0, intervals = 0, collocation = 0, dimension = 0,
      problem_type = 0, problem_parameters = 0;
  std::vector<double> t;
  std::vector<std::vector<double>> states;     ///< for each t, U(1), U(2), ...
  std::vector<int> free_parameters;            ///< ICP
  std::vector<double> parameter_direction;     ///< d PAR(ICP)/ds
  std::vector<std::vector<double>> direction;  ///< dU/ds for each t
  std::vector<double> par;                     ///< without the internal values
  std::vector<double> internal;                ///< kind, segment, index, tau of a UZ point

  double parameter(int k) const { return par.at(static_cast<std::size_t>(k - 1)); }
};

std::vector<SolutionEntry> read_solutions(const std::string& text);

}  // namespace test_support
