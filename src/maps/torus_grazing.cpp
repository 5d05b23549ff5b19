#include "maps/torus_grazing.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "base/user_error.hpp"
#include "maps/circle.hpp"
#include "model/event_at.hpp"
#include "motion/mode_rule.hpp"
#include "motion/segment_flow.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

/// Longest way from the section to P, as a share of the time of a return, on which x* is looked for; and at which it
/// counts as lying on the section.
constexpr double search_share = 0.1;
constexpr double on_section_share = 1e-3;

/// The trajectory through a point of the curve where it meets P.
struct Least {
  double phi = 0.0, time = 0.0;
  VectorXd x;
  double h = 0.0;
  double slope = 0.0;  // d h / d phi
};

class LeastDistance {
 public:
  LeastDistance(const HybridSystem& system, const TorusReturn& torus, int field, int wall)
      : system_(system), torus_(torus), field_(field), wall_(wall) {}

  /// h_D where P is met, as a parabola in time from u(phi) tells; nothing where P is far or h_D has a maximum there.
  std::optional<double> estimate(double phi) const {
    const VectorXd x = torus_.on_curve(phi);
    const Surface at = surface(x);
    if (!(at.a > 0.0) || std::abs(at.rate / at.a) > search_share * torus_.mean_time()) return std::nullopt;
    return at.h - 0.5 * at.rate * at.rate / at.a;
  }

  Least at(double phi) const {
    Least least{phi, 0.0, torus_.on_curve(phi), 0.0, 0.0};
    const VectorXd start = least.x;
    Eigen::MatrixXd flow = Eigen::MatrixXd::Identity(start.size(), start.size());
    for (int iteration = 0; iteration < 10; ++iteration) {
      const Surface now = surface(least.x);
      const double step = -now.rate / now.a;
      if (std::abs(step) <= 1e-14 * torus_.mean_time()) break;
      least.time += step;
      FlowOptions options;
      const SegmentFlow moved = integrate_for(system_, field_, start, torus_.parameters(), least.time, options);
      if (moved.status == FlowStatus::failed) throw ComputationError(moved.message);
      least.x = moved.end_state;
      flow = moved.jacobian;
    }
    const EventAt event = event_at(system_, wall_, least.x.data(), torus_.parameters().data());
    least.h = event.h;
    least.slope = event.gradient.dot(flow * torus_.curve().derivative(phi));
    return least;
  }

 private:
  struct Surface {
    double h, rate, a;  // h_D, h_P, h_{P,x} f
  };
  Surface surface(const VectorXd& x) const {
    const EventAt at = event_at(system_, wall_, field_, x.data(), torus_.parameters().data());
    return {at.h, at.rate(), rate_gradient(system_, at, wall_, field_, x.data(), torus_.parameters().data()).dot(at.f)};
  }

  const HybridSystem& system_;
  const TorusReturn& torus_;
  int field_, wall_;
};

}  // namespace

TorusGrazing torus_grazing(const HybridSystem& system, const TorusReturn& torus, int field, int wall, int parameter,
                           const std::string& source) {
  const LeastDistance distance(system, torus, field, wall);
  const int samples = std::max(1000, 16 * torus.curve().harmonics());
  double guess = -1.0, least_h = std::numeric_limits<double>::infinity();
  for (int k = 0; k < samples; ++k) {
    const double phi = static_cast<double>(k) / samples;
    const std::optional<double> h = distance.estimate(phi);
    if (h && *h < least_h) least_h = *h, guess = phi;
  }
  const std::string wall_name = system.function_name(FunctionKind::event, wall);
  if (guess < 0.0)
    throw UserError(
        fmt::format("{}: nowhere near this section is event {} ({}) least along a trajectory; take the "
                    "section where it is least, or one through that point",
                    source, wall, wall_name));
  // The zero of the slope between the neighbours of the least sample.
  double low = guess - 1.0 / samples, high = guess + 1.0 / samples;
  Least at_low = distance.at(low), at_high = distance.at(high);
  if (!(at_low.slope < 0.0 && at_high.slope > 0.0))
    throw UserError(
        fmt::format("{}: the section does not pass through the point of the torus nearest to event {} ({}): the "
                    "least value seen near the section, {:.6g}, is at x = {}, at the end of where it can be "
                    "seen; put the section there",
                    source, wall, wall_name, least_h, state_text(distance.at(guess).x)));
  Least best = distance.at(guess);
  for (int iteration = 0; iteration < 60 && std::abs(high - low) > 1e-14; ++iteration) {
    // Regula falsi, with a bisection every third time.
    const double share = iteration % 3 == 2 ? 0.5 : at_low.slope / (at_low.slope - at_high.slope);
    best = distance.at(low + share * (high - low));
    if (best.slope == 0.0) break;
    (best.slope < 0.0 ? low : high) = best.phi;
    (best.slope < 0.0 ? at_low : at_high) = best;
  }
  if (std::abs(best.time) > on_section_share * torus.mean_time())
    throw UserError(
        fmt::format("{}: the section does not pass through the grazing point x* = {}, which is met {:.2g} {} "
                    "it; put the section there (a parameter of it, perhaps) and simulate again",
                    source, state_text(best.x), std::abs(best.time), best.time > 0.0 ? "after" : "before"));

  TorusGrazing grazing{phase_fraction(best.phi), best.time, best.x, torus.parameters()};
  const std::vector<int> active{parameter};
  for (int iteration = 0; iteration < 20; ++iteration) {
    double h = 0.0, hp = 0.0;
    VectorXd hx(grazing.x.size());
    system.first(FunctionKind::event, wall, grazing.x.data(), grazing.par.data(), active, &h, hx.data(), &hp);
    if (!(std::abs(hp) > 1e-12))
      throw UserError(
          fmt::format("{}: event {} ({}) does not depend on {}, so that it cannot bring the wall to the torus; "
                      "sweep a parameter of the wall, or give the torus in contact",
                      source, wall, wall_name, system.parameter_name(parameter)));
    const double step = -h / hp;
    grazing.par(parameter - 1) += step;
    if (std::abs(step) <= 1e-15 * (1.0 + std::abs(grazing.par(parameter - 1)))) break;
  }
  return grazing;
}

}  // namespace tchat
