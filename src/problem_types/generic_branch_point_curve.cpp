/// Generic branch points of periodic orbits, in three parameters. Conditions and counts: bvp/critical_branch_point.hpp.
#include "bvp/critical_branch_point.hpp"
#include "problem_types/two_parameter_curve.hpp"
#include "special_points/curve_tests.hpp"
#include "start/start_selection.hpp"

namespace tchat::types {

namespace {

class GenericCurve final : public TwoParameterCurve {
 public:
  GenericCurve()
      : TwoParameterCurve(PointType::branch_point, three_parameters, "generic branch points in three parameters") {}

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<CriticalBranchPoint>(defining, start.start.orbit.shape);
  }

 protected:
  void add_codimension_two(TestList& tests) const override {
    tests.push_back(std::make_unique<ResonanceTest>(PointType::resonance_1));
  }
};

}  // namespace

const ProblemType& generic_branch_point_curve() {
  static const GenericCurve type;
  return type;
}

}  // namespace tchat::types
