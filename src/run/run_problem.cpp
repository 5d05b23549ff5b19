#include "run/run_problem.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "continuation/continuation_run.hpp"
#include "files/solution_file.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "plugin/problem_setup.hpp"
#include "run/branch_setup.hpp"
#include "run/branch_writer.hpp"
#include "run/orbit_start.hpp"
#include "run/own_units.hpp"
#include "run/run_remarks.hpp"
#include "run/solver_settings.hpp"
#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

/// Exit status of a run whose branch ended by MX where that counts as a failure (--strict).
constexpr int ended_by_mx = 3;

/// STOP: true at the n-th labelled point of a type.
std::function<bool(const SpecialPoint&)> make_stop_rule(const RunSettings& settings) {
  // Copies count together: a branch goes on with a finer mesh.
  return
      [rules = settings.stop_rules, all = std::make_shared<std::map<std::string, int>>()](const SpecialPoint& special) {
        std::map<std::string, int>& seen = *all;
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
void refuse_start_outside(const DefiningSystem& system, const Orbit& start, const CollocationRule& rule,
                          const ContinuationSettings& settings, const std::string& source) {
  for (const BranchBounds& bounds : branch_bounds(settings)) {
    if (bounds.parameter >= start.par.layout().first_monitor(start.shape.segments))
      continue;  // its value comes with the first point's multipliers
    const double value = bounds.value(start, rule);
    if (!is_beyond(settings, bounds, value, system.system().parameter_size(bounds.parameter, value))) continue;
    throw UserError(
        fmt::format("the start from {} is outside of the bounds: {} is {:.10g}, and {} allow {:.10g} to {:.10g}; "
                    "widen them, or use another start",
                    source, bounds.quantity, value, bounds.keywords(), bounds.least, bounds.most));
  }
}

/// A line where the start is a special point, which this run neither switches at nor follows in two parameters, nor
/// labels again.
std::string special_start_text(const ProblemType& type, const SelectedStart& start) {
  if (type.facts().switches_branch || type.facts().free_parameters > 1) return "";
  const std::vector<std::string> names = type_names(start.type, start.kind, {});
  const bool is_special = !names.empty() && names.front() != "EP" && names.front() != "RG" && names.front() != "MX" &&
                          names.front() != "UZ" && !names.front().empty();
  if (!is_special) return "";
  return fmt::format("Start: label {} of {}, itself a special point ({}), which gets no label of this run\n",
                     start.label, start.source, fmt::join(names, " "));
}

/// Where a restart goes, for the sign of DS alone does not tell it. A curve that begins at the start leaves it.
std::string direction_text(const BranchSetup& setup, const SelectedStart& start, const std::string& parameter) {
  if (setup.start.leaves_start) return "";
  const double step = setup.settings.step;
  const char* const sign = step > 0.0 ? ">" : "<";
  if (setup.start.stored_direction)
    return fmt::format("DS {} 0: {} the direction stored with label {} of {}\n{}", sign,
                       step > 0.0 ? "on in" : "back against", start.label, start.source,
                       step > 0.0 ? ""
                                  : fmt::format("        DS={:g} continues the earlier run (AUTO-07p continues a run "
                                                "that had DS < 0 with DS < 0)\n",
                                                -step));
  const double rate = step * setup.follower->principal_direction(setup.start.point);
  constexpr double rounding = level::tolerance;  // the parameter has an extremum
  const bool is_known = setup.follower->principal_share(setup.start.point) > rounding;
  // At a branch point the computed tangent is any mixture of those of both branches.
  const bool is_single = !start_is_branch_point(start);
  if (!start.from_solution || setup.type->facts().switches_branch || !is_known || !is_single) return "";
  return fmt::format("DS {} 0: {} {} first (label {} of {} stores no direction for these free parameters)\n", sign,
                     parameter, rate > 0.0 ? "increases" : "decreases", start.label, start.source);
}

/// What a run prints besides its table.
struct Reports {
  std::ostream& warnings;
  std::ostream* table;     ///< null when quiet
  std::ostream* progress;  ///< a terminal, or null

  void warn(const std::vector<std::string>& texts) const { print_warnings(warnings, texts); }
  void warn_of(const std::string& text) const {
    if (!text.empty()) warn({text});
  }
};

/// Of PAR(1), ..., where nothing but their sizes is known.
Eigen::VectorXd parameter_sizes(const HybridSystem& system) {
  return Eigen::VectorXd::NullaryExpr(
      system.parameters(), [&](Eigen::Index k) { return system.parameter_size(static_cast<int>(k) + 1, 0.0); });
}

struct ReadSettings {
  RunSettings in_file;
  RunSettings used;  ///< with the changes of the command line
};

ReadSettings read_settings(const RunRequest& request, const std::string& constants, Warnings* warnings) {
  ReadSettings read;
  read.in_file = read_constants_file(constants, warnings);
  read.used = read.in_file;
  apply_overrides(read.used, request.overrides, warnings);
  return read;
}

struct Problem {
  std::unique_ptr<ProblemLibrary> library;
  RunSettings settings;
  std::string name;  ///< what -p takes

  const HybridSystem& system() const { return library->system(); }
};

/// Constants and plugin, checked against each other.
Problem load_problem(const RunRequest& request, const Reports& reports) {
  Warnings constant_warnings;
  const std::string constants = constants_path(request.constants.value_or(request.name));
  ReadSettings read = read_settings(request, constants, &constant_warnings);
  reports.warn(constant_warnings);

  const std::string name = problem_of_run(request.problem, request.name, recorded_problem(read.in_file, constants));
  const std::string plugin = resolve_plugin(name, {.progress = reports.progress});
  auto library = std::make_unique<ProblemLibrary>(plugin, [&read] { return problem_sizes(read.used); });
  const HybridSystem& system = library->system();
  resolve_names(read.in_file, system);
  resolve_names(read.used, system);
  reports.warn(check_settings_against(system, read.used, {constants, request.overrides}));
  reports.warn_of(inherited_bounds(system, read.in_file, read.used, request.overrides, constants));
  read.used.threads = request.threads;
  return {std::move(library), read.used, name};
}

SelectedStart start_of(const RunRequest& request, const Problem& problem, const Reports& reports) {
  const std::vector<int> free_parameters = free_problem_parameters(problem.settings);
  SelectedStart selected = select_start(request, problem.settings, problem.system(), free_parameters);
  reports.warn(selected.warnings);
  reports.warn_of(idle_parameters(problem.system(), problem.settings, selected, free_parameters.size()));
  return selected;
}

/// The first point, checked before any file is touched. `own` may become other units, which its tangent shows.
BranchSetup first_branch(const Problem& problem, const SelectedStart& selected, OwnUnits& own, const Reports& reports) {
  BranchSetup setup = set_up_branch(own.system(), own.settings, own.start);
  if (auto along =
          in_units_along(problem.system(), problem.settings, selected, own, *setup.defining, setup.start.point)) {
    setup = set_up_branch(along->system(), along->settings, along->start);
    own = std::move(*along);
  }
  reports.warn_of(setup.start.note);
  const RunSettings& written = setup.constants ? *setup.constants : setup.settings;
  reports.warn_of(unwatched_events(own.system(), written, setup.start.point.orbit));
  return setup;
}

ContinuationSettings continuation_of(const RunRequest& request, const BranchSetup& setup, const OwnUnits& own,
                                     const Problem& problem, const std::function<bool()>& interrupted) {
  const HybridSystem& system = problem.system();
  const SelectedStart& selected = own.start;
  ContinuationSettings continuation = continuation_settings(setup.settings);
  continuation.clip = request.clip;
  continuation.state_weights = state_weights(problem.settings);
  continuation.state_units = own.units;
  continuation.principal_name = parameter_name(system, setup.settings, continuation.principal);
  for (const BoundedValue& bounded : setup.settings.bounds)
    continuation.further_bounds.push_back({bounded.parameter, parameter_name(system, setup.settings, bounded.parameter),
                                           "BOUNDS", "BOUNDS", bounded.least, bounded.most});
  continuation.label_start = selected.label_start;
  continuation.interrupted = interrupted;
  if (!selected.from_solution || selected.parameters_changed)
    refuse_start_outside(*setup.defining, setup.start.point.orbit, setup.follower->condensed().rule(), continuation,
                         selected.source);
  return continuation;
}

/// Exit status of a branch that ended so; says why on `warnings`.
int status_of(const BranchSummary& summary, bool strict, std::ostream& warnings) {
  if (summary.reason == EndReason::first_step_failed) {
    print_failure(warnings, "the first step failed: " + summary.detail);
    return 1;
  }
  if (summary.reason != EndReason::no_convergence || !strict) return 0;
  print_failure(warnings, "the branch ended by MX: " + summary.detail);
  return ended_by_mx;
}

/// NTST is doubled up to here where the mesh does not resolve the orbit.
int most_mesh_intervals(const RunSettings& settings) {
  constexpr int times = 8, enough = 400, many = 2000;
  return std::max(enough, std::min(times * settings.mesh_intervals, many));
}

/// One direction of a run: a section of its files.
class Direction {
 public:
  Direction(const BranchSetup& setup, ContinuationSettings continuation, int branch)
      : setup_(setup),
        continuation_(std::move(continuation)),
        branch_(branch),
        most_intervals_(most_mesh_intervals(setup.settings)) {}

  /// `correction`: how Newton came to the first point, as far as this section is to tell it.
  BranchSummary follow(BranchWriter& writer, std::vector<NewtonIteration> correction,
                       const std::vector<std::string>& notes) {
    continuation_.stop_at = make_stop_rule(setup_.settings);
    writer.begin_section(branch_, continuation_.step.initial, std::move(correction));
    for (const std::string& note : notes) writer.note(1, note);
    BranchSummary summary = follow_on(setup_, setup_.start.point, writer);
    summary.without_contact = setup_.type->facts().stability == StabilityMeaning::without_contact;
    writer.end_section(summary);
    return summary;
  }

 private:
  /// As far as it goes, and on where it needs another discretisation, which a torus does. Where there is none on which
  /// the torus is found, as at a resonance, it goes on for some points before it is asked again.
  BranchSummary follow_on(const BranchSetup& setup, const PathPoint& start, BranchWriter& writer, int patience = 0) {
    constexpr int points_before_next = 5;
    continuation_.monitored = continuation_settings(setup.settings).monitored;
    const Discretisation& discretisation = *setup.discretisation;
    continuation_.remark = [&](const Orbit& x) { return discretisation.remark(x); };
    continuation_.label_remark = setup.label_remark;
    continuation_.outgrown = [&, patience](const Orbit& x) mutable {
      return --patience < 0 && discretisation.is_outgrown(x);
    };
    continuation_.unresolved = [&](const Orbit& x) { return discretisation.why_unresolved(x); };
    continuation_.may_refine =
        patience == 0 && setup.follower->condition() == nullptr && 2 * setup.settings.mesh_intervals <= most_intervals_;
    ContinuationRun run(*setup.follower, *setup.defining, continuation_, setup.make_tests(), writer);
    const BranchSummary summary = run.run(start);
    if (summary.reason != EndReason::outgrown) return summary;
    const BranchSetup next = discretisation.refined(setup, run.last());
    if (summary.detail.empty())
      writer.note(summary.points, next.start.note);
    else
      writer.mesh_changed(summary.points, run.last().orbit.par(continuation_.principal - 1),
                          summary.detail + "; " + next.start.note);
    if (!summary.detail.empty()) continuation_.trend = run.trend();
    continuation_.step.initial = run.next_length();
    continuation_.first_number = summary.points;
    continuation_.resumes = true;
    continuation_.label_start = false;
    return joined(summary, next.follower ? follow_on(next, next.start.point, writer)
                                         : follow_on(setup, run.last(), writer, points_before_next));
  }

  static BranchSummary joined(const BranchSummary& before, BranchSummary after) {
    after.inadmissible_points += before.inadmissible_points;
    after.unstable_points += before.unstable_points;
    after.undetermined_points += before.undetermined_points;
    after.neutral_points += before.neutral_points;
    after.multipliers_computed = before.multipliers_computed;
    after.has_trivial = before.has_trivial;
    after.has_structural = before.has_structural || after.has_structural;
    after.worst_structural = std::max(before.worst_structural, after.worst_structural);
    if (before.worst_unfolding)
      after.worst_unfolding = std::max(*before.worst_unfolding, after.worst_unfolding.value_or(0.0));
    after.worst_estimated_error = std::max(before.worst_estimated_error, after.worst_estimated_error);
    std::erase_if(after.vanishing, [&](const VanishingFunction& function) {
      return std::none_of(before.vanishing.begin(), before.vanishing.end(),
                          [&](const VanishingFunction& other) { return other.name == function.name; });
    });
    after.lost.insert(after.lost.begin(), before.lost.begin(), before.lost.end());
    return after;
  }

  const BranchSetup& setup_;
  ContinuationSettings continuation_;
  int branch_;
  int most_intervals_;
};

/// Against the direction of DS.
ContinuationSettings reversed(ContinuationSettings continuation) {
  continuation.step.initial = -continuation.step.initial;
  continuation.label_start = false;
  return continuation;
}

}  // namespace

int run_problem(const RunRequest& request, std::ostream& screen, std::ostream& warnings,
                const std::function<bool()>& interrupted, std::ostream* progress) {
  const Reports reports{warnings, request.quiet ? nullptr : &screen, progress};
  const Problem problem = load_problem(request, reports);
  const HybridSystem& system = problem.system();
  const SelectedStart selected = start_of(request, problem, reports);
  const std::string output = request.output.value_or(request.name);
  refuse_to_replace_start(request, selected, output);
  RunFiles files(output, request.append ? RunFiles::Mode::append : RunFiles::Mode::replace);
  files.check_writable();
  OwnUnits own = in_own_units(system, problem.settings, selected);
  const BranchSetup setup = first_branch(problem, selected, own, reports);
  const ContinuationSettings continuation = continuation_of(request, setup, own, problem, interrupted);

  RunSettings constants = setup.constants.value_or(setup.settings);
  constants.state_weights = problem.settings.state_weights;
  constants.problem = problem_to_record(problem.name, output_path('r', output));
  files.open(positional_text(constants));  // only now are files touched
  if (reports.table != nullptr)
    *reports.table << special_start_text(problem_type(problem.settings), selected)
                   << direction_text(setup, selected, continuation.principal_name);
  const int last_label = request.append ? std::max(files.last_label(), 0) : selected.last_label;
  BranchWriter writer(system, setup.follower->condensed().rule(),
                      {constants, active_parameters(constants), setup.type->facts().curve, last_label, own.units,
                       parameter_sizes(own.system())},
                      files, reports.table, reports.table != nullptr ? progress : nullptr);

  const NextCommand next = [&](const BranchWriter::Labelled& label) {
    const NextStart start{label.label, label.number, label.kind, setup.type->facts().curve};
    return shell_line(next_commands(start, constants, system, problem.name, output, names_at(start, output)));
  };
  int status = 0;
  bool closed = false;
  const auto report = [&](const BranchSummary& summary, std::size_t labels_before) {
    closed = summary.reason == EndReason::closed;
    const std::vector<BranchWriter::Labelled> labels(
        writer.labels().begin() + static_cast<std::ptrdiff_t>(labels_before), writer.labels().end());
    if (reports.table != nullptr)
      *reports.table << summary_text(summary, labels, continuation.principal_name, output, next) << std::flush;
    const int of_branch = status_of(summary, request.strict, warnings);
    status = of_branch == 1 || status == 0 ? of_branch : status;
  };
  const int branch = request.append ? std::max(files.last_branch() + 1, 1) : selected.branch;
  report(Direction(setup, continuation, branch)
             .follow(writer, setup.start.correction, problem.library->derivative_notes()),
         0);
  const bool is_other_branch = problem_type(problem.settings).facts().switches_branch;
  const bool begins_here = is_other_branch && setup.type->facts().curve > 0;
  const bool has_other = !closed && !begins_here;
  if (request.both_directions && !has_other && reports.table != nullptr)
    *reports.table << (closed ? "  --both: the other direction goes round the same closed branch, and is left out\n"
                              : "  --both: the curve begins at the label, so there is no other direction\n");
  if (request.both_directions && has_other && !(interrupted && interrupted())) {
    const std::size_t labels_before = writer.labels().size();
    BranchSetup other_side;
    if (is_other_branch) {  // the two sides of a bifurcation are different branches
      RunSettings against = own.settings;
      against.step = -against.step;
      other_side = set_up_branch(own.system(), against, own.start);
    }
    report(Direction(is_other_branch ? other_side : setup, reversed(continuation), branch + 1)
               .follow(writer, other_side.start.correction, {}),
           labels_before);
  }
  files.finish();
  reports.warn_of(problem.library->complaint());
  return status;
}

}  // namespace tchat
