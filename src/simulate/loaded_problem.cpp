#include "simulate/loaded_problem.hpp"

#include "plugin/plugin_build.hpp"
#include "plugin/problem_setup.hpp"

namespace tchat {

LoadedProblem load_for_simulation(const SimulationRequest& request, std::ostream* progress) {
  LoadedProblem loaded;
  loaded.plugin = resolve_plugin(request.problem.value_or(request.name), {.progress = progress});
  SimulationConstants constants = read_simulation_constants(request);
  loaded.library = std::make_unique<ProblemLibrary>(
      loaded.plugin, [&] { return sizes_of(request, with_signature(request, constants)); });
  loaded.library->add_section();
  const HybridSystem& system = loaded.library->system();
  resolve_names(constants.settings, system);
  loaded.constants = with_signature(request, constants);
  // A signature of constants has no section that a simulation could end at.
  if (loaded.library->has_added_section() && !request.signature) loaded.constants.has_signature = false;
  fit_to_problem(loaded.constants, system, request.overrides);
  return loaded;
}

SimulationSettings simulation_settings(const SimulationRequest& request, const std::function<bool()>& interrupted) {
  SimulationSettings settings;
  settings.flow.method = request.stiff ? IntegrationMethod::bdf : IntegrationMethod::adams;
  settings.flow.relative_tolerance = request.tolerance;
  settings.flow.absolute_tolerance = 0.01 * request.tolerance;
  settings.flow.max_duration = request.wait;
  settings.flow.max_steps = 10000000;
  settings.contact = request.contact;
  settings.samples = static_cast<std::size_t>(request.rows);
  settings.interrupted = interrupted;
  return settings;
}

}  // namespace tchat
