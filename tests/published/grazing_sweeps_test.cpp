// Attractors through grazing, as the diagrams of chapters 3 and 4 show them, by the real executable: where they jump,
// where two coexist, how periods follow one another; beside the composite map. mu* and the fold are the published
// values, which rand3d_test finds by continuation.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "published/makefile_run.hpp"
#include "simulate/sweep_file.hpp"

using namespace test_support;
using namespace tchat;

namespace {

/// What a sweep tells of one value and start.
struct Value {
  double mu = 0.0;
  int period = -1, impacts = -1;  // in events
  double penetration = -1e9;      // the largest
};

SweepTable sweep(const MakefileRun& chain, std::vector<std::string> words, const std::string& name) {
  words.insert(words.begin(), {"sweep", "rand3d", "-q", "-p", chain.plugin(), "-o", name});
  const Outcome outcome = chain.tchat(words);
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const TemporaryFolder copy;
  return read_sweep_file(copy.write(name + ".sweep", chain.read(name + ".sweep")));
}

/// By index.
std::vector<Value> values_of(const SweepTable& table, int start = 1) {
  std::map<int, Value> values;
  const auto number = [&](const char* name, std::size_t row) { return (*table.column(name))[row]; };
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (number("start", row) != start) continue;
    Value& value = values[static_cast<int>(number("index", row))];
    value.mu = number("mu", row);
    value.period = std::isfinite(number("period", row)) ? static_cast<int>(number("period", row)) : -1;
    value.impacts = static_cast<int>(number("impacts", row));
    value.penetration = std::max(value.penetration, number("penetration", row));
  }
  std::vector<Value> list;
  for (const auto& [index, value] : values) list.push_back(value);
  return list;
}

}  // namespace

TEST_CASE("rand3d, m = 0.28: up the attractor jumps at mu*, down it lasts to the fold") {
  const MakefileRun chain("rand3d", "q.grazing_028");
  constexpr double contact = -0.798146332928, fold = -0.7999350433, step = 5e-5;
  const SweepTable table =
      sweep(chain, {"PAR(m)=0.28", "--over", "mu=-0.801:-0.797:81", "--penetration", "1", "--follow", "both"}, "both");
  const std::vector<Value> up = values_of(table, 1), down = values_of(table, 2);
  REQUIRE(up.size() == 81);
  REQUIRE(down.size() == 81);
  for (std::size_t k = 0; k < up.size(); ++k) {
    INFO("mu = " << up[k].mu);
    if (std::abs(up[k].mu - contact) > step) CHECK(up[k].impacts == (up[k].mu > contact ? 1 : 0));
    if (std::abs(down[k].mu - fold) > step) CHECK(down[k].impacts == (down[k].mu > fold ? 1 : 0));
    // Without impacts the penetration is the distance from grazing: the orbit does not depend on mu.
    if (up[k].impacts == 0) CHECK(up[k].penetration == Approx(up[k].mu - contact).margin(1e-6));
    // With them it is far from zero, however near mu* is: the published velocity at the fold is -0.0424.
    if (up[k].impacts == 1) CHECK(up[k].penetration > 0.005);
    if (down[k].impacts == 1) CHECK(down[k].penetration > 0.5 * 0.042 * 0.042 / 0.7);
  }

  const SweepTable mapped = sweep(
      chain, {"PAR(m)=0.28", "--over", "mu=-0.801:-0.797:81", "--follow", "both", "--map", "q.grazing_028:GR1"}, "map");
  const std::vector<Value> map_up = values_of(mapped, 1), map_down = values_of(mapped, 2);
  int coexisting = 0;
  for (std::size_t k = 0; k < map_up.size(); ++k) {
    if (std::abs(map_up[k].mu - contact) > step) CHECK(map_up[k].impacts == (map_up[k].mu > contact ? 1 : 0));
    coexisting += map_up[k].impacts == 0 && map_down[k].impacts == 1;
  }
  CHECK(coexisting > 30);  // 36 of the oscillator; the map's fold is a fifth further away
}

