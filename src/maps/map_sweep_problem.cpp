#include "maps/map_sweep_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/messages.hpp"
#include "files/dat_file.hpp"
#include "files/point_file.hpp"
#include "simulate/simulation_start.hpp"
#include "simulate/sweep_job.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index compared_sections = 32;  // of a motion that does not repeat itself, by which it is known

/// The period begins where its sequence of index vectors is least; among equal ones where the state is.
Index least_rotation(const Signature& signature, const Eigen::MatrixXd& points) {
  const std::size_t m = signature.size();
  const auto is_less = [&](std::size_t a, std::size_t b) {
    for (std::size_t s = 0; s < m; ++s) {
      const IndexVector& u = signature[(a + s) % m];
      const IndexVector& v = signature[(b + s) % m];
      if (u != v) return u < v;
    }
    const VectorXd x = points.col(static_cast<Index>(a)), y = points.col(static_cast<Index>(b));
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  };
  std::size_t least = 0;
  for (std::size_t s = 1; s < m; ++s)
    if (is_less(s, least)) least = s;
  return static_cast<Index>(least);
}

template <class Vector>
void rotate_columns(Vector& v, Index first) {
  const Vector old = v;
  for (Index k = 0; k < v.cols(); ++k) v.col(k) = old.col((k + first) % v.cols());
}

void describe_period(const MapModel& model, const MapAttractor& attractor, AttractorSample& sample) {
  for (const bool touches : attractor.contacts) {
    sample.signature.push_back(touches ? model.contact : model.free);
    if (touches) ++sample.impacts;
  }
  const Index first = least_rotation(sample.signature, sample.sections);
  std::rotate(sample.signature.begin(), sample.signature.begin() + first, sample.signature.end());
  rotate_columns(sample.sections, first);
  Eigen::RowVectorXd penetrations = sample.section_penetrations.transpose();
  rotate_columns(penetrations, first);
  sample.section_penetrations = penetrations.transpose();
  sample.period = attractor.time;
  sample.last.x = sample.sections.col(0);
}

}  // namespace

AttractorSample MapSampler::operator()(const SweepPoint& point, const std::function<bool()>& interrupted) const {
  ParameterVector par = model_.par;
  VectorXd x = point.at ? point.at->x : setup_.starts[static_cast<std::size_t>(point.start - 1)];
  set_swept_values(setup_.over, point.values, x, par);
  MapIteration iteration = setup_.iteration;
  iteration.interrupted = interrupted;
  MapAttractor attractor;
  try {
    attractor = iterate_to_attractor(*map_, x, par, iteration);
  } catch (const ComputationError&) {
    if (interrupted && interrupted()) throw SampleInterrupted();
    throw;
  }
  AttractorSample sample;
  sample.kind = attractor.kind;
  sample.message = attractor.message;
  if (attractor.period > 0) sample.impacts = 0;
  sample.sizes = map_->smooth().extent();
  sample.sections = attractor.points;
  sample.section_penetrations = attractor.penetrations;
  if (attractor.kind != AttractorKind::escape) sample.last.x = attractor.last;
  if (attractor.period > 0) describe_period(model_, attractor, sample);
  for (const double penetration : attractor.penetrations)
    if (std::isfinite(penetration)) sample.penetration = std::fmax(sample.penetration, penetration);
  sample.identity = attractor.period > 0
                        ? sample.sections
                        : sample.sections.leftCols(std::min(compared_sections, sample.sections.cols()));
  if (attractor.spectrum && setup_.iteration.exponents > 0) {
    const Index count = std::min<Index>(setup_.iteration.exponents, attractor.spectrum->exponents.size());
    sample.exponents = attractor.spectrum->exponents.head(count);
    sample.errors = attractor.spectrum->errors.head(count);
  }
  return sample;
}

