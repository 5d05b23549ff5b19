#include "run/run_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "constants/constants_file.hpp"
#include "constants/constants_writer.hpp"
#include "constants/settings_type.hpp"
#include "continuation/continuation_run.hpp"
#include "continuation/solution_measure.hpp"
#include "files/labelled_solution.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "run/branch_setup.hpp"
#include "run/branch_writer.hpp"
#include "run/parameter_remarks.hpp"
#include "run/run_summary.hpp"
#include "run/unwatched_events.hpp"
#include "setup/named_parameters.hpp"
#include "setup/problem_setup.hpp"
#include "setup/warnings.hpp"
#include "special_points/point_type.hpp"
#include "start/start_selection.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

/// Exit status of a run whose branch ended by MX where that counts as a failure (--strict).
constexpr int ended_by_mx = 3;

/// STOP: true at the n-th labelled point of a type.
std::function<bool(const SpecialPoint&)> make_stop_rule(const RunSettings& settings) {
  return [rules = settings.stop_rules, seen = std::map<std::string, int>{}](const SpecialPoint& special) mutable {
    bool stops = false;
    for (const std::string& type : type_names(static_cast<int>(special.type), special.kind, special.further)) {
      const int count = ++seen[type];
      stops = stops || std::any_of(rules.begin(), rules.end(),
                                   [&](const StopRule& rule) { return rule.type == type && rule.count == count; });
    }
    return stops;
  };
}

void refuse_to_replace_start(const RunRequest& request, const SelectedStart& start, const std::string& output) {
  if (request.output || request.append || !same_file(output_path('q', output), start.source)) return;
  throw UserError(
      fmt::format("the output q.{} would replace the file that the run starts from; say -o {} if that is "
                  "meant, or give the output another name",
                  output, output));
}

/// A start beyond the bounds leaves nothing to compute. A label may lie there, where an earlier run ended: its branch
/// of one point says so.
void refuse_start_outside(const Orbit& start, const CollocationRule& rule, const ContinuationSettings& settings,
                          const std::string& parameter, const std::string& source) {
  const auto refuse = [&](const std::string& what, double value, double least, double most, const char* bounds) {
    if (!is_beyond(settings, value, least, most)) return;
    throw UserError(
        fmt::format("the start from {} lies outside of the bounds: {} is {:.10g}, and {} allow {:.10g} to {:.10g}; "
                    "widen them, or start elsewhere",
                    source, what, value, bounds, least, most));
  };
  refuse(parameter, start.par(settings.principal - 1), settings.parameter_min, settings.parameter_max, "RL0, RL1");
  refuse("the solution measure", solution_measure(start, rule, settings.state_weights, settings.measure),
         settings.measure_min, settings.measure_max, "A0, A1");
}

/// Where a restart goes, for the sign of DS alone does not tell it.
std::string direction_text(double step, const SelectedStart& start) {
  return fmt::format("DS {} 0: {} the direction stored with label {} of {}\n", step > 0.0 ? ">" : "<",
                     step > 0.0 ? "on in" : "back against", start.label, start.source);
}

struct ReadSettings {
  RunSettings in_file;
  RunSettings used;  ///< with the changes of the command line
};

ReadSettings read_settings(const RunRequest& request, const std::string& constants, const ParameterNames& names,
                           Warnings* warnings) {
  ReadSettings read;
  read.in_file = read_constants_file(constants, warnings, names);
  read.used = read.in_file;
  apply_overrides(read.used, request.overrides, warnings, names);
  return read;
}

void warn_of(std::ostream& warnings, const std::string& text) {
  if (!text.empty()) print_warnings(warnings, {text});
}

}  // namespace

