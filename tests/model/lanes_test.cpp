// Derivatives at four points side by side are those at each point, to the last bit: what they are is tested with
// plain numbers (automatic_differentiation_test.cpp).
#include <catch2/catch.hpp>
#include <cstring>
#include <random>
#include <stdexcept>
#include <tchat/problem.hpp>
#include <vector>

using namespace tchat;

namespace {

/// All functions that there are; branches on the state; states at which it cannot be evaluated.
struct Everything {
  static constexpr int dimension = 3, parameters = 4;
  static constexpr int fields = 3, events = 2, jumps = 1;
  static inline long evaluations = 0;

  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    ++evaluations;
    if (i == 1) {
      f[0] = sin(x[0]) * cos(x[1]) + tan(par[0] * x[2]) / (1.5 + tanh(x[0])) - asin(0.3 * x[1]) + acos(0.2 * x[2]);
      f[1] = sinh(x[0]) - cosh(x[1]) + exp(x[2]) * expm1(-x[0]) + exp2(par[1] * x[0]) - 2.0 / (3.0 + x[1] * x[1]);
      f[2] = log(2.5 + x[0]) + log1p(x[1] * x[1]) + log2(4.0 - x[2]) * log10(3.0 + x[1]) - sqrt(2.0 + x[0] * x[1]);
    } else if (i == 2) {
      f[0] =
          atan(x[0]) + atan2(x[1], x[0] + 3.0) + asinh(x[2]) + acosh(3.0 + x[0]) + atanh(0.3 * x[1]) + cbrt(4.0 + x[2]);
      f[1] = pow(x[0] + 3.0, x[1]) + pow(x[1], 3) + pow(2.0, x[2]) + hypot(x[0], 2.0) + fmod(5.0 * x[0], par[2]);
      f[2] = fabs(x[0]) + fmax(x[1], x[2]) + fmin(x[1], 0.1) + whole_numbers::floor(3.0 * x[0]) * x[1] +
             whole_numbers::trunc(4.0 * x[2]);
      if (x[0] > 0.2) f[0] = x[1] / x[0];
      while (f[2] > 1.0) f[2] *= 0.5;
    } else {
      if (plain(x[0]) > 0.5) throw std::domain_error("beyond 0.5");
      f[0] = x[0] * x[1];
      if (x[1] > 0.4) return;  // the others are left unset
      f[1] = par[3] * x[2] - x[1];
      f[2] = T(NAN);
    }
  }
  template <class T>
  T event(int j, const T* x, const T* par) const {
    return j == 1 ? par[0] - x[0] * x[0] : x[1] < 0.0 ? -x[1] : x[2];
  }
  template <class T>
  void jump(int, const T* x, const T* par, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = par[3] * x[i] * x[i];
  }
};

/// More columns than one kind of dual numbers has derivatives.
struct Wide {
  static constexpr int dimension = 13, parameters = 2;
  static constexpr int fields = 1;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    for (int i = 0; i < dimension; ++i) f[i] = sin(x[i]) * x[(i + 5) % dimension] + par[i % 2] / (2.0 + x[i]);
  }
};

std::vector<double> numbers(std::size_t count, int seed) {
  std::mt19937 generator(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform(-0.7, 0.7);
  std::vector<double> values(count);
  for (double& value : values) value = uniform(generator);
  return values;
}

/// Bits, as NaN is not equal to itself; of NaN the sign and the rest do not count.
bool are_same(const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::memcmp(&a[i], &b[i], sizeof(double)) != 0 && !(std::isnan(a[i]) && std::isnan(b[i]))) return false;
  return a.size() == b.size();
}

/// As problem.h has it: entry k of the point in lane l of a set is number 4 k + l.
std::vector<double> side_by_side(const std::vector<double>& one_by_one, int size) {
  std::vector<double> result(one_by_one.size());
  const int points = static_cast<int>(one_by_one.size()) / size;
  for (int point = 0; point < points; ++point)
    for (int k = 0; k < size; ++k)
      result[static_cast<std::size_t>((point / 4 * size + k) * 4 + point % 4)] =
          one_by_one[static_cast<std::size_t>(point * size + k)];
  return result;
}

struct First {
  std::vector<double> out, dx, dp;
  First(int points, int rows, int n, int parameters)
      : out(static_cast<std::size_t>(points * rows), -1.0),
        dx(static_cast<std::size_t>(points * rows * n), -1.0),
        dp(static_cast<std::size_t>(points * rows * parameters), -1.0) {}
};

