// Attractors of fvdp just behind the grazing of its torus, by simulation and by the composite map of the torus, on both
// sections of the dissertation's 3.3, P (2.80) and P' (2.81). Both are computed here: by integration through impacts,
// and from the smooth torus and its grazing point alone.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "end_to_end/workspace.hpp"
#include "simulate/sweep_file.hpp"

using namespace test_support;
using namespace tchat;

namespace {

constexpr const char* over = " --over mu=2.4051:2.4047:3";  // mu* = 2.4053817

SweepTable sweep(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("sweep fvdp" + std::string(over) + " -q -o swept --fresh " + arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
  return read_sweep_file(workspace.file("swept.sweep"));
}

/// States of one value, the deepest first; they are told apart by x1.
std::vector<std::vector<double>> states_of(const SweepTable& table, int index) {
  std::vector<std::vector<double>> states;
  for (std::size_t row = 0; row < table.rows(); ++row)
    if ((*table.column("index"))[row] == index)
      states.push_back({(*table.column("x1"))[row], (*table.column("x2"))[row], (*table.column("x3"))[row],
                        (*table.column("penetration"))[row]});
  std::sort(states.begin(), states.end(), std::greater<>());
  return states;
}

/// The largest difference of states, and that of penetrations relative to the size of the deepest one.
void compare(const SweepTable& simulated, const SweepTable& mapped, std::size_t states, double state_margin,
             double penetration_margin) {
  for (int index = 0; index < 3; ++index) {
    const auto a = states_of(simulated, index), b = states_of(mapped, index);
    INFO("value " << index);
    REQUIRE(a.size() == states);
    REQUIRE(b.size() == states);
    for (std::size_t k = 0; k < states; ++k)
      for (std::size_t i = 0; i < 3; ++i) CHECK(b[k][i] == Approx(a[k][i]).margin(state_margin).epsilon(0.0));
    const auto deepest = [](const auto& list) {
      double largest = -1.0;
      for (const auto& state : list)
        if (std::isfinite(state[3])) largest = std::max(largest, state[3]);
      return largest;
    };
    CHECK(deepest(a) > 3e-4);  // in contact
    CHECK(deepest(b) == Approx(deepest(a)).epsilon(penetration_margin));
  }
}

void make_torus(const Workspace& workspace, const std::string& arguments) {
  std::filesystem::copy_file(FVDP_LIBRARY, workspace.file("fvdp.so"));
  const Outcome outcome =
      workspace.tchat("simulate fvdp --transient-events 500 --rows 0 --tolerance 1e-11 -o torus -q " + arguments);
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
}

}  // namespace

// The orbit with one impact in two revolutions: penetration 3.2e-4, so y = sqrt(penetration) = 0.018. Order 3/2 leaves
// out y^4 = 1e-7, and P_smooth of first order the square of the distance from the torus, y^2 times a few: also 1e-7.
// A return multiplies errors along the curve, which it stretches by f' = 5 (Fig. 3.9): states agree to a few 1e-5.
// Penetration is flat there: 2 (x3 - x3*) d(x3) / 2 = 0.06 x 1e-5 of 3e-4, a few thousandths.
TEST_CASE("fvdp behind the grazing of its torus, on P: simulation and composite map") {
  const Workspace workspace;
  make_torus(workspace, "--events 3000");
  const SweepTable simulated = sweep(workspace, "--penetration 1");
  const SweepTable mapped = sweep(workspace, "--map torus.events --section 2 --wall 1");
  compare(simulated, mapped, 2, 1e-4, 5e-3);
  for (std::size_t row = 0; row < mapped.rows(); ++row) {
    CHECK(mapped.kinds[row] == AttractorKind::periodic);
    CHECK((*mapped.column("impacts"))[row] == 1.0);
  }
  // The square root alone leaves out y^2: ten times as far and more, and still this orbit.
  const SweepTable lowest = sweep(workspace, "--map torus.events --section 2 --wall 1 --order 1/2");
  const double exact = states_of(simulated, 1)[0][2];
  CHECK(std::abs(states_of(lowest, 1)[0][2] - exact) > 10.0 * std::abs(states_of(mapped, 1)[0][2] - exact));
}

// Three returns to P' in the same orbit. The state next to the wall is that of the flow that comes in: the impact,
// which is before P' there, changes x2 by 4.5 y = 0.08 (3.32).
TEST_CASE("fvdp behind the grazing of its torus, on P': states of the incoming flow") {
  const Workspace workspace;
  make_torus(workspace, "--signature 1,3,2;1,4,3 --events 2400");
  const SweepTable simulated = sweep(workspace, "--section 3 --penetration 1");
  const SweepTable mapped = sweep(workspace, "--map torus.events --section 3 --wall 1");
  compare(simulated, mapped, 3, 3e-4, 1e-2);
  const SweepTable outgoing = sweep(workspace, "--section 3");
  double changed = 0.0;
  for (std::size_t row = 0; row < outgoing.rows(); ++row)
    changed = std::max(changed, std::abs((*outgoing.column("x2"))[row] - (*simulated.column("x2"))[row]));
  CHECK(outgoing.rows() == simulated.rows());
  CHECK(changed == Approx(4.5089 * std::sqrt(3.2e-4)).epsilon(0.2));
}
