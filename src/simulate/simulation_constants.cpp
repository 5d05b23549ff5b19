#include "simulate/simulation_constants.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/user_error.hpp"
#include "files/run_files.hpp"
#include "model/index_vector.hpp"
#include "motion/mode_rule.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constants_file.hpp"
#include "simulate/simulation_rule.hpp"

namespace tchat {

namespace {

/// The segments of --signature; those that the file has keep its monitored event functions.
std::vector<SegmentSettings> segments_of_signature(const std::string& text, const std::vector<SegmentSettings>& known) {
  std::vector<SegmentSettings> segments;
  for (const IndexVector& index : parse_signature(text)) {
    const auto same = std::find_if(known.begin(), known.end(), [&](const auto& s) { return s.index == index; });
    SegmentSettings segment;
    if (same != known.end()) segment = *same;
    segment.index = index;
    segments.push_back(std::move(segment));
  }
  return segments;
}

void require_events(const HybridSystem& system) {
  if (system.count(FunctionKind::event) > 0 && system.count(FunctionKind::jump) > 0) return;
  throw UserError(fmt::format(
      "problem {} has no event functions or no jumps, so no segment of a simulation could end; write one, a "
      "section of the orbit, or use `tchat run`: IPS = 4, or event function 0 for smooth orbits",
      system.name()));
}

}  // namespace

SimulationConstants read_simulation_constants(const SimulationRequest& request) {
  SimulationConstants constants;
  if (request.constants)
    constants.path = constants_path(*request.constants);
  else
    constants.path = own_constants_path(request.name);
  RunSettings& settings = constants.settings;
  if (constants.is_given()) {
    settings = read_constants_file(constants.path);
  } else {
    settings.free_parameters = {1};
    settings.segments.resize(1);
  }
  apply_overrides(settings, request.overrides);
  constants.file_segments = static_cast<int>(settings.segments.size());
  constants.has_signature = constants.is_given();
  return constants;
}

SimulationConstants with_signature(const SimulationRequest& request, SimulationConstants constants) {
  if (!request.signature) return constants;
  std::vector<SegmentSettings>& segments = constants.settings.segments;
  segments =
      segments_of_signature(*request.signature, constants.is_given() ? segments : std::vector<SegmentSettings>{});
  constants.has_signature = true;
  return constants;
}

ProblemSizes sizes_of(const SimulationRequest& request, const SimulationConstants& constants) {
  if (!constants.is_given())
    throw UserError(
        fmt::format("{} is a Fortran plugin, which does not say how many states and functions it has; give a constants "
                    "file with -c C (or name one gc.{}), whose NDIM and signature say it",
                    request.name, request.name));
  ProblemSizes sizes = problem_sizes(constants.settings);
  if (request.modes)
    for (const IndexVector& index : parse_modes(*request.modes)) sizes.add(index);
  return sizes;
}

void fit_to_problem(SimulationConstants& constants, const HybridSystem& system,
                    const std::vector<std::string>& overrides) {
  require_events(system);
  if (!constants.is_given()) constants.settings.dimension = system.dimension();
  for (const SegmentSettings& segment : constants.settings.segments)
    if (const std::string fault = fault_of(system, {segment.index}); constants.has_signature && !fault.empty())
      throw UserError(fmt::format(
          "{}: {}", constants.is_given() ? SettingsSource{constants.path, overrides}.of("GCFIND") : "--signature",
          fault));
  if (constants.is_given()) check_settings_against(system, constants.settings, {constants.path, overrides});
}

}  // namespace tchat
