#include "run/equilibrium_test_lists.hpp"

#include <cstdlib>

#include "constants/settings_type.hpp"
#include "special_points/bifurcation_tests.hpp"
#include "special_points/equilibrium_tests.hpp"

namespace tchat {

TestList boundary_equilibrium_tests(const DefiningSystem& system, const RunSettings& settings) {
  TestList tests;
  for (const int event : settings.segments.front().monitor)
    tests.push_back(std::make_unique<BoundaryEquilibriumTest>(system, event, settings.stop_at_grazing));
  return tests;
}

void add_equilibrium_bifurcations(TestList& tests, const RunSettings& settings) {
  const int kind = std::abs(settings.detect_bifurcations);
  const bool stop = settings.detect_bifurcations < 0;
  if (settings.detect_folds != 0)
    tests.push_back(std::make_unique<FoldTest>(settings.free_parameters.front(), free_problem_parameters(settings),
                                               settings.layout, 1, settings.detect_folds < 0,
                                               PointType::equilibrium_fold));
  if (kind == 2 || kind == 3)
    tests.push_back(std::make_unique<BranchPointTest>(stop, PointType::equilibrium_branch_point));
  if (kind == 2 || kind == 4) tests.push_back(std::make_unique<HopfTest>(stop));
}

}  // namespace tchat
