#include "stability/branching.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

using Vector = Eigen::VectorXd;

Vector with_parameter(const Vector& v, double parameter) {
  Vector result(v.size() + 1);
  result << v, parameter;
  return result;
}

/// The derivatives of g at a point.
struct ReducedEquation {
  double y = 0.0, s = 0.0;  // first ones
  Coefficient yy, ys, ss;

  double square_of_rate() const { return ys.value * ys.value - yy.value * ss.value; }
};

class Reduction {
 public:
  /// The equations are linearised.
  explicit Reduction(SingularEquations& equations)
      : equations_(equations), w_(equations.left_vector()), v_(with_parameter(equations.right_vector(), 0.0)) {
    u_ = with_parameter(equations_.solve(-equations_.by_parameter(), g_.s), 1.0);
    g_.y = equations_.critical();
    along_v_ = equations_.second(v_, v_);
    g_.yy = derivative(along_v_);
    g_.ys = derivative(equations_.second(v_, u_));
    g_.ss = derivative(equations_.second(u_, u_));
  }

  const ReducedEquation& g() const { return g_; }

  /// Newton's step to the centre of the bifurcation, with the parameter.
  Vector step() const {
    double zeta = 0.0;
    const Vector correction = with_parameter(equations_.solve(-equations_.residual(), zeta), 0.0);
    Eigen::Matrix2d hessian;
    hessian << g_.yy.value, g_.ys.value, g_.ys.value, g_.ss.value;
    const Eigen::Vector2d change = -hessian.inverse() * Eigen::Vector2d(g_.y, g_.s);
    return correction + change(0) * v_ + change(1) * u_;
  }

  BranchingForm form() const {
    const double rate = std::sqrt(g_.square_of_rate());
    const double error = std::abs(g_.ys.value) * g_.ys.uncertainty +
                         0.5 * (std::abs(g_.yy.value) * g_.ss.uncertainty + std::abs(g_.ss.value) * g_.yy.uncertainty);
    double zeta = 0.0;
    const Vector curvature = equations_.solve(-along_v_, zeta);
    const Coefficient cubic = derivative(equations_.third(equations_.right_vector()));
    const Coefficient bent = derivative(3.0 * equations_.second(v_, with_parameter(curvature, 0.0)));
    return {{0.5 * g_.yy.value, 0.5 * g_.yy.uncertainty},
            {rate, error / rate},
            {(cubic.value + bent.value) / 6.0, (cubic.uncertainty + bent.uncertainty) / 6.0}};
  }

 private:
  Coefficient derivative(const Vector& rows) const {
    return {-w_.dot(rows), equations_.error() * w_.cwiseAbs().dot(rows.cwiseAbs())};
  }

  SingularEquations& equations_;
  Vector w_, v_, u_;
  Vector along_v_;
  ReducedEquation g_;
};

/// Of a step with the parameter, whose change is relative to its own size.
double relative_length(const Vector& step, double size, double parameter) {
  const Eigen::Index n = step.size() - 1;
  return std::max(step.head(n).lpNorm<Eigen::Infinity>() / size, std::abs(step(n)) / (1.0 + std::abs(parameter)));
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
    if (!equations.linearise(x)) return std::nullopt;
    const Reduction reduction(equations);
    if (!(reduction.g().square_of_rate() > 0.0)) return std::nullopt;
    if (before) return with_errors_of_place(reduction.form(), *before, rounding * size);
    const Vector step = reduction.step();
    const double length = relative_length(step, size, equations.parameter(x));
    if (!(length < farthest)) return std::nullopt;
    const bool is_rounding = last < near && length > 0.5 * last;  // that the equations may amplify
    if (length < arrived || is_rounding) before = reduction.form();
    last = length;
    equations.move(x, step);
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
