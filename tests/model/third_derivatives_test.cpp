// Third derivatives of fields, event functions and jumps: against differences with fifty digits, and by hand.
#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"

#include <tchat/problem.hpp>

#pragma push_macro("TCHAT_PROBLEM")
#undef TCHAT_PROBLEM
#define TCHAT_PROBLEM(PROBLEM) static_assert(PROBLEM::dimension > 1);
#include "../../problems/compass/compass.cpp"
#include "../../problems/mems/mems.cpp"
#include "../../problems/microactuator/microactuator.cpp"
#pragma pop_macro("TCHAT_PROBLEM")

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Wide = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

template <class Problem>
std::vector<Wide> wide_value(FunctionKind kind, int index, const std::vector<Wide>& x, const std::vector<Wide>& par) {
  const Problem problem;
  std::vector<Wide> out(kind == FunctionKind::event ? 1 : x.size());
  if (kind == FunctionKind::field) problem.field(index, x.data(), par.data(), out.data());
  if (kind == FunctionKind::event) out[0] = problem.event(index, x.data(), par.data());
  if (kind == FunctionKind::jump) problem.jump(index, x.data(), par.data(), out.data());
  return out;
}

/// The coefficient of e^m in F(sum of the states e^k), by differences over e_i = +-h.
template <class Problem>
VectorXd wide_coefficient(FunctionKind kind, int index, const MatrixXd& states, const VectorXd& par, int m) {
  const Wide h("1e-10");
  const std::vector<Wide> parameters(par.begin(), par.end());
  std::vector<Wide> sum;
  for (int signs = 0; signs < 8; ++signs) {
    if ((signs & ~m) != 0) continue;
    std::vector<Wide> x(static_cast<std::size_t>(states.rows()));
    for (int k = 0; k < 8; ++k) {
      if ((k & ~m) != 0) continue;
      Wide factor = 1;
      for (int bit = 1; bit < 8; bit *= 2)
        if ((k & bit) != 0) factor *= (signs & bit) != 0 ? Wide(-h) : h;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += factor * states(static_cast<Eigen::Index>(i), k);
    }
    const std::vector<Wide> value = wide_value<Problem>(kind, index, x, parameters);
    sum.resize(value.size());
    Wide weight = 1;
    for (int bit = 1; bit < 8; bit *= 2)
      if ((m & bit) != 0) weight *= Wide((signs & bit) != 0 ? -1 : 1) / (2 * h);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * value[i];
  }
  VectorXd result(static_cast<Eigen::Index>(sum.size()));
  for (std::size_t i = 0; i < sum.size(); ++i) result(static_cast<Eigen::Index>(i)) = static_cast<double>(sum[i]);
  return result;
}

template <class Problem>
void check_problem(const VectorXd& x, double exact, double by_differences) {
  REQUIRE(x.size() == Problem::dimension);
  const tchat_problem& table = *ProblemTable<Problem>::get("problem");
  tchat_problem without = table;
  without.third = nullptr;
  const HybridSystem system(table), less(without);
  ParameterVector par(system.layout(), 1);
  for (int k = 0; k < system.parameters(); ++k) par(k) = Problem::initial_parameters[k];
  const VectorXd wide_par = Eigen::Map<const VectorXd>(par.data(), system.parameters());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-0.5, 0.5);
  MatrixXd states = MatrixXd::NullaryExpr(system.dimension(), 8, [&] { return number(random); });
  states.col(0) = x;
  for (const FunctionKind kind : {FunctionKind::field, FunctionKind::event, FunctionKind::jump})
    for (int index = 1; index <= system.count(kind); ++index) {
      MatrixXd out(system.rows(kind), 8), difference(system.rows(kind), 8);
      system.third(kind, index, states.data(), par.data(), out.data());
      less.third(kind, index, states.data(), par.data(), difference.data());
      for (int m = 0; m < 8; ++m) {
        INFO(system.function_name(kind, index) << ", coefficient " << m);
        const VectorXd reference = wide_coefficient<Problem>(kind, index, states, wide_par, m);
        const double size = 1.0 + reference.cwiseAbs().maxCoeff();
        CHECK((out.col(m) - reference).cwiseAbs().maxCoeff() <= exact * size);
        CHECK((difference.col(m) - reference).cwiseAbs().maxCoeff() <= by_differences * size);
      }
    }
}

struct ByHand {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = sin(x[0]) * x[1] * x[1];
    f[1] = exp(p[0] * x[0]) / x[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return sqrt(x[0]) + x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0] * x[0] * x[1];
    g[1] = -x[1];
  }
};

}  // namespace

TEST_CASE("third derivatives of three problems against differences with fifty digits") {
  check_problem<CompassGait>(VectorXd{{-0.33, 0.22, -0.38, -1.09}}, 1e-12, 1e-7);
  check_problem<MemsOscillator>(VectorXd{{0.1, -0.2, 0.05, 0.3, 0.4}}, 1e-12, 1e-7);
  check_problem<Microactuator>(VectorXd{{0.1, -0.2, 0.05, 0.3, 0.2, 0.1}}, 1e-12, 1e-7);
}

TEST_CASE("third derivatives by hand") {
  const HybridSystem system(*ProblemTable<ByHand>::get("by hand"));
  const double x = 0.7, y = 1.3, p = 0.4;
  MatrixXd states = MatrixXd::Zero(2, 8), out(2, 8);
  states.col(0) << x, y;
  states(0, 1) = states(0, 2) = states(1, 4) = 1.0;  // d^3 / dx dx dy
  VectorXd par = VectorXd::Constant(TCHAT_PAR_LENGTH, p);
  system.third(FunctionKind::field, 1, states.data(), par.data(), out.data());
  CHECK(out(0, 7) == Approx(-std::sin(x) * 2.0 * y).epsilon(1e-14));
  CHECK(out(1, 7) == Approx(-p * p * std::exp(p * x) / (y * y)).epsilon(1e-14));
  CHECK(out(0, 3) == Approx(-std::sin(x) * y * y).epsilon(1e-14));
  system.third(FunctionKind::jump, 1, states.data(), par.data(), out.data());
  CHECK(out(0, 7) == Approx(2.0).epsilon(1e-14));
  CHECK(out(1, 7) == 0.0);
  states.col(4) << 1.0, 0.0;
  double h[8];
  system.third(FunctionKind::event, 1, states.data(), par.data(), h);
  CHECK(h[7] == Approx(0.375 * std::pow(x, -2.5)).epsilon(1e-14));
  system.third(FunctionKind::jump, 0, states.data(), par.data(), out.data());
  CHECK(out == states);
}
