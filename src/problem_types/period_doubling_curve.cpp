/// Period doublings in two parameters: the multiplier -1 (5.17-5.22).
#include "bvp/critical_multiplier.hpp"
#include "problem_types/two_parameter_curve.hpp"
#include "special_points/curve_tests.hpp"
#include "start/start_selection.hpp"

namespace tchat::types {

namespace {

class PeriodDoublingCurve final : public TwoParameterCurve {
 public:
  PeriodDoublingCurve()
      : TwoParameterCurve(PointType::period_doubling, two_parameters, "period doublings in two parameters") {}

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<CriticalMultiplier>(defining, start.start.orbit.shape, -1);
  }

 protected:
  void add_codimension_two(TestList& tests) const override {
    tests.push_back(std::make_unique<ResonanceTest>(PointType::resonance_2));
  }
};

}  // namespace

const ProblemType& period_doubling_curve() {
  static const PeriodDoublingCurve type;
  return type;
}

}  // namespace tchat::types
