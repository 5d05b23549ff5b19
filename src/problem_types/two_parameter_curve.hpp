/// What the curves of folds, period doublings, torus bifurcations and branch points share: the orbits are those of one
/// parameter, with a second one free and one more condition on their multipliers (5.11-5.22), or a third one and two
/// conditions.
#pragma once

#include "problem_type/problem_type.hpp"
#include "run/test_lists.hpp"
#include "special_points/point_type.hpp"

namespace tchat {

class TwoParameterCurve : public ProblemType {
 public:
  struct Mode {
    int branch_mode;  ///< ISW
    int free_parameters;
  };
  static constexpr Mode two_parameters{2, 2};
  static constexpr Mode three_parameters{3, 3};

  TwoParameterCurve(PointType curve, Mode mode, const char* title);

  bool begins_at(int label_type) const override { return label_type == facts().curve; }
  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override;
  TestList tests(const DefiningSystem& defining, const RunSettings& settings) const override;

 protected:
  /// The points of codimension two on the curve.
  virtual void add_codimension_two(TestList& tests) const = 0;
};

}  // namespace tchat
