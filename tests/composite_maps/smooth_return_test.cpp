#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>

#include "grazing_problems.hpp"
#include "maps/smooth_return.hpp"
#include "maps/suspended_system.hpp"
#include "motion/orbit_flow.hpp"
#include "support/random_matrices.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A linear oscillator with a jump that stretches and bends, whose return is a closed form:
/// x1' = x2, x2' = -x1, from (0, v) to x1 = 0 again after half a turn, then x2 -> s x2 + x2^2.
struct HalfTurn {
  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 2, jumps = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = x[1], f[1] = -x[0];
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? T(x[0] - p[1]) : T(x[0] + 10.0);
  }
  template <class T>
  void jump(int, const T* x, const T* p, T* g) const {
    g[0] = x[0], g[1] = p[0] * x[1] + x[1] * x[1];
  }
};

double largest(const MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("the return of a linear oscillator to a moving wall, to second order in state and parameters") {
  // From (x1, x2) to x1 = d with x2 < 0: x2 = -sqrt(r^2 - d^2), r^2 = x1^2 + x2^2, whatever the start on the way up.
  const SuspendedSystem suspended(system_of<HalfTurn>(), {1, 2}, 1, 2);
  const ParameterVector par = full_par({0.7, 0.0});
  const Eigen::Vector2d x(0.3, 1.1);
  const VectorXd z = suspended.suspended(x, par);
  const QuadraticMap map = smooth_return(suspended.system(), {{1, 1, 1}}, z, par, 2);
  const double r = x.norm();
  const double w = -r;  // x2 at the wall, d = 0
  CHECK(map.value(0) == Approx(0.0).margin(1e-12));
  CHECK(map.value(1) == Approx(0.7 * w + w * w).epsilon(1e-12));
  // w_x = x^T / w, w_d = 0, w_xx = (Id - w_x^T w_x) / w, w_dd = -1 / w; G = s w + w^2, G' = s + 2 w, G'' = 2.
  const Eigen::RowVector2d wx = x.transpose() / w;
  const Eigen::Matrix2d wxx = (Eigen::Matrix2d::Identity() - wx.transpose() * wx) / w;
  const double slope = 0.7 + 2.0 * w;
  CHECK(largest(map.first.row(1) - Eigen::RowVector4d(slope * wx(0), slope * wx(1), w, 0.0)) < 1e-11);
  Eigen::Matrix4d second = Eigen::Matrix4d::Zero();
  second.topLeftCorner<2, 2>() = slope * wxx + 2.0 * wx.transpose() * wx;
  second.block<2, 1>(0, 2) = wx.transpose();  // d2 G / dx ds = w_x
  second.block<1, 2>(2, 0) = wx;
  second(3, 3) = slope * -1.0 / w;
  CHECK(largest(map.second[1] - second) < 1e-10);
  CHECK(largest(map.first.row(0) - Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) < 1e-11);
  CHECK(largest(map.second[0]) < 1e-10);
}

TEST_CASE("event functions and derivatives of the suspended system against differences") {
  const SuspendedSystem suspended(system_of<ThreeDimensionalOscillator>(), {2, 1}, 1, 1,
                                  SectionPlane{Eigen::Vector3d(0.3, -1.0, 0.2), Eigen::Vector3d(-0.8, 0.2, 0.5)});
  const HybridSystem& system = suspended.system();
  const ParameterVector par = full_par({-0.8, 0.28, 0.8});
  VectorXd z(5);
  z << -0.7, 0.3, 0.5, 0.31, -0.85;
  REQUIRE(system.dimension() == 5);
  const auto check = [&](FunctionKind kind, int index) {
    const int rows = system.rows(kind);
    VectorXd value(rows), moved(rows), back(rows), along(rows);
    MatrixXd dz(rows, 5), second(rows, 5), dz_moved(rows, 5), dz_back(rows, 5);
    VectorXd direction(5);
    direction << 0.4, -0.3, 0.7, 0.2, -0.5;
    system.first(kind, index, z.data(), par.data(), {}, value.data(), dz.data(), nullptr);
    system.second(kind, index, z.data(), par.data(), {}, direction.data(), along.data(), second.data(), nullptr);
    const double h = 1e-5;
    const VectorXd forward = z + h * direction, backward = z - h * direction;
    system.first(kind, index, forward.data(), par.data(), {}, moved.data(), dz_moved.data(), nullptr);
    system.first(kind, index, backward.data(), par.data(), {}, back.data(), dz_back.data(), nullptr);
    CHECK(largest(dz * direction - (moved - back) / (2.0 * h)) < 1e-9);
    CHECK(largest(along - dz * direction) < 1e-8);
    CHECK(largest(second - (dz_moved - dz_back) / (2.0 * h)) < 1e-8);
  };
  check(FunctionKind::field, 1);
  check(FunctionKind::jump, 1);
  for (int event = 1; event <= 4; ++event) check(FunctionKind::event, event);
  // -h_P of the wall is the problem's own event 2, and parameters taken along are those of the state.
  const double x_par[] = {-0.85, 0.31, 0.8};
  const VectorXd x = z.head(3);
  VectorXd base_par = par;
  for (int k = 0; k < 3; ++k) base_par(k) = x_par[k];
  CHECK(system.event(suspended.least_distance(), z.data(), par.data()) ==
        Approx(suspended.base().event(2, x.data(), base_par.data())).epsilon(1e-14));
  CHECK(system.event(1, z.data(), par.data()) == Approx(0.15).epsilon(1e-12));
  // The wall follows nothing.
  const auto next = system.successors({0, 0, 0}, z.data(), par.data());
  REQUIRE(next.has_value());
  CHECK(*next == std::vector<IndexVector>{{1, 2, 2}});
}

TEST_CASE("second order of rand3d's smooth return against differences of its first order") {
  const auto suspended =
      std::make_shared<SuspendedSystem>(system_of<ThreeDimensionalOscillator>(), std::vector<int>{1, 2}, 1, 1);
  const ParameterVector par = full_par({-0.798146332928, 0.28, 0.8});
  const Eigen::Vector3d x(-0.798146332928, 0.274740619469, 0.624223368742);
  const GrazingTurn turn{x, par, {{1, 2, 2}}, {6.725184221523}, Eigen::Vector3d(1.5, 1.5, 1.2)};
  const PeriodicReturn smooth(suspended, turn, suspended->least_distance(), 2);
  // -h_P and the problem's event function 2 are one surface: one fall a period.
  CHECK(smooth.path() == Signature{{1, suspended->least_distance(), no_function}});
  CHECK(smooth.map().time == Approx(6.725184221523).epsilon(1e-10));
  const Eigen::MatrixXd a = smooth.map().first.topLeftCorner(3, 3);
  const Eigen::VectorXcd multipliers = lapack_eigenvalues(a);
  std::vector<double> moduli{std::abs(multipliers(0)), std::abs(multipliers(1)), std::abs(multipliers(2))};
  std::sort(moduli.begin(), moduli.end());
  CHECK(moduli[2] == Approx(0.539641978337).epsilon(1e-8));
  CHECK(moduli[1] == Approx(0.0239214365814).epsilon(1e-7));
  CHECK(moduli[0] < 1e-9);
  CHECK(largest(smooth.map().first.col(3)) < 1e-9 + std::abs(smooth.map().first(3, 3)));  // mu moves the wall alone
  CHECK(largest(smooth.map().first.topRows(3).col(3)) < 1e-10);

  // From a point away from the section, where starts beside it do not change which fall is the first.
  const auto second_at = [&](const VectorXd& at) {
    return smooth_return(suspended->system(), smooth.path(), at, par, 2);
  };
  const VectorXd z = integrate_for(suspended->system(), 1, suspended->suspended(x, par), par, 1.0).end_state;
  const QuadraticMap map = second_at(z);
  const double h = 1e-3;
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    const auto first_at = [&](double t) {
      VectorXd moved = z;
      moved(k) += t;
      return smooth_return(suspended->system(), smooth.path(), moved, par, 1).first;
    };
    // Fourth order: h^4 times fifth derivatives of the map, some 1e2.
    const MatrixXd difference =
        (8.0 * (first_at(h) - first_at(-h)) - (first_at(2.0 * h) - first_at(-2.0 * h))) / (12.0 * h);
    for (Eigen::Index i = 0; i < 3; ++i)
      CHECK(largest(map.second[static_cast<std::size_t>(i)].row(k) - difference.row(i)) < 1e-7);
  }
}