namespace {

void refuse_options_of_simulations(const SweepRequest& request) {
  const SimulationRequest& s = request.simulation;
  const auto refuse = [](bool given, const char* option, const char* instead) {
    if (given)
      throw UserError(
          fmt::format("--map and {} are both given: a map is iterated, nothing is simulated; {}", option, instead));
  };
  refuse(s.data.has_value(), "-d", "give a section state with --state, or leave it out and start at the grazing point");
  refuse(s.start.has_value(), "-s",
         "give a section state with --state, or leave it out and start at the grazing point");
  refuse(s.plan.time.has_value(), "--time", "give the number of returns with --events");
  refuse(s.plan.transient_time > 0.0, "--transient-time", "give the number of returns with --transient-events");
  refuse(s.signature.has_value() || s.follow_signature, "--signature", "leave it out");
  refuse(s.modes.has_value(), "--mode", "leave it out");
  refuse(request.largest, "--max", "leave it out");
}

std::vector<int> swept_parameters(const std::vector<SweepTarget>& over) {
  std::vector<int> swept;
  for (const SweepTarget& target : over)
    if (!target.quantity.is_state) swept.push_back(target.position);
  if (swept.empty())
    throw UserError(
        "--map: no parameter is swept; a composite map is followed away from grazing in one: give it as an "
        "--over, as --over mu=-0.8:-0.79:101, also beside an initial state");
  return swept;
}

MapContext context_of(const SweepRequest& request, const LoadedProblem& loaded, const std::vector<int>& swept) {
  const HybridSystem& system = loaded.library->system();
  MapContext context;
  context.par = initial_parameters(system);
  ParameterVector marked = context.par;
  marked.setConstant(NAN);
  apply_command_line(system, loaded.constants.settings, marked);
  apply_command_line(system, loaded.constants.settings, context.par);
  for (int k = 1; k <= system.parameters(); ++k)
    if (!std::isnan(marked(k - 1))) context.given.push_back(k);
  context.swept = swept;
  context.constants = request.simulation.constants;
  context.settings = loaded.constants.settings;
  context.section = request.section;
  return context;
}

void add_starts(const SweepRequest& request, const LoadedProblem& loaded, const MapModel& model, MapSamplerSetup& setup,
                SweepJob& job) {
  const HybridSystem& system = loaded.library->system();
  std::vector<VectorXd> states;
  for (const std::string& text : request.states) {
    SimulationRequest own = request.simulation;
    own.state = text;
    states.push_back(simulation_start(own, loaded.constants, system).state);
  }
  if (states.empty()) states.push_back(model.point.x);
  for (const VectorXd& state : states) add_start(request, state, job, [&] { setup.starts.push_back(state); });
}

MapIteration iteration_of(const SweepRequest& request, const HybridSystem& system, bool is_reduced) {
  const SimulationPlan& plan = request.simulation.plan;
  MapIteration iteration;
  iteration.transient = plan.transient_events;
  iteration.returns = plan.events.value_or(100);
  iteration.max_period = plan.max_period;
  iteration.recognition = plan.recognition;
  if (!request.exponents) return iteration;
  const int most = is_reduced ? 1 : system.dimension() - 1;
  if (*request.exponents > most)
    throw UserError(fmt::format("--lyapunov {}: the map has {} exponent{}; give 1{}", *request.exponents, most,
                                most > 1 ? "s" : "", most > 1 ? fmt::format(" to {}", most) : ""));
  iteration.exponents = *request.exponents > 0 ? *request.exponents : most;
  return iteration;
}

/// What the results of iterations depend on beside what every sweep does.
void add_identity(const MapRequest& map, const MapModel& model, const MapIteration& i, SweepIdentity& identity) {
  const auto add = [&](const char* key, std::string value) { identity.emplace_back(key, std::move(value)); };
  add("map", model.identity);
  add("order", fmt::format("{}, smooth {}", map.order, map.smooth_order));
  add("reduced", map.reduced.value_or("no"));
  add("neighbourhood", fmt::format("{}", model.neighbourhood));
  add("returns", fmt::format("{} after {}, period at most {}, recognised to {}", i.returns, i.transient, i.max_period,
                             i.recognition));
  add("exponents", fmt::format("{}", i.exponents));
}

}  // namespace

int map_sweep_problem(const SweepRequest& request, const MapRequest& map, const SweepConsole& console) {
  const SweepTask task = sweep_task(request);
  refuse_options_of_simulations(request);
  map_order(map.order);
  const LoadedProblem loaded = load_for_simulation(request.simulation, console.progress);
  const HybridSystem& system = loaded.library->system();

  MapSamplerSetup setup;
  setup.over = swept_targets(system, request);
  setup.iteration = iteration_of(request, system, map.reduced.has_value());
  const MapModel model = map_model(map, context_of(request, loaded, swept_parameters(setup.over)), system);
  SweepJob job;
  add_starts(request, loaded, model, setup, job);
  fill_heading(loaded, setup.over, model.par, job);
  job.columns.penetration = true;
  job.columns.exponents = setup.iteration.exponents;
  job.columns.states = ProblemNames::of(system).states;
  add_identity(map, model, setup.iteration, job.identity);
  if (!request.simulation.quiet)
    for (const std::string& line : model.text) console.screen << line << '\n';
  const auto sampler_of = [&](const HybridSystem& own) {
    return MapSampler(setup, model, iterated_map(map, model, own));
  };
  run_with_workers(job, task, request, loaded, sampler_of, console);
  return 0;
}

}  // namespace tchat
