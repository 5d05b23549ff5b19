#include "simulate/exponent_measurement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/progress_line.hpp"
#include "motion/chaos_evidence.hpp"
#include "motion/exponent_signs.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr long most_measured = 100000;  // events
constexpr long most_undecided = 16384;  // however small the bars, while they do not tell what the motion is
constexpr long least_measured = 1024;   // so that weighted means of periodic motion have converged

/// With the digits that the bar leaves.
std::string value_text(double value, double error) {
  if (!std::isfinite(value)) return std::isnan(value) ? "nan" : "-infinity";
  const double last = error > 0.0 && std::isfinite(error) ? std::floor(std::log10(error)) : -6.0;
  const int digits = static_cast<int>(std::clamp(1.0 - last, 0.0, 12.0));
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text.find_first_not_of("-0.") == std::string::npos && text.front() == '-') text.erase(0, 1);
  return text;
}

std::string bar_text(double error) {
  if (error == 0.0) return "";
  return std::isfinite(error) ? fmt::format(" +- {:.2g}", error) : " +- unknown";
}

std::string counted(int n, const char* what) { return fmt::format("{} {} exponent{}", n, what, n == 1 ? "" : "s"); }

std::string meaning(const LyapunovSpectrum& spectrum, int section, bool orbit_attracts, const std::string& doubt) {
  const bool has_flow = !spectrum.structural.empty() && section == 0;
  const char* const others = has_flow ? "One zero exponent, the others negative" : "All exponents are negative";
  const ExponentSigns signs = signs_of(spectrum);
  if (orbit_attracts && (signs.positive > 0 || signs.zero > 0 || signs.unclear > 0))
    return "A stable periodic orbit, by its multipliers; the exponents have not converged to ln |multiplier| / period "
           "yet (--time, --events, --accuracy).";
  if (orbit_attracts) return fmt::format("{}: a stable periodic orbit.", others);
  if (signs.positive > 0 && !doubt.empty())
    return fmt::format("{}, but undecided: {}.", counted(signs.positive, "positive"), doubt);
  if (signs.positive > 0) return fmt::format("{}: the motion is chaotic.", counted(signs.positive, "positive"));
  if (signs.unclear > 0)
    return "Undecided: the bars are too large to tell what the motion is; a longer one has smaller bars (--time, "
           "--events, --accuracy).";
  if (signs.zero > 0)
    return fmt::format(
        "{}, none positive: quasi-periodic motion on a torus of dimension {}, if it does not repeat itself.",
        counted(signs.zero + (has_flow ? 1 : 0), "zero"), signs.zero + 1);
  if (signs.negative > 0 && (has_flow || section != 0))
    return fmt::format("{}: a stable periodic orbit, of a longer period than looked for or not reached yet.", others);
  if (signs.negative > 0) return "All exponents are negative: the trajectory converges to an equilibrium.";
  return "The largest exponent is zero: not chaotic; one more (--lyapunov 2) distinguishes periodic from "
         "quasi-periodic "
         "motion.";
}

/// The first of them is that along the flow; there is none on a section.
const char* structural_text(const LyapunovSpectrum& spectrum, int section, Index j) {
  return section == 0 && j == spectrum.structural.front() ? "   along the flow, where it is zero"
                                                          : "   of a state that nothing depends on";
}

std::string losses(const LyapunovSpectrum& spectrum) {
  std::string text;
  const auto lost = (spectrum.exponents.array() == -std::numeric_limits<double>::infinity()).count();
  if (lost > 0)
    text += fmt::format(
        "  -infinity: {} direction{} contracted to zero, where sliding begins, or a jump or a mode drops a state.\n",
        lost, lost == 1 ? " is" : "s are");
  if (spectrum.tangential > 0)
    text += fmt::format(
        "  {} event(s) had almost no velocity: their effect on neighbouring trajectories is known to fewer digits.\n",
        spectrum.tangential);
  return text;
}

std::string ended_text(const SimulationResult& result) {
  if (result.accumulation) return "No Lyapunov exponents: the motion ends where events accumulate.\n";
  if (result.dies_out)
    return "No Lyapunov exponents: the motion dies out; --events or --time computes those of a part of it.\n";
  if (result.last.ended_by == SegmentEnd::interrupted) return "No Lyapunov exponents yet.\n";
  return "No Lyapunov exponents: the motion has ended; --events or --time computes those of a part of it.\n";
}

