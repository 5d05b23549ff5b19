// Mesh adaptation and transfer between meshes against functions whose derivatives are known.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "orbit/mesh_adaptation.hpp"
#include "support/sampled_orbit.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

Piece scalar_piece(double duration, double (*u)(double)) {
  return {duration, [u](double t) { return Eigen::VectorXd::Constant(1, u(t)); }};
}

Orbit scalar_orbit(double (*u)(double), int intervals, int c, const std::vector<double>& mesh = {}) {
  return sampled_orbit({scalar_piece(1.0, u)}, 1, intervals, c, parameters({}), mesh);
}

/// Shares of the integral of |u^(c+1)|^(1/(c+1)) for u' = a (1 - u^2) with c = 2: tanh.
double monitor_of_tanh(double tau) {
  const double t = std::tanh(30 * (tau - 0.4));
  return std::cbrt(std::abs((1 - t * t) * (6 * t * t - 2)));
}

}  // namespace

TEST_CASE("equal parts of a density") {
  const std::vector<double> mesh{0.0, 0.2, 0.5, 1.0};
  const Eigen::Vector3d density(5.0, 1.0, 0.4);  // masses 1, 0.3, 0.2
  const std::vector<double> parts = equal_parts(mesh, density, 3);
  REQUIRE(parts.size() == 4);
  CHECK(parts[0] == 0.0);
  CHECK(parts[1] == Approx(0.1).epsilon(1e-14));
  CHECK(parts[2] == Approx(0.2).epsilon(1e-14));
  CHECK(parts[3] == 1.0);
  const std::vector<double> many = equal_parts(mesh, density, 1000);
  for (std::size_t k = 1; k < many.size(); ++k) CHECK(many[k] > many[k - 1]);
}

TEST_CASE("interpolation to another mesh, N and c is exact for polynomials of degree c") {
  const auto cubic = [](double t) { return 1 - 2 * t + 3 * t * t - 4 * t * t * t; };
  const std::vector<double> from_mesh{0.0, 0.1, 0.35, 0.4, 1.0};
  const Orbit x = sampled_orbit({scalar_piece(1.0, cubic), scalar_piece(1.0, [](double t) { return t * t; })}, 1, 4, 3,
                                parameters({}), from_mesh);
  const OrbitShape to{1, 2, 6, 5};
  const std::vector<double> to_mesh{0.0, 0.05, 0.1, 0.3, 0.7, 0.95, 1.0};
  const Eigen::MatrixXd states = interpolate_states(x.states, x.shape, from_mesh, to, to_mesh);
  const Orbit y{to, to_mesh, states, x.par};
  for (int k = 0; k < to.nodes(); ++k) {
    CHECK(y.node(0, k)[0] == Approx(cubic(y.tau(k))).epsilon(1e-13));
    CHECK(std::abs(y.node(1, k)[0] - y.tau(k) * y.tau(k)) < 1e-14);
  }
}

TEST_CASE("a new mesh of the same density") {
  const std::vector<double> mesh{0.0, 0.1, 0.35, 0.4, 1.0};
  CHECK(resampled_mesh(mesh, 4) == mesh);
  const std::vector<double> doubled = resampled_mesh(mesh, 8);
  for (std::size_t k = 0; k < mesh.size(); ++k) CHECK(doubled[2 * k] == Approx(mesh[k]).margin(1e-15));
  const std::vector<double> back = resampled_mesh(doubled, 4);
  for (std::size_t k = 0; k < mesh.size(); ++k) CHECK(back[k] == Approx(mesh[k]).margin(1e-15));
}

TEST_CASE("equidistribution: a power has the mesh that its derivative asks for") {
  // u = tau^(c+2): |u^(c+1)|^(1/(c+1)) ~ tau^(1/(c+1)), so that tau_k = (k/N)^((c+1)/(c+2)).
  const int n = 40;
  const Orbit x = scalar_orbit([](double t) { return std::pow(t, 5); }, n, 3);
  const std::vector<double> mesh = equidistributed_mesh(x, CollocationRule(3), n);
  // Piecewise constant estimates at interval ends: first order in 1 / N; smoothing acts on the first intervals most.
  for (int k = 0; k <= n; ++k)
    CHECK(std::abs(mesh[static_cast<std::size_t>(k)] - std::pow(static_cast<double>(k) / n, 0.8)) < 0.25 / n);
}

