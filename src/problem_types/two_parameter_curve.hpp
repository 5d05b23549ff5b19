/// What the curves of folds, period doublings and torus bifurcations share: the orbits are those of one parameter, with
/// a second one free and one more condition on their multipliers (5.11-5.22).
#pragma once

#include "problem_type/problem_type.hpp"
#include "run/test_lists.hpp"
#include "special_points/point_type.hpp"

namespace tchat {

class TwoParameterCurve : public ProblemType {
 public:
  TwoParameterCurve(PointType curve, const char* title);

  bool begins_at(int label_type) const override { return label_type == facts().curve; }
  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override;
  TestList tests(const DefiningSystem& defining, const RunSettings& settings) const override;

 protected:
  /// The points of codimension two on the curve.
  virtual void add_codimension_two(TestList& tests) const = 0;
};

}  // namespace tchat
