/// The test functions of equilibria, by what the constants ask for: ILP, ISP, GCHGRZIND, GRSTOP.
#pragma once

#include "run/test_lists.hpp"

namespace tchat {

/// Contact with every monitored event function but `except`.
TestList boundary_equilibrium_tests(const DefiningSystem& system, const RunSettings& settings, int except = 0);

/// |ISP| = 2 all, 3 branch points only, 4 Hopf bifurcations only; negative: stop at the first. Folds by ILP.
void add_equilibrium_bifurcations(TestList& tests, const RunSettings& settings);

/// On a curve of boundary equilibria: Hopf bifurcations by ISP, the eigenvalue 0 by ILP.
void add_boundary_bifurcations(TestList& tests, const DefiningSystem& system, const RunSettings& settings);

}  // namespace tchat
