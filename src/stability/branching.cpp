#include "stability/branching.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

/// The change of y and p to the centre of the bifurcation, where g_y and g_s vanish.
Eigen::Vector2d change_to_centre(const ReducedEquation& g) {
  Eigen::Matrix2d hessian;
  hessian << g.yy.value, g.ys.value, g.ys.value, g.ss.value;
  return -hessian.inverse() * Eigen::Vector2d(g.y, g.s);
}

BranchingForm form_of(const ReducedEquation& g, const Coefficient& cubic) {
  const double rate = std::sqrt(g.square_of_rate());
  const double error = std::abs(g.ys.value) * g.ys.uncertainty +
                       0.5 * (std::abs(g.yy.value) * g.ss.uncertainty + std::abs(g.ss.value) * g.yy.uncertainty);
  return {{0.5 * g.yy.value, 0.5 * g.yy.uncertainty}, {rate, error / rate}, cubic};
}

/// `before` is that of a point one step before, `place` the rounding of states.
std::optional<BranchingForm> with_errors_of_place(BranchingForm form, const BranchingForm& before, double place) {
  form.a.uncertainty += std::abs(form.a.value - before.a.value) + 3.0 * std::abs(form.c.value) * place;
  form.b.uncertainty += std::abs(form.b.value - before.b.value);
  form.c.uncertainty += std::abs(form.c.value - before.c.value);
  for (const Coefficient& k : {form.a, form.b, form.c})
    if (!std::isfinite(k.value) || !std::isfinite(k.uncertainty)) return std::nullopt;
  return form;
}

}  // namespace

std::optional<BranchingForm> branching_form(SingularEquations& equations, Orbit& x) {
  constexpr int most_steps = 8;
  constexpr double arrived = 1e-10, near = 1e-6, farthest = 0.1, rounding = 1e-13;
  const double size = 1.0 + x.states.cwiseAbs().maxCoeff();
  std::optional<BranchingForm> before;
  double last = farthest;
  for (int k = 0; k < most_steps; ++k) {
    const std::optional<ReducedEquation> g = equations.reduce(x);
    if (!g || !(g->square_of_rate() > 0.0)) return std::nullopt;
    if (before) return with_errors_of_place(form_of(*g, equations.cubic()), *before, rounding * size);
    const Eigen::Vector2d change = change_to_centre(*g);
    const double length = std::max(equations.find_step(change(0), change(1)) / size,
                                   std::abs(change(1)) / (1.0 + std::abs(equations.parameter(x))));
    if (!(length < farthest)) return std::nullopt;
    const bool is_rounding = last < near && length > 0.5 * last;  // that the equations may amplify
    if (length < arrived || is_rounding) before = form_of(*g, equations.cubic());
    last = length;
    equations.move(x);
  }
  return std::nullopt;
}

Branching branching_of(const BranchingForm& form) {
  constexpr double share = 1e-3;
  if (!(form.b.value > form.b.uncertainty)) return Branching::undecided;
  if (std::abs(form.a.value) > form.a.uncertainty) return Branching::transcritical;
  const bool is_cubic = std::abs(form.c.value) > form.c.uncertainty;
  return is_cubic && form.a.uncertainty < share * std::sqrt(std::abs(form.c.value)) ? Branching::pitchfork
                                                                                    : Branching::undecided;
}

}  // namespace tchat