TEST_CASE("equidistribution: a layer gathers the mesh until every interval has about the same share") {
  const int n = 60;
  std::vector<double> mesh = uniform_mesh(n);
  for (int sweep = 0; sweep < 6; ++sweep)
    mesh = equidistributed_mesh(scalar_orbit([](double t) { return std::tanh(30 * (t - 0.4)); }, n, 2, mesh),
                                CollocationRule(2), n);
  const auto share = [](double from, double to) {
    double sum = 0.0;
    for (int k = 0; k < 200; ++k) sum += monitor_of_tanh(from + (to - from) * (k + 0.5) / 200) * (to - from) / 200;
    return sum;
  };
  const double fair = share(0.0, 1.0) / n;
  // Near the layer, where the derivatives count, shares are equal within smoothing; a uniform mesh has 0 to 8 fair
  // ones.
  for (std::size_t j = 0; j + 1 < mesh.size(); ++j) {
    CHECK(share(mesh[j], mesh[j + 1]) < 2.0 * fair);
    if (mesh[j] > 0.35 && mesh[j + 1] < 0.45) CHECK(share(mesh[j], mesh[j + 1]) > 0.4 * fair);
  }
  const auto inside = std::count_if(mesh.begin(), mesh.end(), [](double t) { return std::abs(t - 0.4) < 0.1; });
  CHECK(inside > n / 2);
}

TEST_CASE("equidistribution: constants keep a uniform mesh, segments of zero duration have no weight") {
  const int n = 20;
  const CollocationRule rule(3);
  const auto constant = [](double) { return 2.5; };
  const auto layer = [](double t) { return std::tanh(50 * (t - 0.5)); };
  const std::vector<double> flat = equidistributed_mesh(scalar_orbit(constant, n, 3), rule, n);
  for (int k = 0; k <= n; ++k)
    CHECK(flat[static_cast<std::size_t>(k)] == Approx(static_cast<double>(k) / n).margin(1e-14));

  Orbit x = sampled_orbit({scalar_piece(1.0, constant), scalar_piece(1.0, layer)}, 1, n, 3, parameters({}));
  CHECK(std::abs(equidistributed_mesh(x, rule, n)[5] - 0.25) > 0.05);
  x.duration(1) = 0.0;
  CHECK(equidistributed_mesh(x, rule, n)[5] == Approx(0.25).epsilon(1e-14));
}

namespace {

/// Widest over narrowest interval.
double unevenness(const std::vector<double>& mesh) {
  double widest = 0.0, narrowest = 1.0;
  for (std::size_t j = 0; j + 1 < mesh.size(); ++j) {
    widest = std::max(widest, mesh[j + 1] - mesh[j]);
    narrowest = std::min(narrowest, mesh[j + 1] - mesh[j]);
  }
  return widest / narrowest;
}

Orbit orbit_of(std::function<Eigen::VectorXd(double)> u, int n, int intervals, int c,
               const std::vector<double>& mesh = {}) {
  return sampled_orbit({{1.0, std::move(u)}}, n, intervals, c, parameters({}), mesh);
}

/// Largest distance from u between the nodes, each component relative to its size on the orbit.
double interpolation_error(const Orbit& x, const std::function<Eigen::VectorXd(double)>& u) {
  const int c = x.shape.collocation;
  const Eigen::VectorXd sizes = x.states.cwiseAbs().rowwise().maxCoeff();
  const CollocationRule rule(c);
  Eigen::VectorXd basis(c + 1);
  double worst = 0.0;
  for (int j = 0; j < x.shape.intervals; ++j)
    for (int k = 1; k < 30; ++k) {
      rule.basis(k / 30.0, basis.data(), nullptr);
      const double from = x.mesh[static_cast<std::size_t>(j)], to = x.mesh[static_cast<std::size_t>(j + 1)];
      const Eigen::VectorXd miss = x.states.middleCols(j * c, c + 1) * basis - u(from + (to - from) * k / 30.0);
      worst = std::max(worst, miss.cwiseAbs().cwiseQuotient(sizes).maxCoeff());
    }
  return worst;
}

}  // namespace

TEST_CASE("equidistribution: polynomials of degree c keep the mesh, whatever rounding makes of their derivatives") {
  const int c = GENERATE(2, 4, 7);
  const int intervals = GENERATE(20, 40, 400);
  const double size = GENERATE(1e-6, 1.0, 1e6);
  CAPTURE(c, intervals, size);
  // Rounding of a state that is the sum of increments, as collocation makes it, beside states that are zero.
  const double third = size / 3.0;
  const auto line = [&](double t) { return Eigen::Vector3d(0.0, (t + 0.1) * third, (1.0 - t) * t * size); };
  const Orbit x = orbit_of(line, 3, intervals, c);
  CHECK(unevenness(equidistributed_mesh(x, CollocationRule(c), intervals)) < 1.0 + 1e-9);
}

TEST_CASE("equidistribution: a polynomial beside a layer does not move its mesh") {
  const auto layer = [](double t) { return std::tanh(30 * (t - 0.4)); };
  const int n = 40;
  const CollocationRule rule(4);
  const Orbit alone = orbit_of([&](double t) { return Eigen::VectorXd::Constant(1, layer(t)); }, 1, n, 4);
  const Orbit beside = orbit_of([&](double t) { return Eigen::Vector2d(layer(t), 0.1 + t / 3.0); }, 2, n, 4);
  const std::vector<double> expected = equidistributed_mesh(alone, rule, n),
                            found = equidistributed_mesh(beside, rule, n);
  for (std::size_t j = 0; j < found.size(); ++j) CHECK(found[j] == Approx(expected[j]).margin(1e-14));
  CHECK(unevenness(found) > 3.0);
}

