#include "benchmark/sweep_times.hpp"

#include <fmt/format.h>

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "benchmark/chain_files.hpp"
#include "benchmark/child_process.hpp"
#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

namespace odeint = boost::numeric::odeint;

using State = std::array<double, 4>;

constexpr int transient_events = 1000, recorded_events = 100;
constexpr double zeta = 0.05, restitution = 0.8, tolerance = 1e-8;

struct Range {
  const char* what;
  const char* name;  // of the swept parameter
  double from, to;
  double other;  // value of alpha or omega, whichever is not swept
};

struct Oscillator {
  double alpha, omega;
  void operator()(const State& x, State& slope, double) const {
    const double square = x[2] * x[2] + x[3] * x[3];
    slope = {x[1], alpha * x[3] - 2.0 * zeta * x[1] - x[0], x[2] + omega * x[3] - x[2] * square,
             x[3] - omega * x[2] - x[3] * square};
  }
};

/// 1 at the wall, 2 at a maximum of the displacement; both fall to zero.
double event(int j, const State& x) { return j == 1 ? 1.0 - x[0] : x[1]; }

/// The time between a and b at which the event function falls to zero.
template <class Stepper>
double time_of_event(Stepper& stepper, int j, double a, double b, double at_a, double at_b) {
  State x;
  for (int k = 0; k < 60 && b - a > 1e-14 * b; ++k) {
    const double t = b - at_b * (b - a) / (at_b - at_a);
    stepper.calc_state(t, x);
    const double value = event(j, x);
    if (std::abs(value) < 1e-14) return t;
    if (value > 0.0)
      a = t, at_a = value, at_b *= 0.5;
    else
      b = t, at_b = value, at_a *= 0.5;
  }
  return b;
}

/// From a state to the next event: its number, with the state there.
template <class Stepper>
int next_event(Stepper& stepper, const Oscillator& oscillator, State& x) {
  stepper.initialize(x, 0.0, 0.01);
  std::array<double, 3> before{0.0, event(1, x), event(2, x)};
  while (true) {
    const auto [begin, end] = stepper.do_step(oscillator);
    int hit = 0;
    double first = end;
    for (int j = 1; j <= 2; ++j) {
      const double at_begin = before[static_cast<std::size_t>(j)], at_end = event(j, stepper.current_state());
      before[static_cast<std::size_t>(j)] = at_end;
      if (!(at_begin > 1e-12 && at_end <= 0.0)) continue;
      const double t = time_of_event(stepper, j, begin, end, at_begin, at_end);
      if (hit == 0 || t < first) hit = j, first = t;
    }
    if (hit == 0) continue;
    stepper.calc_state(first, x);
    return hit;
  }
}

double swept(const Range& range, int k, int values) { return range.from + (range.to - range.from) * k / (values - 1); }

/// The velocities of the impacts among the last events, of the last value.
std::vector<double> loop_by_hand(const Range& range, int values) {
  std::vector<double> velocities;
  for (int k = 0; k < values; ++k) {
    const double value = swept(range, k, values);
    const Oscillator oscillator =
        range.name == std::string("alpha") ? Oscillator{value, range.other} : Oscillator{range.other, value};
    auto stepper = odeint::make_dense_output(0.1 * tolerance, tolerance, odeint::runge_kutta_dopri5<State>());
    State x{0.0, 0.0, 0.0, 1.0};
    velocities.clear();
    for (int e = 0; e < transient_events + recorded_events; ++e) {
      if (next_event(stepper, oscillator, x) != 1) continue;
      if (e >= transient_events) velocities.push_back(x[1]);
      x[1] *= -restitution;
    }
  }
  return velocities;
}

class TchatSweep {
 public:
  TchatSweep(const Range& range, int values, bool with_exponents) {
    const std::string other = range.name == std::string("alpha") ? "omega" : "alpha";
    command_ = {tchat_executable(),
                "sweep",
                std::string(PROBLEMS_FOLDER) + "/linosc/linosc",
                "-q",
                "--fresh",
                "-o",
                "timed",
                "--over",
                fmt::format("{}={}:{}:{}", range.name, range.from, range.to, values),
                "--section",
                "wall",
                fmt::format("PAR({})={}", other, range.other),
                "--state",
                "0,0,0,1"};
    if (with_exponents)
      command_.emplace_back("--lyapunov");
    else
      command_.insert(command_.end(), {"--transient-events", fmt::format("{}", transient_events), "--events",
                                       fmt::format("{}", recorded_events)});
    run();  // compiles the plugin
  }
  double run() const { return run_child(command_, folder_.path()).processor; }

  /// The velocity of the last row.
  double last_velocity() const {
    std::ifstream in(folder_.path() / "timed.sweep");
    std::string last;
    for (std::string line; std::getline(in, line);)
      if (!line.empty()) last = line;
    std::istringstream words(last);
    std::vector<std::string> all;
    for (std::string word; words >> word;) all.push_back(word);
    return all.size() < 4 ? NAN : std::stod(all[all.size() - 3]);
  }

 private:
  ScratchFolder folder_;
  std::vector<std::string> command_;
};

double distance_to_nearest(const std::vector<double>& velocities, double value) {
  double nearest = NAN;
  for (const double v : velocities) nearest = std::fmin(nearest, std::abs(v - value));
  return nearest;
}

}  // namespace

void print_sweep_times(int values, int rounds) {
  constexpr Range ranges[] = {{"periodic", "alpha", 3.1, 3.3, 2.0072}, {"chaotic", "omega", 2.425, 2.475, 3.0}};
  fmt::print("(k) Sweeps: processor time of a value, {} values, median of {} alternating runs\n\n", values, rounds);
  fmt::print("{:>10}{:>16}{:>16}{:>10}{:>22}{:>10}{:>14}\n", "motion", "by hand [ms]", "tchat [ms]", "ratio",
             "with exponents [ms]", "ratio", "difference");
  for (const Range& range : ranges) {
    const TchatSweep plain(range, values, false), with_exponents(range, values, true);
    std::vector<double> by_hand, ours, ours_with, ratios, ratios_with;
    std::vector<double> velocities;
    for (int round = 0; round < rounds; ++round) {
      by_hand.push_back(processor_seconds([&] { velocities = loop_by_hand(range, values); }) / values);
      ours.push_back(plain.run() / values);
      ours_with.push_back(with_exponents.run() / values);
      ratios.push_back(ours.back() / by_hand.back());
      ratios_with.push_back(ours_with.back() / by_hand.back());
    }
    const double difference = distance_to_nearest(velocities, plain.last_velocity());
    fmt::print("{:>10}{:>16.2f}{:>16.2f}{:>10.2f}{:>22.2f}{:>10.2f}{:>14.1e}\n", range.what, 1e3 * median(by_hand),
               1e3 * median(ours), median(ratios), 1e3 * median(ours_with), median(ratios_with), difference);
    std::fflush(stdout);
  }
  fmt::print("\n");
}

}  // namespace tchat::benchmark
