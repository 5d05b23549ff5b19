/// The analysis of branches of equilibria.
#include "continuation/branch_analysis.hpp"
#include "kinds/families.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/equilibrium_system.hpp"
#include "stability/equilibrium_tests.hpp"

namespace tchat {

namespace {

class EquilibriumAnalysis final : public BranchAnalysis {
 public:
  explicit EquilibriumAnalysis(const EquilibriumSystem& system) : system_(system) {}

  const FamilyFacts& facts() const override { return equilibrium_family().facts(); }
  void find_multipliers(const CondensedSystem&, const Orbit& x, FloquetMultipliers& result) override {
    result = equilibrium_eigenvalues(system_, x);
  }
  std::string start_advice(const Orbit&) const override {
    return "There may be no equilibrium near the start with these parameters; a better start or a larger ITNW may "
           "help.";
  }

 private:
  const EquilibriumSystem& system_;
};

}  // namespace

std::unique_ptr<BranchAnalysis> EquilibriumSystem::make_analysis(const OrbitShape&) const {
  return std::make_unique<EquilibriumAnalysis>(*this);
}

}  // namespace tchat