template <class Problem>
struct Tables {
  static constexpr int n = Problem::dimension;
  const tchat_problem& plain = *ProblemTable<Problem, double>::get("plain");
  const tchat_problem& lanes = *ProblemTable<Problem, Lanes>::get("lanes");
  std::vector<double> par = [] {
    std::vector<double> values = numbers(256, 7);
    values[2] = 0.75;
    return values;
  }();
  std::vector<std::int32_t> active{2, 1};
  int active_count = 2;

  First first(const tchat_problem& table, int kind, int index, int points, const std::vector<double>& x) const {
    First result(points, kind == TCHAT_EVENT ? 1 : n, n, active_count);
    table.first_at_points(table.self, kind, index, points, x.data(), par.data(), active.data(), active_count,
                          result.out.data(), result.dx.data(), result.dp.data());
    return result;
  }
  First first_in_lanes(const tchat_problem& table, int kind, int index, int sets, const std::vector<double>& x) const {
    First result(4 * sets, kind == TCHAT_EVENT ? 1 : n, n, active_count);
    const std::vector<double> states = side_by_side(x, n);
    table.first_in_lanes(table.self, kind, index, sets, states.data(), par.data(), active.data(), active_count,
                         result.out.data(), result.dx.data(), result.dp.data());
    return result;
  }
  void check_first(int kind, int index, int points) const {
    CAPTURE(kind, index, points);
    const int rows = kind == TCHAT_EVENT ? 1 : n;
    const std::vector<double> x = numbers(static_cast<std::size_t>(n * points), 10 * index + points);
    const First wanted = first(plain, kind, index, points, x);
    const First found = first(lanes, kind, index, points, x);
    CHECK(are_same(found.out, wanted.out));
    CHECK(are_same(found.dx, wanted.dx));
    CHECK(are_same(found.dp, wanted.dp));
    if (points % 4 != 0) return;
    const First together = first_in_lanes(lanes, kind, index, points / 4, x);
    CHECK(are_same(together.out, side_by_side(wanted.out, rows)));
    CHECK(are_same(together.dx, side_by_side(wanted.dx, rows * n)));
    CHECK(are_same(together.dp, side_by_side(wanted.dp, rows * active_count)));
  }
  void check_second(int kind, int index, int points, int directions) const {
    CAPTURE(kind, index, points, directions);
    const int rows = kind == TCHAT_EVENT ? 1 : n;
    const auto many = [](int count, int seed) { return numbers(static_cast<std::size_t>(count), seed); };
    const std::vector<double> x = many(n * points, 10 * index + points), v = many(n * points * directions, 2);
    const std::vector<double> q = many(active_count * directions, 3), w = many(points * (directions + 1) * rows, 4);
    std::vector<double> out[2], gradient[2];
    for (int t = 0; t < 2; ++t) {
      const tchat_problem& table = t == 0 ? plain : lanes;
      out[t].resize(static_cast<std::size_t>(points * directions * rows), -1.0);
      gradient[t].resize(static_cast<std::size_t>(points * (n + active_count)), -1.0);
      table.second_at_points(table.self, kind, index, points, directions, x.data(), par.data(), active.data(),
                             active_count, v.data(), q.data(), w.data(), out[t].data(), gradient[t].data());
    }
    CHECK(are_same(out[1], out[0]));
    CHECK(are_same(gradient[1], gradient[0]));
  }
  void check_single(int kind, int index) const {
    CAPTURE(kind, index);
    const int rows = kind == TCHAT_EVENT ? 1 : n;
    const std::vector<double> x = numbers(n, index), direction = numbers(static_cast<std::size_t>(n + active_count), 5);
    First found[2] = {{1, rows, n, active_count}, {1, rows, n, active_count}};
    for (int t = 0; t < 2; ++t) {
      const tchat_problem& table = t == 0 ? plain : lanes;
      table.second(table.self, kind, index, x.data(), par.data(), active.data(), active_count, direction.data(),
                   found[t].out.data(), found[t].dx.data(), found[t].dp.data());
    }
    CHECK(are_same(found[1].out, found[0].out));
    CHECK(are_same(found[1].dx, found[0].dx));
    CHECK(are_same(found[1].dp, found[0].dp));
  }
};

}  // namespace

