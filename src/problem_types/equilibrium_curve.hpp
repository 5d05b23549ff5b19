/// What the curves of folds and Hopf bifurcations of equilibria share: the equilibria are those of one parameter, with
/// a second one free and one more condition on their eigenvalues.
#pragma once

#include "problem_type/problem_type.hpp"
#include "run/test_lists.hpp"
#include "special_points/point_type.hpp"

namespace tchat {

class EquilibriumCurve : public ProblemType {
 public:
  EquilibriumCurve(PointType curve, const char* title);

  bool begins_at(int label_type) const override { return label_type == facts().curve; }
  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override;
  TestList tests(const DefiningSystem& defining, const RunSettings& settings) const override;

 protected:
  /// The points of codimension two on the curve.
  virtual void add_codimension_two(TestList& tests) const = 0;
};

}  // namespace tchat
