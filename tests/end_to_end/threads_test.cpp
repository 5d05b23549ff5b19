// tchat run -j: 25 oscillators in a ring, 50 dimensions, whose orbit in step has a closed form. The files are the same
// bytes for any number of threads.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

/// z_j' = (mu + i (1 + b |z_j|^2)) z_j - |z_j|^2 z_j + k (z_{j-1} - 2 z_j + z_{j+1}): in step |z_j|^2 = mu, and the
/// period is 2 pi / (1 + b mu).
const char* const source = R"(#include <tchat/problem.hpp>

struct Ring {
  static constexpr int dimension = 50, parameters = 3, fields = 1;
  static constexpr double initial_parameters[] = {1.0, 0.3, 0.2};
  template <class T>
  void field(int, const T* z, const T* p, T* f) const {
    for (int j = 0; j < 25; ++j) {
      const int left = (j + 24) % 25, right = (j + 1) % 25;
      const T &x = z[2 * j], &y = z[2 * j + 1];
      const T size = x * x + y * y;
      const T growth = p[0] - size, frequency = 1.0 + p[1] * size;
      f[2 * j] = growth * x - frequency * y + p[2] * (z[2 * left] - 2.0 * x + z[2 * right]);
      f[2 * j + 1] = growth * y + frequency * x + p[2] * (z[2 * left + 1] - 2.0 * y + z[2 * right + 1]);
    }
  }
};
TCHAT_PROBLEM(Ring)
)";

const char* const constants = R"(NDIM = 50, IPS = 180, IRS = 0, ICP = [1, 61], NTST = 20, NCOL = 4, NMX = 5, NPR = 2
RL1 = 3, DS = 0.05, DSMAX = 0.1, EPSL = 1e-9, EPSU = 1e-9, EPSS = 1e-8
GCFIND = [1], GCHIND = [0], GCGIND = [0]
)";

constexpr double pi = 3.14159265358979323846;

double period(double mu) { return 2.0 * pi / (1.0 + 0.3 * mu); }

std::string start_data() {
  std::string text;
  for (int k = 0; k <= 80; ++k) {
    const double angle = 2.0 * pi * k / 80;
    text += fmt::format("{:.12f}", period(1.0) * k / 80);
    for (int j = 0; j < 25; ++j) text += fmt::format(" {:.12f} {:.12f}", std::cos(angle), std::sin(angle));
    text += '\n';
  }
  return text;
}

}  // namespace

TEST_CASE("a run of 50 dimensions by one thread and by several: the closed form, and the same bytes") {
  const Workspace workspace;
  workspace.write("ring.cpp", source);
  workspace.write("gc.ring", constants);
  workspace.write("ring.dat", start_data());
  for (const std::string threads : {"1", "2", "3"}) {
    const Outcome outcome = workspace.tchat("run ring -j " + threads + " -o by" + threads);
    INFO(outcome.text());
    REQUIRE(outcome.status == 0);
  }
  const PointSection section = workspace.points("by2").front();
  CHECK(section.rows.size() == 5);
  for (const PointRow& row : section.rows) {
    const double mu = row.values[section.column("PAR(1)")];
    CHECK(row.values[section.column("PAR(61)")] == Approx(period(mu)).epsilon(1e-8));
  }
  CHECK(section.rows.back().values[section.column("PAR(1)")] > 1.02);
  for (const std::string file : {"p.", "q.", "d."})
    for (const std::string threads : {"2", "3"})
      CHECK(workspace.read(file + "by" + threads) == workspace.read(file + "by1"));
}

TEST_CASE("a number of threads that is none is refused") {
  const Workspace workspace;
  for (const std::string number : {"0", "-1", "1.5", "many"})
    check_refused(workspace.tchat("run linosc -j " + number), {"--jobs", number});
}