/// Goes on until the bars are small enough, to the segment `last`; false when it was ended otherwise than by an event.
bool go_on(HybridSimulation& simulation, LyapunovAccumulator& exponents, double accuracy, ProgressLine& line,
           SimulatedSegment& last) {
  exponents.begin();
  long next_look = least_measured;
  for (long done = 1; done <= most_measured; ++done) {
    last = simulation.next(std::numeric_limits<double>::max());
    exponents.pass(last);
    if (last.ended_by != SegmentEnd::event) return false;
    if (line.is_due()) {
      const LyapunovSpectrum now = exponents.spectrum();
      line.show(fmt::format("{} events for exponents, the largest {}{}, bars up to {:.2g} ", done,
                            value_text(now.exponents(0), now.errors(0)), bar_text(now.errors(0)), now.accuracy()));
    }
    if (done < next_look) continue;
    const LyapunovSpectrum spectrum = exponents.spectrum();
    if (spectrum.accuracy() <= accuracy && (signs_of(spectrum).unclear == 0 || done >= most_undecided)) return true;
    next_look += next_look / 4;
  }
  return true;
}

/// Why a positive exponent may be no chaos; "" where it is, or where there is none.
std::string doubt_of_chaos(HybridSimulation& simulation, SimulatedSegment last, LyapunovAccumulator& exponents,
                           const LyapunovSpectrum& spectrum, int section, const SimulationSettings& settings) {
  if (signs_of(spectrum).positive == 0) return "";
  if (last.ended_by == SegmentEnd::end_time) {
    last = simulation.next(std::numeric_limits<double>::max());
    exponents.pass(last);
  }
  if (last.ended_by != SegmentEnd::event) return "the motion ends";
  const double unit = section == 0 ? 1.0 : static_cast<double>(spectrum.events) / spectrum.time;
  return chaos_evidence(simulation, last.end, exponents.growing_direction(), unit * spectrum.exponents.maxCoeff(),
                        settings)
      .doubt;
}

}  // namespace

bool has_wanted_length(const SimulationPlan& plan) { return plan.time || plan.events; }

std::unique_ptr<LyapunovAccumulator> exponents_to_measure(const SimulationRequest& request, const HybridSystem& system,
                                                          const VectorXd& par) {
  if (!request.lyapunov) return nullptr;
  LyapunovSettings settings;
  settings.exponents = *request.lyapunov;
  settings.section = request.section;
  return std::make_unique<LyapunovAccumulator>(system, par, settings);
}

std::string spectrum_text(const HybridSystem& system, const LyapunovSpectrum& spectrum, int section,
                          bool orbit_attracts, const std::string& doubt) {
  if (!spectrum.fault.empty()) return fmt::format("No Lyapunov exponents: {}.\n", spectrum.fault);
  std::string text =
      section == 0 ? fmt::format("Lyapunov exponents per unit of time, of {} events in a time of {:.6g}\n",
                                 spectrum.events, spectrum.time)
                   : fmt::format("Lyapunov exponents per return to {}, of {} returns in a time of {:.6g}\n",
                                 system.function_name(FunctionKind::event, section), spectrum.events, spectrum.time);
  for (Index j = 0; j < spectrum.exponents.size(); ++j)
    text += fmt::format("  {:2}  {}{}{}\n", j + 1, value_text(spectrum.exponents(j), spectrum.errors(j)),
                        bar_text(spectrum.errors(j)),
                        spectrum.is_structural(j) ? structural_text(spectrum, section, j) : "");
  text += losses(spectrum);
  return text + "  " + meaning(spectrum, section, orbit_attracts, doubt) + "\n";
}

std::string exponents_of(const SimulationRequest& request, const SimulationResult& result, HybridSimulation& simulation,
                         LyapunovAccumulator& exponents, bool orbit_attracts, const SimulationSettings& settings,
                         std::ostream* progress) {
  const HybridSystem& system = simulation.system();
  const bool goes_on = !has_wanted_length(request.plan);
  if (goes_on && (result.last.ended_by != SegmentEnd::event || result.accumulation || result.dies_out))
    return ended_text(result);
  std::string remark;
  SimulatedSegment last = result.last;
  if (goes_on) {
    ProgressLine line(progress);
    if (!go_on(simulation, exponents, request.accuracy, line, last))
      remark = "  The simulation has ended before the bars were small enough.\n";
  }
  const LyapunovSpectrum spectrum = exponents.spectrum();
  if (goes_on && remark.empty() && spectrum.accuracy() > request.accuracy)
    remark =
        fmt::format("  After {} events a bar is still above {:g} (--accuracy); --events or --time simulate longer.\n",
                    spectrum.events, request.accuracy);
  const std::string doubt =
      orbit_attracts ? "" : doubt_of_chaos(simulation, last, exponents, spectrum, request.section, settings);
  return spectrum_text(system, spectrum, request.section, orbit_attracts, doubt) + remark;
}

}  // namespace tchat
