/// Hopf bifurcations of equilibria in two parameters (bvp/hopf_pair.hpp).
#include "bvp/hopf_pair.hpp"
#include "problem_types/equilibrium_curve.hpp"
#include "special_points/equilibrium_curve_tests.hpp"
#include "start/start_selection.hpp"

namespace tchat::types {

namespace {

class HopfCurve final : public EquilibriumCurve {
 public:
  HopfCurve() : EquilibriumCurve(PointType::hopf, "Hopf bifurcations of equilibria in two parameters") {}

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<HopfPair>(defining, start.start.orbit.shape);
  }

 protected:
  void add_codimension_two(TestList& tests) const override {
    tests.push_back(std::make_unique<ZeroFrequencyTest>());
    tests.push_back(std::make_unique<MirroredFrequencyTest>());
    tests.push_back(std::make_unique<PassedFrequencyTest>());
    tests.push_back(std::make_unique<HopfFoldTest>());
    tests.push_back(std::make_unique<BautinTest>());
  }
};

}  // namespace

const ProblemType& hopf_curve() {
  static const HopfCurve type;
  return type;
}

}  // namespace tchat::types