TEST_CASE("equidistribution: the mesh of a layer stays when it is resolved to rounding") {
  const auto layer = [](double t) { return Eigen::VectorXd::Constant(1, std::tanh(30 * (t - 0.4))); };
  const int n = 400;
  const CollocationRule rule(7);
  std::vector<double> mesh = uniform_mesh(n);
  for (int pass = 0; pass < 12; ++pass) {
    mesh = equidistributed_mesh(orbit_of(layer, 1, n, 7, mesh), rule, n);
    CAPTURE(pass);
    CHECK(interpolation_error(orbit_of(layer, 1, n, 7, mesh), layer) < 1e-13);
  }
}

TEST_CASE("equidistribution: an adapted mesh is not worse than the uniform one") {
  // The mesh is chosen by derivatives that are constant on intervals: far from the limit of small intervals the true
  // errors differ from what they let expect, on ten intervals by less than a factor of two.
  using Function = std::function<Eigen::VectorXd(double)>;
  const std::vector<Function> functions{
      [](double t) { return Eigen::Vector2d(std::sin(6.3 * t), std::cos(6.3 * t)); },
      [](double t) { return Eigen::Vector3d(std::sin(6.3 * t), 1e3 * std::cos(12.6 * t), 1e-3 * std::exp(t)); },
      [](double t) { return Eigen::Vector2d(std::exp(-20 * t), std::exp(20 * (t - 1))); },
      [](double t) { return Eigen::Vector2d(std::tanh(40 * (t - 0.3)), t); },
      [](double t) { return Eigen::Vector3d(1 / (1 + 400 * (t - 0.5) * (t - 0.5)), std::sin(20 * t), 100 * t * t); },
      [](double t) { return Eigen::VectorXd::Constant(1, std::pow(t + 0.01, 0.5)); },
      [](double t) { return Eigen::Vector2d(std::pow(t, 6), std::pow(1 - t, 6)); },
      [](double t) { return Eigen::Vector2d(1e-9 * std::cos(6.3 * t), 1e-9 * std::exp(std::sin(6.3 * t))); },
  };
  const int c = GENERATE(2, 4, 6);
  const int n = GENERATE(10, 20, 60);
  const CollocationRule rule(c);
  for (std::size_t k = 0; k < functions.size(); ++k) {
    const int states = static_cast<int>(functions[k](0.0).size());
    std::vector<double> mesh = uniform_mesh(n);
    const double uniform = interpolation_error(orbit_of(functions[k], states, n, c, mesh), functions[k]);
    for (int pass = 0; pass < 6; ++pass) {
      mesh = equidistributed_mesh(orbit_of(functions[k], states, n, c, mesh), rule, n);
      CAPTURE(c, n, k, pass);
      CHECK(interpolation_error(orbit_of(functions[k], states, n, c, mesh), functions[k]) < 2.0 * uniform + 1e-13);
    }
  }
}

TEST_CASE("estimated interpolation error: the interpolation error of a power, exactly") {
  // u = tau^(c+1) has a constant (c+1)-th derivative: the error between the nodes of an interval is
  // max prod |tau - node|, here for c = 2, h = 1/10: (h/2)^3 2 / (3 sqrt 3).
  const Orbit x = scalar_orbit([](double t) { return t * t * t; }, 10, 2);
  const double exact = std::pow(0.05, 3) * 2 / (3 * std::sqrt(3.0));
  CHECK(estimated_interpolation_error(x, CollocationRule(2)) ==
        Approx(exact / 2).epsilon(1e-3));  // relative to 1 + max |u| = 2
}

TEST_CASE("estimated interpolation error: one interval has no neighbour, and its error is not called zero") {
  // exp on one interval: the error that interpolation makes, within a factor of ten.
  for (const int c : {2, 4, 6}) {
    CAPTURE(c);
    const Orbit x = scalar_orbit([](double t) { return std::exp(3.0 * t); }, 1, c);
    const CollocationRule rule(c);
    Eigen::VectorXd basis(c + 1);
    double worst = 0.0;
    for (int k = 0; k <= 100; ++k) {
      rule.basis(0.01 * k, basis.data(), nullptr);
      worst = std::max(worst, std::abs((x.states * basis)(0) - std::exp(0.03 * k)));
    }
    const double error = worst / (1.0 + std::exp(3.0));
    CHECK(estimated_interpolation_error(x, rule) > 0.1 * error);
    CHECK(estimated_interpolation_error(x, rule) < 10.0 * error);
  }
}
