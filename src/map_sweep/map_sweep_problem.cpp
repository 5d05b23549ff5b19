#include "map_sweep/map_sweep_problem.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>
#include <vector>

#include "map_sweep/map_model.hpp"
#include "map_sweep/map_sampler.hpp"
#include "setup/parameter_values.hpp"
#include "simulate/loaded_problem.hpp"
#include "simulate/simulation_start.hpp"
#include "sweep/sweep_job.hpp"
#include "sweep/sweep_setup.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

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
  const ParameterVector before = ParameterVector::Constant(context.par.size(), NAN);
  ParameterVector marked = before;
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
  for (const VectorXd& state : states)
    for (const Following direction : follow_directions(request.follow)) {
      setup.starts.push_back(state);
      job.following.push_back(direction);
      std::string text = fmt::format("x = ({})", fmt::join(state.begin(), state.end(), ", "));
      if (direction != Following::none)
        text = fmt::format("{} from {}", direction == Following::up ? "up" : "down", text);
      job.heading.starts.push_back(std::move(text));
    }
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

SweepIdentity identity_of(const LoadedProblem& loaded, const MapRequest& map, const MapModel& model,
                          const MapSamplerSetup& setup, const SweepJob& job) {
  SweepIdentity identity;
  const auto add = [&](const char* key, std::string value) { identity.emplace_back(key, std::move(value)); };
  add("problem", loaded.library->system().name());
  add("plugin", plugin_identity(loaded.plugin));
  for (const SweepTarget& target : setup.over)
    add("over", fmt::format("{} {} {} {}", target.quantity.column(), target.quantity.from, target.quantity.to,
                            target.quantity.count));
  for (const std::string& start : job.heading.starts) add("start", start);
  add("map", model.identity);
  add("order", fmt::format("{}, smooth {}", map.order, map.smooth_order));
  add("reduced", map.reduced.value_or("no"));
  add("neighbourhood", fmt::format("{}", model.neighbourhood));
  for (const auto& [name, value] : job.heading.parameters) add("parameter", fmt::format("{} {}", name, value));
  const MapIteration& i = setup.iteration;
  add("returns", fmt::format("{} after {}, period at most {}, recognised to {}", i.returns, i.transient, i.max_period,
                             i.recognition));
  add("exponents", fmt::format("{}", i.exponents));
  return identity;
}

}  // namespace

int map_sweep_problem(const SweepRequest& request, const MapRequest& map, std::ostream& screen, std::ostream& warnings,
                      const std::function<bool()>& interrupted, std::ostream* progress) {
  SweepTask task = sweep_task(request);
  follow_directions(request.follow);
  refuse_options_of_simulations(request);
  map_order(map.order);
  const LoadedProblem loaded = load_for_simulation(request.simulation, progress);
  const HybridSystem& system = loaded.library->system();
  limit_workers(loaded, task, warnings);

  MapSamplerSetup setup;
  setup.over = parse_overs(system, request.over);
  if (!request.follow.empty() && setup.over.front().quantity.is_state)
    throw UserError(
        fmt::format("--follow {}: attractors are followed along a parameter, and {} is an initial state; give "
                    "a parameter as the first --over, or leave --follow out",
                    request.follow, setup.over.front().quantity.name));
  setup.iteration = iteration_of(request, system, map.reduced.has_value());
  const MapModel model = map_model(map, context_of(request, loaded, swept_parameters(setup.over)), system);
  SweepJob job;
  add_starts(request, loaded, model, setup, job);
  fill_heading(system, setup.over, model.par, job);
  job.columns.penetration = true;
  job.columns.exponents = setup.iteration.exponents;
  for (int k = 1; k <= system.dimension(); ++k) job.columns.states.push_back(system.state_name(k));
  job.identity = identity_of(loaded, map, model, setup, job);
  if (!request.simulation.quiet)
    for (const std::string& line : model.text) screen << line << '\n';

  const int count = task.gather ? 1 : task.workers;
  const WorkerSystems workers(loaded, request.simulation, count);
  std::vector<MapSampler> samplers;
  for (int worker = 0; worker < count; ++worker)
    samplers.emplace_back(setup, model, iterated_map(map, model, workers.system(worker)));
  const StopFlag stop(interrupted);
  job.maker = maker_of(samplers, stop);
  run_and_tell(job, task, loaded, stop, progress, screen, warnings, request.simulation.quiet);
  return 0;
}

}  // namespace tchat
