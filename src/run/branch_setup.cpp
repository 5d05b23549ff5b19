#include "run/branch_setup.hpp"

#include <fmt/format.h>

#include "files/solution_file.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

/// The type that CURVE names, one of those whose curves go through the label. Throws UserError where it is none.
const ProblemType& type_of_curve(const HybridSystem& system, const RunSettings& settings,
                                 const SelectedStart& selected) {
  std::vector<int> label_types = selected.types;
  if (const int own = curve_type(selected.type); own > 0) label_types.push_back(own);
  for (const PointType type : curves_through(selected.type)) label_types.push_back(static_cast<int>(type));
  std::string names;
  for (const ProblemType* type : problem_types_of(settings.problem_type, settings.branch_mode)) {
    const auto begins = [type](int label_type) { return type->begins_at(label_type); };
    const std::string name = curve_name(settings.problem_type, type->facts().curve);
    if (name.empty() || std::none_of(label_types.begin(), label_types.end(), begins) ||
        !type->accepts(system, settings, selected))
      continue;
    if (name == settings.curve) return *type;
    names += (names.empty() ? "" : ", ") + name;
  }
  throw UserError(
      fmt::format("CURVE = {}: with IPS = {} and ISW = {} the curves through the start are those of {}; "
                  "name one of them, or none with CURVE=",
                  settings.curve, settings.problem_type, settings.branch_mode, names.empty() ? "no points" : names));
}

/// The types of labels by which a start chooses what begins there: that of the curve it was computed on, else its own.
/// A switch leaves the curve, and asks for the label's own first.
std::vector<int> deciding_types(const SelectedStart& selected, bool switches) {
  const int of_curve = curve_type(selected.type);
  std::vector<int> types = of_curve > 0 ? std::vector<int>{of_curve} : selected.types;
  if (switches) types.insert(types.begin(), label_type(selected.type));
  return types;
}

/// The type that the start chooses, where IPS and ISW leave a choice, and by what its orbit is where types share such
/// labels.
const ProblemType& type_at(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  const ProblemType& first = problem_type(settings.problem_type, settings.branch_mode);
  if (!settings.curve.empty() && first.facts().in_two_parameters) return type_of_curve(system, settings, selected);
  for (const int of_label : deciding_types(selected, first.facts().switches_branch))
    for (const ProblemType* type : problem_types_of(settings.problem_type, settings.branch_mode))
      if (type->begins_at(of_label) && type->accepts(system, settings, selected)) return *type;
  if (first.facts().curve == 0) return first;
  const std::string name = type_name(selected.type, selected.kind);
  std::string curves;
  std::string example;
  for (const ProblemType* type : problem_types_of(settings.problem_type, settings.branch_mode)) {
    const int curve = type->facts().curve;
    const std::string label = curve != 0 ? curve_name(settings.problem_type, curve) : type->facts().start_example;
    curves += fmt::format("{}{} ({})", curves.empty() ? "" : ", ", type->facts().title, label);
    if (example.empty()) example = label;
  }
  throw UserError(fmt::format(
      "{}: ISW = {} follows the curve of a label: {}; but the run starts from {}; name such a label, for example "
      "IRS={}1",
      selected.source, settings.branch_mode, curves,
      selected.from_solution ? fmt::format("a label of type {}", name.empty() ? "none" : name) : "data", example));
}

}  // namespace

void attach_follower(BranchSetup& setup, std::unique_ptr<OrbitCondition> condition, const Orbit& start) {
  const RunSettings& settings = setup.settings;
  check_memory(start.shape, setup.defining->free_count());
  setup.follower = std::make_unique<PathFollower>(
      *setup.defining, start.shape, weighted_norm(settings, start), newton_settings(settings),
      settings.free_parameters.front(), std::move(condition), branch_monitors(*setup.defining, settings, start));
}

BranchSetup Discretisation::refined(const BranchSetup& setup, const PathPoint& last) const {
  RunSettings settings = setup.settings;
  settings.mesh_intervals *= 2;
  for (std::size_t k = 0; k < settings.held.size(); ++k) settings.held[k].value = setup.follower->held()[k].value;
  const CollocationRule& rule = setup.follower->condensed().rule();
  const int intervals = settings.mesh_intervals;
  OrbitShape shape = resized(last.orbit.shape, intervals);
  std::vector<double> mesh;
  if (settings.adapt_mesh_every > 0) {
    MeshEquidistribution equidistribution;
    mesh = equidistribution.mesh(last.orbit, rule, intervals);
    shape = equidistribution.shape();
  } else {
    mesh = resampled_mesh(last.orbit.shape, last.orbit.mesh, shape);
  }
  const MeshTransfer transfer(last.orbit.shape, last.orbit.mesh, shape, mesh, rule);
  SelectedStart start;
  start.start.orbit = {shape, mesh, transfer(last.orbit.states), last.orbit.par};
  OrbitVector direction(shape, setup.defining->free_count());
  direction.states = transfer(last.tangent.states);
  direction.durations = last.tangent.durations;
  direction.globals = last.tangent.globals;

  BranchSetup next = setup.type->prepare(setup.defining->system(), settings, start);
  next.constants = setup.constants;
  PathPoint point = next.follower->make_point(start.start.orbit);
  const NewtonResult result = next.follower->start_along(point, direction);
  if (!result.converged()) {
    next.follower.reset();
    next.start.note = fmt::format("no convergence with NTST = {} ({})", intervals, describe(result.status));
    return next;
  }
  if (next.follower->alignment(point, direction) < 0.0) next.follower->reverse(point);
  next.start = {std::move(point), next.follower->newton().history(), fmt::format("NTST = {} from here on", intervals),
                setup.start.stored_direction};
  return next;
}

BranchSetup set_up_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  return type_at(system, settings, selected).set_up(system, settings, selected);
}

}  // namespace tchat
