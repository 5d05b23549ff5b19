#include "attractor/attractor_recognition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/found_orbit.hpp"
#include "simulation/recurrence.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Exponents = RecognitionSettings::Exponents;

constexpr double bars_of_zero = 3.0;
constexpr double small_bar = 0.002;    // against the largest exponent or the frequency of events: chaos may be weak
constexpr long first_decision = 64;    // events after which exponents may decide
constexpr double resting_rate = 1e-6;  // |f| / (1 + |x|)
constexpr long most_for_exponents = 10000;

/// Stops a simulation whose state goes beyond all bounds.
class EscapeWatch {
 public:
  EscapeWatch(const HybridSystem& system, const VectorXd& x0, const VectorXd& par, double bound)
      : system_(system), x0_(x0), par_(par), bound_(bound) {}

  void look(const double* x) {
    const Eigen::Map<const VectorXd> state(x, x0_.size());
    if (has_escaped_ || !(state.lpNorm<Eigen::Infinity>() > bound_)) return;
    const std::vector<bool> ignorable = ignorable_states(system_, {x0_, state}, par_);
    for (Index i = 0; i < state.size(); ++i)
      if (!ignorable[static_cast<std::size_t>(i)] && std::abs(state(i)) > bound_) has_escaped_ = true;
  }
  bool has_escaped() const { return has_escaped_; }

 private:
  const HybridSystem& system_;
  VectorXd x0_;
  const VectorXd& par_;
  double bound_;
  bool has_escaped_ = false;
};

bool is_at_rest(const HybridSystem& system, const SimulatedSegment& last, const VectorXd& par) {
  VectorXd f(last.end.size());
  system.value(FunctionKind::field, last.mode.field(), last.end.data(), par.data(), f.data());
  return f.norm() <= resting_rate * (1.0 + last.end.norm());
}

void be(Attractor& attractor, AttractorKind kind, std::string reason) {
  attractor.kind = kind;
  attractor.reason = std::move(reason);
}

std::string exponents_text(const LyapunovSpectrum& spectrum) {
  std::string text;
  for (Index j = 0; j < std::min<Index>(2, spectrum.exponents.size()); ++j)
    text += fmt::format("{}{:.4g} (bar {:.1g})", j > 0 ? ", " : "", spectrum.exponents(j), spectrum.errors(j));
  return text;
}

void be_periodic(Attractor& attractor, std::vector<SimulatedSegment> turn) {
  attractor.turn = in_standard_order(std::move(turn), IndexVector{0, 0, 0});
  attractor.period = 0.0;
  for (const SimulatedSegment& segment : attractor.turn) {
    attractor.signature.push_back(segment.index);
    attractor.period += segment.duration;
  }
  attractor.state = attractor.turn.front().start;
  be(attractor, AttractorKind::periodic, fmt::format("repeats itself after {} event(s)", attractor.turn.size()));
}

/// What ended the simulation before its length. False: nothing did.
bool be_ended(Attractor& attractor, const SimulationResult& result, const HybridSystem& system, const VectorXd& par) {
  const SimulatedSegment& last = result.last;
  if (result.accumulation) {
    be(attractor, AttractorKind::chattering,
       fmt::format("events accumulate, at t = {:.9g}", last.end_time() + result.accumulation->remaining));
    return true;
  }
  if (result.dies_out) {
    be(attractor, AttractorKind::rest, "the events get slower and slower");
    return true;
  }
  switch (last.ended_by) {
    case SegmentEnd::sticks:
      be(attractor, AttractorKind::chattering, last.message);
      return true;
    case SegmentEnd::no_event:
      if (is_at_rest(system, last, par))
        be(attractor, AttractorKind::rest, "the field is zero where it has come to");
      else
        be(attractor, AttractorKind::escape, last.message);
      return true;
    case SegmentEnd::failed:
    case SegmentEnd::interrupted:
      be(attractor, AttractorKind::none, last.message);
      return true;
    default:
      return false;
  }
}

void be_by_exponents(Attractor& attractor, const LyapunovSpectrum& spectrum, int max_period) {
  const std::string text = exponents_text(spectrum);
  switch (kind_by_exponents(spectrum)) {
    case AttractorKind::chaotic:
      return be(attractor, AttractorKind::chaotic, fmt::format("the largest exponents are {}", text));
    case AttractorKind::quasi_periodic:
      return be(attractor, AttractorKind::quasi_periodic, fmt::format("the largest exponents are {}", text));
    case AttractorKind::rest:
      return be(attractor, AttractorKind::rest, fmt::format("all exponents are negative, {} at first", text));
    case AttractorKind::periodic:
      return be(attractor, AttractorKind::none,
                fmt::format("exponents as of a periodic orbit, {}, and no repetition after 1 to {} events: the period "
                            "is longer, or the motion has not settled",
                            text, max_period));
    default:
      return be(attractor, AttractorKind::none,
                fmt::format("no repetition after 1 to {} events, and the exponents do not tell: {}{}", max_period, text,
                            spectrum.fault));
  }
}