TEST_CASE("rand3d, m = 0.39: no jump, one period more after the other towards mu*, as the composite map has them") {
  const MakefileRun chain("rand3d", "q.grazing_039");
  constexpr double contact = -0.827105485379;
  const SweepTable far = sweep(chain, {"PAR(m)=0.39", "--over", "mu=-0.8271:-0.8235:73", "--penetration", "1"}, "far");
  std::vector<int> order;
  for (const Value& value : values_of(far)) {
    INFO("mu = " << value.mu);
    CHECK(value.impacts == 1);
    if (order.empty() || order.back() != value.period) order.push_back(value.period);
    CHECK(value.penetration < 1.0 * (value.mu - contact));  // small where mu is near
  }
  CHECK(order == std::vector<int>{3, 2, 1});

  // Nearer, where a return takes more of them. The two agree to the size of what order 3/2 leaves out.
  const std::vector<std::string> near = {
      "PAR(m)=0.39", "--over", "mu=-0.8271050:-0.8271010:9", "--follow", "down", "--transient-events", "3000"};
  std::vector<std::string> simulated = near, mapped = near;
  simulated.insert(simulated.end(), {"--penetration", "1", "--tolerance", "1e-12"});
  mapped.insert(mapped.end(), {"--map", "q.grazing_039:GR1"});
  const std::vector<Value> a = values_of(sweep(chain, simulated, "near")),
                           b = values_of(sweep(chain, mapped, "near_map"));
  REQUIRE(a.size() == b.size());
  CHECK(a.front().period == 4);
  CHECK(a.back().period == 3);
  for (std::size_t k = 0; k < a.size(); ++k) {
    INFO("mu = " << a[k].mu);
    CHECK(a[k].impacts >= 1);
    CHECK(a[k].impacts * b[k].period == a[k].period * b[k].impacts);
    if (a[k].period == b[k].period) CHECK(b[k].penetration == Approx(a[k].penetration).epsilon(0.02));
  }
}

TEST_CASE("planar: one attractor through grazing, its multiplier jumps by r^2") {
  const MakefileRun chain("planar", "q.grazing");
  const auto run = [&](std::vector<std::string> words, const std::string& name) {
    words.insert(words.begin(), {"sweep", "planar", "-q", "-p", chain.plugin(), "-o", name, "--over",
                                 "mu=0.998:1.002:20", "--lyapunov"});
    const Outcome outcome = chain.tchat(words);
    INFO(outcome.text());
    REQUIRE(outcome.status == 0);
    const TemporaryFolder copy;
    return read_sweep_file(copy.write(name + ".sweep", chain.read(name + ".sweep")));
  };
  const SweepTable simulated = run({"--penetration", "1"}, "simulated"),
                   mapped = run({"--map", "q.grazing:GR1"}, "mapped");
  const std::vector<Value> a = values_of(simulated), b = values_of(mapped);
  REQUIRE(a.size() == 20);
  REQUIRE(b.size() == 20);
  for (std::size_t k = 0; k < a.size(); ++k) {
    INFO("mu = " << a[k].mu);
    CHECK(a[k].impacts == (a[k].mu > 1.0 ? 1 : 0));
    CHECK(b[k].impacts == a[k].impacts);
    CHECK((a[k].penetration > 0.0) == (a[k].mu > 1.0));
    CHECK(b[k].penetration == Approx(a[k].penetration).epsilon(0.01));
  }
  // exp(lambda T): P_smooth,1 = 8.597e-4 before and r^2 times that behind, where the square root of mu - mu* adds a
  // tenth.
  const auto multiplier = [](const SweepTable& table, const char* exponent, double mu) {
    for (std::size_t row = 0; row < table.rows(); ++row)
      if (std::abs((*table.column("mu"))[row] - mu) < 1e-9)
        return std::exp((*table.column(exponent))[row] * (*table.column("time"))[row]);
    return 0.0;
  };
  const double before = a[9].mu, behind = a[10].mu;
  CHECK(multiplier(simulated, "lambda2", before) == Approx(8.597e-4).epsilon(0.005));
  CHECK(multiplier(mapped, "lambda1", before) == Approx(8.597e-4).epsilon(0.005));
  CHECK(multiplier(simulated, "lambda2", behind) / multiplier(simulated, "lambda2", before) ==
        Approx(0.64).margin(0.1));
  CHECK(multiplier(mapped, "lambda1", behind) == Approx(multiplier(simulated, "lambda2", behind)).epsilon(0.02));
}

TEST_CASE("rand4d: an orbit that is recognised in the first events behind the transient is kept whole") {
  const MakefileRun chain("rand4d", "starts");
  const Outcome outcome = chain.tchat({"sweep", "rand4d", "-q", "-p", chain.plugin(), "PAR(mu)=-5", "--over",
                                       "A=1.26:1.3:5", "--section", "none", "--lyapunov", "3", "-o", "periodic"});
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const TemporaryFolder copy;
  const SweepTable table = read_sweep_file(copy.write("periodic.sweep", chain.read("periodic.sweep")));
  REQUIRE(table.rows() == 5);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    CHECK(table.kinds[row] == AttractorKind::periodic);
    // Of the forcing, as long as nothing doubles; the torus bifurcation is at A = 1.2528620.
    CHECK((*table.column("time"))[row] == Approx(2.0 * M_PI / 1.9).epsilon(1e-6));
  }
}
