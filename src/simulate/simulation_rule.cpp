#include "simulate/simulation_rule.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/user_error.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

/// Those of --mode, which the problem must have.
std::vector<IndexVector> existing_modes(const HybridSystem& system, const std::string& text) {
  std::vector<IndexVector> index_vectors = parse_modes(text);
  if (const std::string fault = fault_of(system, index_vectors); !fault.empty())
    throw UserError(fmt::format("--mode {}: {}", text, fault));
  return index_vectors;
}

std::vector<Mode> modes_of_signature(const RunSettings& settings) {
  std::vector<Mode> modes;
  for (const SegmentSettings& segment : settings.segments) {
    Mode mode{{segment.index}, segment.monitor};
    std::erase(mode.monitored, segment.index.event);
    modes.push_back(std::move(mode));
  }
  return modes;
}

bool has_one_of_each(const HybridSystem& system) {
  return system.count(FunctionKind::field) == 1 && system.count(FunctionKind::event) == 1 &&
         system.count(FunctionKind::jump) == 1;
}

[[noreturn]] void refuse_without_signature(const SimulationRequest& request, const HybridSystem& system) {
  if (system.has_successors())
    throw UserError(
        fmt::format("--follow-signature: there is no signature to follow; give it with --signature '1,2,2;...' or a "
                    "constants file with -c C (there is no gc.{})",
                    request.name));
  throw UserError(
      fmt::format("{} has no index jump function (successors), so a simulation follows a signature; give it with "
                  "--signature '1,2,2;...' or a constants file with -c C (there is no gc.{}), or give the problem a "
                  "member `successors` (in a file of formulas: lines `after EVENT: FIELD until EVENT -> JUMP`; page "
                  "simulation.md)",
                  system.name(), request.name));
}

/// The signature, beginning at --mode.
ModeRule cyclic_rule(const SimulationRequest& request, const SimulationConstants& constants,
                     const HybridSystem& system) {
  if (!constants.has_signature && !has_one_of_each(system)) refuse_without_signature(request, system);
  std::vector<Mode> modes = constants.has_signature ? modes_of_signature(constants.settings)
                                                    : std::vector<Mode>{Mode{{IndexVector{1, 1, 1}}, {}}};
  // --signature alone says nothing of what else matters.
  const bool says_nothing = request.signature && std::all_of(modes.begin(), modes.end(),
                                                             [](const Mode& mode) { return mode.monitored.empty(); });
  const auto monitor = says_nothing ? ModeRule::Monitor::what_follows : ModeRule::Monitor::as_given;
  if (!request.modes) return ModeRule(system, std::move(modes), monitor);
  const std::vector<IndexVector> wanted = existing_modes(system, *request.modes);
  const auto at = std::find_if(modes.begin(), modes.end(), [&](const Mode& m) { return m.index_vectors == wanted; });
  if (at == modes.end())
    throw UserError(
        fmt::format("--mode {}: the signature, which the simulation follows, is {}; give one of its index "
                    "vectors",
                    *request.modes, to_string(constants.settings.signature())));
  std::rotate(modes.begin(), at, modes.end());
  return ModeRule(system, std::move(modes), monitor);
}

}  // namespace

std::vector<IndexVector> parse_modes(const std::string& text) {
  std::vector<IndexVector> different;
  for (const IndexVector& index : parse_index_vectors(text, "--mode"))
    if (std::find(different.begin(), different.end(), index) == different.end()) different.push_back(index);
  return different;
}

std::string modes_text(const std::vector<IndexVector>& modes) {
  std::string text;
  for (const IndexVector& v : modes)
    text += fmt::format("{}{},{},{}", text.empty() ? "" : ";", v.field, v.event, v.jump);
  return text;
}

ModeRule simulation_rule(const SimulationRequest& request, const SimulationConstants& constants,
                         const HybridSystem& system, const VectorXd& x, const VectorXd& par) {
  if (!system.has_successors() || request.follow_signature || request.signature)
    return cyclic_rule(request, constants, system);
  if (request.modes) return ModeRule(system, Mode{existing_modes(system, *request.modes), {}});
  const auto start = system.successors({0, 0, 0}, x.data(), par.data());
  const bool is_silent = !start || start->empty();
  if (is_silent && constants.has_signature)
    return ModeRule(system, Mode{{constants.settings.segments.front().index}, {}});
  return ModeRule(system);
}

}  // namespace tchat
