/// Folds of equilibria in two parameters (bvp/equilibrium_fold.hpp).
#include "bvp/equilibrium_fold.hpp"
#include "problem_types/equilibrium_curve.hpp"
#include "special_points/equilibrium_curve_tests.hpp"
#include "start/start_selection.hpp"

namespace tchat::types {

namespace {

class EquilibriumFoldCurve final : public EquilibriumCurve {
 public:
  EquilibriumFoldCurve() : EquilibriumCurve(PointType::equilibrium_fold, "folds of equilibria in two parameters") {}

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<EquilibriumFold>(defining, start.start.orbit.shape);
  }

 protected:
  void add_codimension_two(TestList& tests) const override {
    tests.push_back(std::make_unique<EquilibriumCuspTest>());
    tests.push_back(std::make_unique<DoubleZeroTest>());
    tests.push_back(std::make_unique<FoldHopfTest>());
  }
};

}  // namespace

const ProblemType& equilibrium_fold_curve() {
  static const EquilibriumFoldCurve type;
  return type;
}

}  // namespace tchat::types