/// Goes on until the exponents tell, at most so many events.
void go_on(HybridSimulation& simulation, LyapunovAccumulator& exponents, long most, Attractor& attractor) {
  exponents.begin();
  long decision = first_decision;
  for (long done = 1; done <= most; ++done) {
    attractor.last = simulation.next(std::numeric_limits<double>::max());
    exponents.pass(attractor.last);
    if (attractor.last.ended_by != SegmentEnd::event) return;
    ++attractor.events;
    if (done < decision) continue;
    if (kind_by_exponents(exponents.spectrum()) != AttractorKind::none) return;
    decision *= 2;
  }
}

}  // namespace

ExponentSigns signs_of(const LyapunovSpectrum& spectrum) {
  ExponentSigns signs;
  double scale = spectrum.time > 0.0 ? static_cast<double>(spectrum.events) / spectrum.time : 0.0;
  for (const double exponent : spectrum.exponents)
    if (std::isfinite(exponent)) scale = std::max(scale, std::abs(exponent));
  for (Index j = 0; j < spectrum.exponents.size(); ++j) {
    const double exponent = spectrum.exponents(j);
    const double zero = bars_of_zero * spectrum.errors(j);
    if (exponent > zero)
      ++signs.positive;
    else if (exponent < -zero)
      ++signs.negative;
    else if (spectrum.errors(j) < small_bar * scale)
      ++signs.zero;
    else
      ++signs.unclear;
  }
  return signs;
}

AttractorKind kind_by_exponents(const LyapunovSpectrum& spectrum) {
  const ExponentSigns signs = signs_of(spectrum);
  if (signs.positive > 0) return AttractorKind::chaotic;
  if (signs.unclear > 0) return AttractorKind::none;
  if (signs.zero >= 2) return AttractorKind::quasi_periodic;
  if (signs.zero == 0 && signs.negative > 0) return AttractorKind::rest;
  return signs.zero == 1 && signs.negative > 0 ? AttractorKind::periodic : AttractorKind::none;
}

Attractor recognise_attractor(const ModeRule& rule, const VectorXd& x0, const VectorXd& par,
                              const SimulationSettings& given, const RecognitionSettings& settings,
                              const std::function<void(const SimulatedSegment&)>& kept) {
  const HybridSystem& system = rule.system();
  if (settings.lyapunov.section != 0)
    throw UserError("a motion is recognised by the exponents of its flow, not by those of a section");
  SimulationSettings simulated = given;
  LyapunovAccumulator exponents(system, par, settings.lyapunov);
  if (settings.exponents != Exponents::never) exponents.attach(simulated);
  EscapeWatch escape(system, x0, par, settings.escape);
  simulated.on_piece = [&escape, carry = simulated.on_piece](int field, const DenseOutput& state, double from,
                                                             double to) {
    escape.look(state(to));
    if (carry && !escape.has_escaped()) carry(field, state, from, to);
  };
  simulated.interrupted = [&escape, &given] {
    return escape.has_escaped() || (given.interrupted && given.interrupted());
  };

  // A simulation that ends in the middle of a segment cannot be gone on with.
  const bool at_once = settings.exponents == Exponents::always ||
                       (settings.exponents == Exponents::to_decide && settings.plan.time.has_value());
  HybridSimulation simulation(rule, x0, par, simulated);
  const SimulationResult result = run_simulation(simulation, settings.plan, [&](const SimulatedSegment& segment) {
    if (at_once) exponents.pass(segment);
    if (kept) kept(segment);
  });

  Attractor attractor;
  attractor.period = std::numeric_limits<double>::quiet_NaN();
  attractor.last = result.last;
  attractor.events = result.events;
  const bool has_ended = be_ended(attractor, result, system, par);
  const bool to_decide = settings.exponents == Exponents::to_decide && !at_once && !has_ended && !result.is_periodic();
  if (to_decide) go_on(simulation, exponents, settings.plan.events.value_or(most_for_exponents), attractor);
  if (at_once || to_decide) attractor.spectrum = exponents.spectrum();
  attractor.time = attractor.last.end_time();
  attractor.state = attractor.last.ended_by == SegmentEnd::event ? attractor.last.after : attractor.last.end;
  if (escape.has_escaped()) {
    be(attractor, AttractorKind::escape, fmt::format("a state exceeds {:g}", settings.escape));
  } else if (result.is_periodic()) {
    be_periodic(attractor, result.turn);
  } else if (!has_ended && to_decide && attractor.last.ended_by == SegmentEnd::interrupted) {
    be(attractor, AttractorKind::none, attractor.last.message);
  } else if (!has_ended && attractor.spectrum) {
    be_by_exponents(attractor, *attractor.spectrum, settings.plan.max_period);
  } else if (!has_ended) {
    be(attractor, AttractorKind::none, fmt::format("no repetition after 1 to {} events", settings.plan.max_period));
  }
  return attractor;
}

}  // namespace tchat
