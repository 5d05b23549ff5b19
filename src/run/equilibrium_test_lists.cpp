#include "run/equilibrium_test_lists.hpp"

#include <cstdlib>

#include "settings/settings_type.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/equilibrium_curve_tests.hpp"
#include "stability/equilibrium_tests.hpp"

namespace tchat {

namespace {

void add_hopf(TestList& tests, const RunSettings& settings) {
  const int kind = std::abs(settings.detect_bifurcations);
  if (kind == 2 || kind == 4) tests.push_back(std::make_unique<HopfTest>(settings.detect_bifurcations < 0));
}

}  // namespace

TestList boundary_equilibrium_tests(const DefiningSystem& system, const RunSettings& settings, int except) {
  TestList tests;
  for (const int event : settings.segments.front().monitor)
    if (event != except)
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
  add_hopf(tests, settings);
}

void add_boundary_bifurcations(TestList& tests, const DefiningSystem& system, const RunSettings& settings) {
  if (settings.detect_folds != 0) tests.push_back(zero_eigenvalue_test(system));
  add_hopf(tests, settings);
}

}  // namespace tchat
