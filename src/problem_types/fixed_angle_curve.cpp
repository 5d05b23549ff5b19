/// Torus bifurcations of one angle: the pair of multipliers exp(+-i theta) of the start is kept
/// (bvp/critical_pair.hpp).
///
/// Count. N unknowns and N equations of the orbit, as ever, three parameters: N + 3 unknowns. Product one, the cosine
/// of the angle, and pseudo-arclength: N + 3 equations.
#include <fmt/format.h>

#include <cmath>

#include "bvp/critical_pair.hpp"
#include "problem_types/torus_pair.hpp"
#include "problem_types/two_parameter_curve.hpp"
#include "special_points/point_type.hpp"
#include "start/start_selection.hpp"
#include "text/user_error.hpp"

namespace tchat::types {

namespace {

/// The cosine of the start's angle; at a strong resonance its exact value.
double fixed_cosine(const DefiningSystem& defining, const SelectedStart& start) {
  const auto is = [&start](PointType type) {
    const int number = basic_type(start.type);
    return number == static_cast<int>(type);
  };
  if (is(PointType::resonance_1) || is(PointType::resonance_2))
    throw UserError(
        fmt::format("{}: at label {}, a 1:1 or 1:2 resonance, the pair of multipliers is a double one and has no angle "
                    "to keep; start from a label TR, R3 or R4, or one of the torus curve (IRS=TR1)",
                    start.source, start.label));
  if (is(PointType::resonance_3)) return -0.5;
  if (is(PointType::resonance_4)) return 0.0;
  return std::cos(std::arg(pair_at(defining, start)));
}

class FixedAngleCurve final : public TwoParameterCurve {
 public:
  FixedAngleCurve()
      : TwoParameterCurve(PointType::torus, three_parameters,
                          "torus bifurcations of the start's angle in three parameters") {}

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<CriticalPair>(defining, start.start.orbit.shape, pair_at(defining, start),
                                          fixed_cosine(defining, start));
  }

 protected:
  void add_codimension_two(TestList&) const override {}
};

}  // namespace

const ProblemType& fixed_angle_curve() {
  static const FixedAngleCurve type;
  return type;
}

}  // namespace tchat::types
