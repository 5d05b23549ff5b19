#include "model/scales.hpp"

#include <catch2/catch.hpp>

#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// Two oscillators, x'' = -x and y'' = -y, whose positions are in units of 1 / PAR(1) and 1 / PAR(2).
struct Oscillators {
  static constexpr int dimension = 4, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = p[0] * x[1];
    f[1] = -x[0] / p[0];
    f[2] = p[1] * x[3];
    f[3] = -x[2] / p[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
  }
};

/// r' = r (2 - r^2), phi' = 1, beside a state that stays where it is.
struct CycleBesideIdle {
  static constexpr int dimension = 3, parameters = 0, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    const T growth = 2.0 - x[0] * x[0] - x[1] * x[1];
    f[0] = growth * x[0] - x[1];
    f[1] = growth * x[1] + x[0];
    f[2] = T(0.0);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
  }
};

Eigen::VectorXd sizes_at_rest(double x_unit, double y_unit) {
  const HybridSystem& system = system_of<Oscillators>();
  StateSizes sizes(Eigen::MatrixXd::Zero(4, 1));
  const Eigen::Vector4d rest = Eigen::Vector4d::Zero();
  Eigen::VectorXd par = Eigen::VectorXd::Zero(system.layout().room());
  par.head(2) << x_unit, y_unit;
  sizes.add_at_rest(system, 1, rest.data(), par.data());
  return sizes.sizes();
}

}  // namespace

TEST_CASE("states of which only their equations are known have sizes that balance these") {
  CHECK(sizes_at_rest(1.0, 1.0) == Eigen::Vector4d::Ones());
  CHECK(sizes_at_rest(7.0, 0.2) == Eigen::Vector4d::Ones());  // usual ones
  // A position that is 1e9 in its unit where the velocity is 1.
  const Eigen::VectorXd sizes = sizes_at_rest(1e9, 1e-6);
  CHECK(sizes(0) / sizes(1) == Approx(1e9));
  CHECK(sizes(2) / sizes(3) == Approx(1e-6));
}

TEST_CASE("where the eigenvalues of the field are rounding, an idle state says nothing of the others' sizes") {
  const HybridSystem& system = system_of<CycleBesideIdle>();
  const Eigen::VectorXd par = Eigen::VectorXd::Zero(system.layout().room());
  // At (1, 0) f_x is nilpotent: [[-1, -1], [1, 1]] with eigenvalues of 1e-8.
  const Eigen::VectorXd sizes = sizes_at(system, 1, Eigen::Vector3d(1.0, 0.0, 0.0), par);
  CHECK(sizes(0) == Approx(1.0));
  CHECK(sizes(1) > 0.1);
  CHECK(sizes(1) < 10.0);
}
