/// Folds of periodic orbits in two parameters: the multiplier +1 (5.11-5.16).
#include "bvp/critical_multiplier.hpp"
#include "problem_types/two_parameter_curve.hpp"
#include "special_points/curve_tests.hpp"
#include "start/start_selection.hpp"

namespace tchat::types {

namespace {

class FoldCurve final : public TwoParameterCurve {
 public:
  FoldCurve() : TwoParameterCurve(PointType::fold, two_parameters, "folds of periodic orbits in two parameters") {}

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<CriticalMultiplier>(defining, start.start.orbit.shape, 1);
  }

 protected:
  void add_codimension_two(TestList& tests) const override {
    tests.push_back(std::make_unique<CuspTest>());
    tests.push_back(std::make_unique<ResonanceTest>(PointType::resonance_1));
  }
};

}  // namespace

const ProblemType& fold_curve() {
  static const FoldCurve type;
  return type;
}

}  // namespace tchat::types