int run_problem(const RunRequest& request, std::ostream& screen, std::ostream& warnings,
                const std::function<bool()>& interrupted, std::ostream* progress) {
  const auto warn = [&](const std::vector<std::string>& texts) { print_warnings(warnings, texts); };

  // Constants.
  Warnings constant_warnings;
  bool named_parameters = false;
  const std::string constants = constants_path(request.constants.value_or(request.name));
  ReadSettings read = read_settings(request, constants, names_to_come(named_parameters), &constant_warnings);
  warn(constant_warnings);
  RunSettings settings = read.used;
  std::vector<int> free_parameters = free_problem_parameters(settings);

  // Plugin.
  const std::string plugin = resolve_plugin(request.problem.value_or(request.name), {.progress = progress});
  const ProblemLibrary library(plugin, [&settings] { return problem_sizes(settings); });
  const HybridSystem& system = library.system();
  if (named_parameters) {
    read = read_settings(request, constants, names_of(system), nullptr);
    settings = read.used;
    free_parameters = free_problem_parameters(settings);
  }
  warn(check_settings_against(system, settings, {constants, request.overrides}));
  warn_of(warnings, inherited_bounds(system, read.in_file, settings, request.overrides, constants));

  // Start.
  SelectedStart selected = select_start(request, settings, system, free_parameters);
  warn(selected.warnings);
  warn_of(warnings, idle_parameters(system, settings, selected, free_parameters.size()));
  const std::string output = request.output.value_or(request.name);
  refuse_to_replace_start(request, selected, output);
  RunFiles files(output, request.append ? RunFiles::Mode::append : RunFiles::Mode::replace);
  files.check_writable();

  // Discretisation and first point.
  const RunSettings asked = settings;
  const BranchSetup setup = set_up_branch(system, asked, selected);
  settings = setup.settings;
  warn_of(warnings, setup.start.note);
  warn_of(warnings, unwatched_events(system, settings, setup.start.point.orbit));
  ContinuationSettings continuation = continuation_settings(settings);
  continuation.clip = request.clip;
  if (!selected.from_solution || selected.parameters_changed)
    refuse_start_outside(setup.start.point.orbit, setup.follower->condensed().rule(), continuation,
                         system.parameter_name(continuation.principal), selected.source);

  // Files are touched only now.
  files.open(positional_text(settings));
  std::ostream* table = request.quiet ? nullptr : &screen;
  if (table != nullptr && setup.start.stored_direction) *table << direction_text(settings.step, selected);
  const int last_label = request.append ? std::max(files.last_label(), 0) : selected.last_label;
  BranchWriter writer(system, setup.follower->condensed().rule(),
                      {settings, active_parameters(settings), setup.type->facts().curve, selected.branch, last_label},
                      files, table, table != nullptr ? progress : nullptr);
  continuation.label_start = selected.label_start;
  continuation.interrupted = interrupted;

  int status = 0;
  int branch = request.append ? std::max(files.last_branch() + 1, 1) : selected.branch;
  const int directions = request.both_directions ? 2 : 1;
  const BranchSetup* side = &setup;
  BranchSetup other_side;
  for (int direction = 0; direction < directions; ++direction, ++branch) {
    if (direction == 1) {
      if (interrupted && interrupted()) break;
      continuation.step.initial = -continuation.step.initial;
      continuation.label_start = false;
      if (problem_type(asked).facts().switches_branch) {  // the two sides of a bifurcation are different branches
        RunSettings reversed = asked;
        reversed.step = -asked.step;
        other_side = set_up_branch(system, reversed, selected);
        side = &other_side;
      }
    }
    continuation.stop_at = make_stop_rule(settings);
    writer.begin_section({branch, continuation.step.initial,
                          side == &setup && direction == 1 ? std::vector<NewtonIteration>{} : side->start.correction});
    if (direction == 0)
      for (const std::string& note : library.derivative_notes()) writer.note(1, note);
    const std::size_t labels_before = writer.labels().size();
    ContinuationRun run(*side->follower, *side->defining, continuation, side->type->tests(*side->defining, settings),
                        writer);
    BranchSummary summary = run.run(side->start.point);
    summary.without_contact = side->type->facts().stability == StabilityMeaning::without_contact;
    writer.clear_progress();
    const std::vector<BranchWriter::Labelled> labels(
        writer.labels().begin() + static_cast<std::ptrdiff_t>(labels_before), writer.labels().end());
    if (table != nullptr)
      *table << summary_text(summary, labels, system.parameter_name(continuation.principal), output) << std::flush;
    if (summary.reason == EndReason::first_step_failed) {
      status = 1;
      warnings << "tchat: the first step failed: " << summary.detail << '\n';
    } else if (summary.reason == EndReason::no_convergence && request.strict) {
      status = status == 0 ? ended_by_mx : status;
      warnings << "tchat: the branch ended by MX: " << summary.detail << '\n';
    }
  }
  files.finish();
  if (const std::string complaint = library.complaint(); !complaint.empty()) warn({complaint});
  return status;
}

}  // namespace tchat