TEST_CASE("derivatives at points side by side are those of each point") {
  const Tables<Everything> tables;
  for (const int points : {1, 2, 3, 4, 5, 8, 9, 40}) {
    for (int index = 1; index <= 3; ++index) tables.check_first(TCHAT_FIELD, index, points);
    for (int index = 1; index <= 2; ++index) tables.check_first(TCHAT_EVENT, index, points);
    tables.check_first(TCHAT_JUMP, 1, points);
    for (const int directions : {1, 2}) {
      for (int index = 1; index <= 3; ++index) tables.check_second(TCHAT_FIELD, index, points, directions);
      tables.check_second(TCHAT_EVENT, 2, points, directions);
    }
  }
  for (int index = 1; index <= 3; ++index) tables.check_single(TCHAT_FIELD, index);
  tables.check_single(TCHAT_EVENT, 2);
  const Tables<Wide> wide;
  for (const int points : {1, 3, 8}) {
    wide.check_first(TCHAT_FIELD, 1, points);
    wide.check_second(TCHAT_FIELD, 1, points, 2);
  }
  wide.check_single(TCHAT_FIELD, 1);
}

TEST_CASE("four points are evaluated at once, and one by one where a comparison parts them") {
  const Tables<Everything> tables;
  const auto evaluations = [&](int field, const std::vector<double>& x) {
    const long before = Everything::evaluations;
    tables.first(tables.lanes, TCHAT_FIELD, field, static_cast<int>(x.size()) / 3, x);
    return Everything::evaluations - before;
  };
  std::vector<double> x = numbers(3 * 8, 1);
  CHECK(evaluations(1, x) == 2);  // has no comparison
  CHECK(evaluations(1, numbers(3 * 5, 1)) == 2);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.3 + 1e-3 * static_cast<double>(i);
  CHECK(evaluations(3, x) == 2 * (1 + 4));  // asks for the plain number
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = -0.1 - 1e-3 * static_cast<double>(i);
  CHECK(evaluations(2, x) == 2);  // all on one side
  x[3 * 6] = 0.3;
  CHECK(evaluations(2, x) == 1 + 1 + 4);
  CHECK(evaluations(1, numbers(3, 1)) == 1);
}

namespace {
/// Not to be taken for any function of tchat's.
template <class T>
T truncated(const T& a) {
  return a > 0.0 ? a : T(0.0);
}
struct OwnFunctions {
  static constexpr int dimension = 1, parameters = 1, fields = 1;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = truncated(x[0]) * par[0] + fmod(x[0], T(INFINITY));
  }
};
}  // namespace

TEST_CASE("a problem's own functions are not taken for tchat's") {
  const Tables<OwnFunctions> tables;
  const double x = 1.7, par[] = {2.0};
  for (const tchat_problem* table : {&tables.plain, &tables.lanes}) {
    double f = 0.0, dx = 0.0;
    table->first(table->self, TCHAT_FIELD, 1, &x, par, nullptr, 0, &f, &dx, nullptr);
    CHECK(f == 2.0 * 1.7 + 1.7);
    CHECK(dx == 3.0);
  }
}

TEST_CASE("the numbers of all lanes") {
  const Lanes a(1.0, 2.0, 3.0, 4.0);
  parted() = false;
  CHECK(a > 0.5);
  CHECK_FALSE(a > 4.5);
  CHECK_FALSE(parted());
  CHECK_FALSE(a > 2.5);  // the first lane's answer
  CHECK(parted());
  parted() = false;
  CHECK(plain(Lanes(2.5)) == 2.5);
  CHECK_FALSE(parted());
  CHECK(plain(a) == 1.0);
  CHECK(parted());
  parted() = false;
  CHECK_FALSE(is_one_number(Lanes(0.0, -0.0, 0.0, 0.0)));
  CHECK(std::signbit(sin(Lanes(0.0, -0.0, 0.0, 0.0)).lane(1)));
  CHECK(std::signbit((-Lanes(0.0)).lane(3)));
  CHECK(erf(a).lane(2) == std::erf(3.0));
  CHECK(isfinite(a));
  CHECK_FALSE(isfinite(Lanes(INFINITY)));
  CHECK_FALSE(isfinite(Lanes(NAN)));
  double numbers_of[4] = {};
  (a * 2.0 - 1.0 / a).to(numbers_of);
  CHECK(numbers_of[2] == 6.0 - 1.0 / 3.0);
}
