#include "run/problem_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "bvp/grazing_orbit_system.hpp"
#include "bvp/periodic_orbit_system.hpp"
#include "hybrid/parameter_vector.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

template <class System>
std::unique_ptr<DefiningSystem> make(const HybridSystem& system, const RunSettings& settings,
                                     std::vector<int> free_parameters) {
  return std::make_unique<System>(system, settings.signature(), std::move(free_parameters));
}

/// The segment marked by GCSEGTYP = 2, else the first one.
std::unique_ptr<DefiningSystem> make_grazing(const HybridSystem& system, const RunSettings& settings,
                                             std::vector<int> free_parameters) {
  const auto marked = std::find_if(settings.segments.begin(), settings.segments.end(),
                                   [](const SegmentSettings& segment) { return segment.type == 2; });
  const int grazing = marked == settings.segments.end() ? 0 : static_cast<int>(marked - settings.segments.begin());
  return std::make_unique<GrazingOrbitSystem>(system, settings.signature(), std::move(free_parameters), grazing);
}

constexpr std::array<ProblemType, 3> types{{
    {180, 1, "periodic orbits in one parameter (ISW = -1: the branch that bifurcates at a PD or BP label)", 1,
     &make<PeriodicOrbitSystem>},
    {180, 2, "folds or period doublings of periodic orbits in two parameters", 2, &make<PeriodicOrbitSystem>},
    {150, 1, "periodic orbits in grazing contact, in two parameters", 2, &make_grazing},
}};

bool contains(const std::vector<int>& list, int k) { return std::find(list.begin(), list.end(), k) != list.end(); }

}  // namespace

const ProblemType& problem_type(const RunSettings& settings) {
  const int mode = settings.branch_mode == -1 ? 1 : settings.branch_mode;
  std::string list;
  for (const ProblemType& type : types) {
    if (type.number == settings.problem_type && type.branch_mode == mode) return type;
    list += fmt::format("\n  IPS = {}, ISW = {}: {}", type.number, type.branch_mode, type.name);
  }
  throw UserError(fmt::format("IPS = {} with ISW = {} is not a problem that tchat solves; there are:{}",
                              settings.problem_type, settings.branch_mode, list));
}

std::vector<int> free_problem_parameters(const ProblemType& type, const RunSettings& settings) {
  std::vector<int> result;
  for (const int k : settings.free_parameters)
    if (!is_duration(k, segment_count(settings)) && static_cast<int>(result.size()) < type.free_parameters)
      result.push_back(k);
  if (static_cast<int>(result.size()) < type.free_parameters)
    throw UserError(fmt::format(
        "ICP lists {} problem parameters, IPS = {} with ISW = {} needs {}: durations are free in any case, so name the "
        "parameters to vary, for example ICP = [1, 61]",
        result.size(), settings.problem_type, settings.branch_mode, type.free_parameters));
  return result;
}

std::vector<int> active_parameters(const ProblemType& type, const RunSettings& settings) {
  const std::vector<int> problem_parameters = free_problem_parameters(type, settings);
  std::vector<int> result;
  for (const int k : settings.free_parameters)
    if (is_duration(k, segment_count(settings)) || contains(problem_parameters, k)) result.push_back(k);
  for (int s = 0; s < segment_count(settings); ++s)
    if (!contains(result, first_duration + s)) result.push_back(first_duration + s);
  return result;
}

}  // namespace tchat
