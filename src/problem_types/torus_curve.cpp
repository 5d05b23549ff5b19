/// Torus bifurcations in two parameters: a pair of multipliers of product one (bvp/critical_pair.hpp).
#include <array>

#include "bvp/bordered_problem.hpp"
#include "bvp/critical_pair.hpp"
#include "problem_types/torus_pair.hpp"
#include "problem_types/two_parameter_curve.hpp"
#include "special_points/curve_tests.hpp"
#include "start/start_selection.hpp"

namespace tchat::types {

namespace {

class TorusCurve final : public TwoParameterCurve {
 public:
  TorusCurve() : TwoParameterCurve(PointType::torus, two_parameters, "torus bifurcations in two parameters") {}

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<CriticalPair>(defining, start.start.orbit.shape, pair_at(defining, start));
  }

 protected:
  void add_codimension_two(TestList& tests) const override {
    constexpr std::array resonances{PointType::resonance_1, PointType::resonance_2, PointType::resonance_3,
                                    PointType::resonance_4};
    for (const PointType type : resonances) tests.push_back(std::make_unique<AngleTest>(type));
    tests.push_back(std::make_unique<MirroredResonanceTest>());
    tests.push_back(std::make_unique<PassedResonanceTest>());
  }
};

}  // namespace

const ProblemType& torus_curve() {
  static const TorusCurve type;
  return type;
}

}  // namespace tchat::types
