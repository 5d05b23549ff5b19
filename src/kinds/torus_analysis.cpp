/// The analysis of branches of invariant tori.
#include <fmt/format.h>

#include "kinds/families.hpp"
#include "kinds/ring_analysis.hpp"
#include "orbit/torus_system.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

namespace {

class TorusAnalysis final : public RingAnalysis {
 public:
  TorusAnalysis(const TorusSystem& system, const OrbitShape& shape) : RingAnalysis(system, shape), system_(system) {}

  const FamilyFacts& facts() const override { return torus_family().facts(); }
  /// Those along the rotation, by their moduli.
  void find_multipliers(const CondensedSystem& condensed, const Orbit& x, FloquetMultipliers& result) override {
    result = torus_multipliers(system_, condensed, x);
  }
  SpecialPoint shrunk(const Orbit& x) const override {
    return {PointType::torus,
            {},
            false,
            fmt::format(
                "the torus has shrunk to a periodic orbit, {}: its torus bifurcation, where the branch of tori ends",
                state_text(system_.system(), x, x.start(0)))};
  }
  std::string tendency(const Orbit&, const PeriodGrowth&, const std::string&) const override { return ""; }

 private:
  const TorusSystem& system_;
};

}  // namespace

std::unique_ptr<BranchAnalysis> TorusSystem::make_analysis(const OrbitShape& shape) const {
  return std::make_unique<TorusAnalysis>(*this, shape);
}

}  // namespace tchat
