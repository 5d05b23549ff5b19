#include "explore/explorer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "explore/branch_recognition.hpp"
#include "explore/curve_rounds.hpp"
#include "explore/diagram_picture.hpp"
#include "explore/exploration_commands.hpp"
#include "explore/orbit_catalogue.hpp"
#include "explore/run_record.hpp"
#include "files/dat_file.hpp"
#include "files/replaced_file.hpp"
#include "files/solution_file_reader.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_setup.hpp"
#include "run/run_remarks.hpp"
#include "settings/constants_file.hpp"
#include "settings/point_type.hpp"
#include "settings/settings_type.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

/// A switch that is to be followed, and what it begins at.
struct BranchCandidate {
  ExploredBranch branch;
  std::size_t parent = 0;                              ///< of the diagram's branches; beyond them without one
  std::size_t label = 0;                               ///< of the parent's labels
  int returns = 1;                                     ///< at grazing, one impact in so many
  std::string attractor;                               ///< without a parent
  std::function<CommandJob(const std::string&)> make;  ///< its job, for files of this name
  int points = usual_points;                           ///< at most, of its run
};

constexpr int most_points = 16 * usual_points;  // of a branch that NMX has cut on its way

class Explorer {
 public:
  Explorer(const ExploreRequest& request, const std::function<bool()>& interrupted, std::ostream& screen,
           std::ostream* progress)
      : request_(request),
        screen_(screen),
        loaded_(load_for_simulation(simulation_request(request), progress)),
        commands_(request, loaded_.library->system(), loaded_.library->has_added_section(), given_files()),
        lock_(lock_output(commands_.folder())),
        begun_(std::chrono::steady_clock::now()),
        runner_(commands_.folder(), request.workers, [this, interrupted] { return interrupted() || is_late(); }),
        interrupted_(interrupted) {
    diagram_.parameter = commands_.range().parameter;
    if (request.second) curves_.emplace(curve_context(), parameters());
  }

  int explore() {
    if (!sweep()) return finish();
    follow(seeds());
    for (bool found = true; found && goes_on();) found = follow(more_seeds());
    if (curves_ && goes_on()) curves_->follow();
    return finish();
  }

 private:
  static SimulationRequest simulation_request(const ExploreRequest& request) {
    SimulationRequest simulation;
    simulation.name = request.name;
    simulation.constants = request.constants;
    simulation.problem = request.problem;
    for (const std::string& word : request.overrides)
      if (sets_parameter(word)) simulation.overrides.push_back(word);
    return simulation;
  }

  CurveRounds::Context curve_context() {
    return {request_,
            commands_,
            loaded_.library->system(),
            runner_,
            diagram_,
            [this] { return goes_on(); },
            [this](const std::string& text) { show(text); },
            [this] { return next_name(); }};
  }

  /// What all commands read.
  GivenFiles given_files() const {
    GivenFiles given{files_of_problem(request_.problem.value_or(request_.name), loaded_.plugin), {}};
    if (!loaded_.constants.path.empty()) given.constants.push_back(loaded_.constants.path);
    return given;
  }

  /// Branches have numbers in the order in which they are tried.
  std::string next_name() { return fmt::format("b{}", ++named_); }

  /// Of the diagram over the first one.
  ParameterVector parameters() const {
    ParameterVector par = initial_parameters(loaded_.library->system());
    apply_command_line(loaded_.library->system(), loaded_.constants.settings, par);
    return par;
  }

  bool is_late() const {
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begun_;
    return request_.seconds > 0.0 && time.count() > request_.seconds;
  }
  bool goes_on() const { return diagram_.complete && !interrupted_(); }

  void show(const std::string& text) const {
    if (!request_.quiet) screen_ << text << std::flush;
  }

  bool sweep() {
    if (!add_sweep(commands_.sweep())) return false;
    const std::vector<std::string> states = sweeps_.front().samples.further_starts(
        request_.starts, [this](const Eigen::VectorXd& state) { return !is_behind_wall(state); });
    return states.empty() || add_sweep(commands_.sweep_from(states));
  }

  /// Is an event with an impact negative there, in the mode that a simulation begins in?
  bool is_behind_wall(const Eigen::VectorXd& x) const {
    const HybridSystem& system = loaded_.library->system();
    const SimulationRequest request = simulation_request(request_);
    const ParameterVector par = parameters();
    const HybridSimulation simulation(simulation_rule(request, loaded_.constants, system, x, par), x, par,
                                      simulation_settings(request, interrupted_));
    return !simulation.walls_behind().empty();
  }

  bool add_sweep(const CommandJob& job) {
    diagram_.first_jobs.push_back(job);
    const JobResult result = runner_.run({job}).front();
    if (!result.was_run) {
      diagram_.complete = false;
      return false;
    }
    if (!result.succeeded()) throw ComputationError("the sweep failed: " + result.failure);
    sweeps_.push_back({sweeps_.empty() ? "a" : "s", AttractorSamples(job.outputs.front(), loaded_.library->system()),
                       commands_.monitors(), loaded_.library->has_added_section()});
    return true;
  }

  /// A branch through an attractor of this name.
  BranchCandidate start_at(const SweepAttractor& attractor, const std::string& name, double value,
                           const Command& words) const {
    BranchCandidate candidate;
    candidate.parent = std::string::npos;
    candidate.attractor = name;
    candidate.branch.origin = fmt::format("attractor {} at {} = {:.6g}", name, diagram_.parameter, value);
    candidate.make = [this, value, words, rests = attractor.kind == AttractorKind::rest](const std::string& branch) {
      return commands_.start(branch, value, words, rests);
    };
    return candidate;
  }

  /// Has the attractor more segments than are followed?
  bool is_too_long(const SweepAttractor& attractor) const {
    return static_cast<int>(signature_of(attractor).size()) > request_.segments;
  }

  /// A branch for each attractor that repeats itself or rests, of the first sweep.
  std::vector<BranchCandidate> seeds() {
    std::vector<BranchCandidate> list;
    const Sweep& sweep = sweeps_.front();
    for (const SweepAttractor& attractor : sweep.samples.table().attractors) {
      if (!is_followed(attractor)) continue;
      if (is_too_long(attractor)) {
        ++diagram_.left[segments_budget()];
        continue;
      }
      list.push_back(start_at(attractor, fmt::format("{}{}", sweep.letter, attractor.number),
                              sweep.samples.value_of(attractor), AttractorSamples::words_of(attractor)));
    }
    return list;
  }

  /// Attractors that lie on no branch yet, one of each number that has not been tried at its value.
  std::vector<BranchCandidate> more_seeds() {
    std::vector<BranchCandidate> list;
    for (const Sweep& sweep : sweeps_) {
      std::set<int> numbers;
      sweep.samples.for_each([&](const SweptAttractor& sample) {
        const SweepAttractor& attractor = *sample.attractor;
        if (!is_followed(attractor) || is_too_long(attractor) ||
            !branches_of(loaded_.library->system(), catalogue_, sweep, sample).empty())
          return;
        const std::string name = fmt::format("{}{}", sweep.letter, attractor.number);
        if (!numbers.insert(attractor.number).second || !tried_.insert({name, sample.value}).second) return;
        const Command words = sweep.samples.words_of(sample);
        if (!words.empty()) list.push_back(start_at(attractor, name, sample.value, words));
      });
    }
    return list;
  }

  /// Round after round; true where a branch has been found.
  bool follow(std::vector<BranchCandidate> round) {
    bool found = false;
    while (!round.empty() && goes_on()) {
      if (is_full()) {
        for (const BranchCandidate& candidate : round) leave(candidate, branches_budget());
        break;
      }
      std::vector<CommandJob> jobs;
      for (BranchCandidate& candidate : round) {
        candidate.branch.name = next_name();
        candidate.branch.job = candidate.make(candidate.branch.name);
        jobs.push_back(candidate.branch.job);
      }
      const std::vector<JobResult> results = runner_.run(jobs);
      std::vector<BranchCandidate> next;
      for (std::size_t i = 0; i < round.size(); ++i) found = take(round[i], results[i], next) || found;
      round = std::move(next);
    }
    return found;
  }

  bool is_full() const { return static_cast<int>(diagram_.branches.size()) >= request_.branches; }
  std::string branches_budget() const { return fmt::format("--branches {}", request_.branches); }
  std::string segments_budget() const { return fmt::format("--segments {}", request_.segments); }

  /// A budget leaves it.
  void leave(const BranchCandidate& candidate, const std::string& budget) {
    ++diagram_.left[budget];
    set_outcome(candidate, "", "left by " + budget);
  }

  void set_outcome(const BranchCandidate& candidate, const std::string& leads_to, const std::string& remark) {
    if (candidate.parent >= diagram_.branches.size()) return;
    if (candidate.returns > 1) return;
    ExploredLabel& label = diagram_.branches[candidate.parent].labels[candidate.label];
    label.leads_to = leads_to;
    label.remark = remark;
  }

  bool interrupt(const BranchCandidate& candidate) {
    diagram_.complete = false;
    set_outcome(candidate, "", "not followed: the exploration was interrupted");
    return false;
  }

  /// Of which known branches the sections of a run are parts, up to the first one that is new, or of all; nothing where
  /// that has not been found out, as the time limit was reached.
  std::optional<std::vector<KnownBranch>> known_branches(const std::vector<CataloguedSection>& sections, bool all) {
    const BranchRecognition recognition(catalogue_, commands_, loaded_.library->system(), runner_);
    std::vector<KnownBranch> known;
    for (const CataloguedSection& section : sections) {
      const std::optional<KnownBranch> same = recognition.branch_of(section);
      if (!same) return std::nullopt;
      known.push_back(*same);
      if (!all && is_new(section, *same)) break;
    }
    return known;
  }

  /// Has each direction ended where it began?
  static bool has_single_points(const PointFile& points) {
    return std::all_of(points.sections.begin(), points.sections.end(),
                       [](const PointSection& section) { return section.rows.size() < 2; });
  }

  static bool is_new(const CataloguedSection& section, const KnownBranch& known) {
    return known.name.empty() && section.parameter.size() > 1;
  }

  /// The branch that contains all sections with more than one point; "" if there is none.
  static std::string branch_of_all(const std::vector<CataloguedSection>& sections,
                                   const std::vector<KnownBranch>& known) {
    std::string name;
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (is_new(sections[i], known[i])) return "";
      if (!known[i].name.empty()) name = known[i].name;
    }
    return name;
  }

  bool is_switch_in_both_directions(const BranchCandidate& candidate) const {
    return candidate.parent < diagram_.branches.size() &&
           ExplorationCommands::goes_in_both_directions(candidate.branch.job);
  }

  /// Of a switch in both directions the one that is new, where all of the other one is on a known branch.
  std::optional<BranchCandidate> new_direction(const BranchCandidate& candidate,
                                               const std::vector<KnownBranch>& known) {
    if (!is_switch_in_both_directions(candidate) || known.size() != 2) return std::nullopt;
    const bool first_is_known = !known[0].name.empty();
    const KnownBranch& other = known[first_is_known ? 0 : 1];
    if (!other.is_whole || !known[first_is_known ? 1 : 0].name.empty()) return std::nullopt;
    BranchCandidate one = candidate;
    ExploredBranch& branch = one.branch;
    std::optional<double> ds;
    if (first_is_known) ds = -read_constants_file(commands_.file('r', branch.name)).step;
    one.make = [make = candidate.make, ds](const std::string& name) {
      return ExplorationCommands::one_direction(make(name), ds);
    };
    branch.name = next_name();
    branch.job = one.make(branch.name);
    branch.origin += fmt::format(", the other direction is {}", other.name);
    return one;
  }

  /// Has a direction ended by the number of its points, on its way through the range? Families of orbits at one value,
  /// and branches that wind to a homoclinic orbit, do not get on.
  bool is_cut_off(const RunRecord& record, const PointFile& points) const {
    constexpr double some_way = 0.02;
    const double width = commands_.range().to - commands_.range().from;
    if (record.ends.size() != points.sections.size()) return false;
    for (std::size_t k = 0; k < record.ends.size(); ++k) {
      if (record.ends[k].reason != "points") continue;
      const std::vector<PointRow>& rows = points.sections[k].rows;
      double low = rows.back().values.front(), high = low;
      for (std::size_t row = rows.size() / 2; row < rows.size(); ++row) {
        low = std::min(low, rows[row].values.front());
        high = std::max(high, rows[row].values.front());
      }
      if (high - low >= some_way * width) return true;
    }
    return false;
  }

  /// A run with more points in the place of one that was cut off.
  bool take_longer(BranchCandidate candidate, std::vector<BranchCandidate>& next) {
    candidate.points *= 4;
    candidate.branch.name = next_name();
    candidate.branch.job = ExplorationCommands::with_points(candidate.make(candidate.branch.name), candidate.points);
    return take(candidate, runner_.run({candidate.branch.job}).front(), next);
  }

  /// Says where its orbits are those of a known branch, reflected.
  void name_mirror(const std::vector<CataloguedSection>& sections, ExploredBranch& branch) {
    const BranchRecognition recognition(catalogue_, commands_, loaded_.library->system(), runner_);
    for (const CataloguedSection& section : sections) {
      const std::optional<MirroredBranch> mirror = recognition.mirror_of(section);
      if (!mirror) continue;
      branch.mirror_of = mirror->name;
      branch.origin += fmt::format("; {} in the mirror: {} change{} sign", mirror->name,
                                   fmt::join(mirror->states, ", "), mirror->states.size() > 1 ? "" : "s");
      return;
    }
  }

  /// Keeps a branch that is new, and adds what begins at its labels to the next round.
  bool take(const BranchCandidate& candidate, const JobResult& result, std::vector<BranchCandidate>& next) {
    ExploredBranch branch = candidate.branch;
    if (!result.was_run) return interrupt(candidate);
    if (!result.succeeded()) {
      set_outcome(candidate, "", "failed: " + result.failure);
      diagram_.failures.push_back(fmt::format("{} ({}): {}", branch.name, branch.origin, result.failure));
      return false;
    }
    const RunRecord record = run_record(commands_.file('d', branch.name));
    if (candidate.returns > 1 && record.only_at_start) return false;
    const PointFile points = read_point_file(commands_.file('p', branch.name));
    if (candidate.points < most_points && !commands_.limits_points() && is_cut_off(record, points))
      return take_longer(candidate, next);
    if (candidate.parent < diagram_.branches.size() && has_single_points(points)) {
      set_outcome(candidate, "", "no orbit of the range begins there");
      return false;
    }
    std::vector<CataloguedSection> sections =
        catalogued_sections(loaded_.library->system(), branch.name, points, commands_.monitors());
    const std::optional<std::vector<KnownBranch>> found =
        known_branches(sections, is_switch_in_both_directions(candidate));
    if (!found) return interrupt(candidate);
    if (const std::string known = branch_of_all(sections, *found); !known.empty()) {
      set_outcome(candidate, known, "");
      if (candidate.parent >= diagram_.branches.size()) met_[candidate.attractor] = known;
      diagram_.joins.push_back(fmt::format("{} ({}): {} again", branch.name, branch.origin, known));
      return false;
    }
    if (is_full()) {
      leave(candidate, branches_budget());
      return false;
    }
    if (const std::optional<BranchCandidate> one = new_direction(candidate, *found)) {
      const JobResult alone = runner_.run({one->branch.job}).front();
      if (!alone.was_run || alone.succeeded()) return take(*one, alone, next);
    }
    name_mirror(sections, branch);
    for (CataloguedSection& section : sections) catalogue_.add(std::move(section));
    describe_points(points, commands_.range(), branch);
    branch.ends = record.ends;
    branch.lost = record.lost;
    branch.points = record.points;
    branch.inadmissible = record.inadmissible;
    set_outcome(candidate, branch.name, "");
    diagram_.branches.push_back(branch);
    show(fmt::format("{}: {}, {} = {:.6g} to {:.6g}\n", branch.name, branch.origin, diagram_.parameter, branch.from,
                     branch.to));
    add_switches(diagram_.branches.size() - 1, next);
    return true;
  }

  /// The commands that follow the labels of a branch; none from tori.
  void add_switches(std::size_t at, std::vector<BranchCandidate>& next) {
    const std::string name = diagram_.branches[at].name;
    RunSettings settings = read_constants_file(commands_.file('r', name));
    const HybridSystem& system = loaded_.library->system();
    resolve_names(settings, system);
    const bool are_tori = family_of(settings).facts().has_several_returns;
    const SolutionFile solutions = read_solution_file(commands_.file('q', name));
    for (const LabelledSolution& solution : solutions.solutions) {
      const std::string type = type_name(solution);
      if (type == "EP" || type == "RG" || type.empty()) continue;
      ExploredLabel label{
          solution.label, type, stored_parameter(solution, settings.free_parameters.front()), "", "", ""};
      diagram_.branches[at].labels.push_back(label);
      if (!are_tori && !commands_at(solution, type, settings, name, name).empty())
        add_switch(at, solution, type, settings, next);
    }
  }

  /// The commands that follow what begins at a label, to files of `name`; none where nothing is followed.
  Commands commands_at(const LabelledSolution& solution, const std::string& type, const RunSettings& settings,
                       const std::string& parent, const std::string& name) const {
    const HybridSystem& system = loaded_.library->system();
    if (type == "LP" || type == "EX") return {};
    if (type == "GR" && loaded_.library->has_added_section()) return {};  // no jump: contact changes nothing
    if (type == "BE") {
      const int field = other_field_at_rest(system, solution, settings.segments.front().index.field);
      return field == 0 ? Commands{} : Commands{commands_.in_other_field(name, parent, solution.label, field)};
    }
    const NextStart start{solution.label, basic_type(solution.type), solution.kind};
    Commands commands =
        next_commands(start, settings, system, commands_.problem(), commands_.path(parent), commands_.names_of(name));
    if (!commands.empty() && commands.back().front() != "run") commands.clear();
    return commands;
  }

  /// How many segments the branch that begins at a label has, at least.
  static int segments_after(const std::string& type, const RunSettings& settings) {
    const auto own = static_cast<int>(settings.segments.size());
    const bool is_smooth = settings.segments.front().index.event == no_function;
    return type == "PD" && !is_smooth ? 2 * own : own;
  }

  void add_switch(std::size_t at, const LabelledSolution& solution, const std::string& type,
                  const RunSettings& settings, std::vector<BranchCandidate>& next) {
    const ExploredBranch& parent = diagram_.branches[at];
    const ExploredLabel& label = parent.labels.back();
    BranchCandidate candidate;
    candidate.parent = at;
    candidate.label = parent.labels.size() - 1;
    ExploredBranch& branch = candidate.branch;
    branch.parent = parent.name;
    branch.doublings = parent.doublings + (type == "PD" ? 1 : 0);
    branch.has_returns = parent.has_returns;
    if (type == "TR" && !request_.tori) return leave(candidate, "missing --tori");
    if (branch.doublings > request_.doublings)
      return leave(candidate, fmt::format("--doublings {}", request_.doublings));
    if (segments_after(type, settings) > request_.segments) return leave(candidate, segments_budget());
    branch.origin =
        fmt::format("{} {} of {} at {} = {:.6g}", type, label.label, parent.name, diagram_.parameter, label.parameter);
    candidate.make = [this, solution, type, settings, from = parent.name](const std::string& name) {
      return commands_.switching(name, {from, solution.label, type, commands_at(solution, type, settings, from, name)});
    };
    next.push_back(std::move(candidate));
    const Commands commands = commands_at(solution, type, settings, parent.name, "");
    const bool adds_impact =
        std::find(commands.front().begin(), commands.front().end(), "impacting") != commands.front().end();
    if (adds_impact && !parent.has_returns) add_returns(next.back(), {parent.name, solution.label, type, {}}, next);
  }

  /// At a grazing point, orbits with one impact in more than one return.
  void add_returns(BranchCandidate candidate, const SwitchPoint& at, std::vector<BranchCandidate>& next) const {
    const std::string origin = candidate.branch.origin;
    candidate.branch.has_returns = true;
    for (candidate.returns = 2; candidate.returns <= request_.returns.value_or(1); ++candidate.returns) {
      candidate.branch.origin = fmt::format("one impact in {} returns, {}", candidate.returns, origin);
      candidate.make = [this, at, returns = candidate.returns](const std::string& name) {
        return commands_.born(name, at, returns);
      };
      next.push_back(candidate);
    }
  }

  /// Writes what has been found, complete or not.
  int finish() {
    if (interrupted_()) diagram_.complete = false;
    const ExploredCurves curves = curves_ ? curves_->curves() : ExploredCurves{};
    measure_sweeps();
    plan_pictures(curves);
    write_tree(curves);
    write_makefile(curves);
    print_warnings(std::cerr, draw_pictures(diagram_.last_jobs, commands_.folder(), interrupted_));
    return diagram_.branches.empty() ? 1 : 0;
  }

  void measure_sweeps() {
    for (const Sweep& sweep : sweeps_)
      measure_coverage(loaded_.library->system(), sweep, catalogue_, commands_, diagram_);
    for (UnexplainedAttractor& one : diagram_.unexplained)
      if (const auto met = met_.find(one.attractor); met != met_.end()) one.leads_to = met->second;
  }

  void plan_pictures(const ExploredCurves& curves) {
    const std::string& folder = commands_.folder();
    std::vector<std::string> sweeps;
    for (const CommandJob& job : diagram_.first_jobs) sweeps.push_back(job.outputs.front());
    if (!sweeps_.empty())
      add_pictures({folder, sweeps, commands_.monitors(), request_.quantity}, sweeps_.front().samples.table(),
                   diagram_);
    std::vector<std::string> files;
    for (const ExploredCurve& curve : curves.curves) files.push_back(curve.job.outputs.front());
    add_curve_picture(folder, files, curves.second, diagram_);
  }

  /// O.txt, which is shown as well, and O.json.
  void write_tree(const ExploredCurves& curves) const {
    const std::string text = tree_text(diagram_) + curves_text(curves);
    write_whole_file(commands_.folder() + ".txt", text);
    write_whole_file(commands_.folder() + ".json", tree_json(diagram_, curves_json(curves)));
    show("\n" + text);
  }

  void write_makefile(const ExploredCurves& curves) const {
    const fs::path folder(commands_.folder());
    std::vector<CommandJob> jobs = jobs_of(diagram_);
    for (const CommandJob* const job : curve_jobs(curves)) jobs.push_back(*job);
    write_whole_file((folder.parent_path() / ("Makefile." + folder.filename().string())).string(),
                     makefile_text(jobs, diagram_.last_jobs, commands_.folder()));
  }

  ExploreRequest request_;
  std::ostream& screen_;
  LoadedProblem loaded_;
  ExplorationCommands commands_;
  std::unique_ptr<FileLock> lock_;
  std::chrono::steady_clock::time_point begun_;
  JobRunner runner_;
  std::function<bool()> interrupted_;
  std::vector<Sweep> sweeps_;
  OrbitCatalogue catalogue_;
  ExploredDiagram diagram_;
  std::set<std::pair<std::string, double>> tried_;
  std::map<std::string, std::string> met_;  // by attractor, the known branch that a start on it led to
  std::optional<CurveRounds> curves_;
  int named_ = 0;  // branches that have a name
};

}  // namespace

int explore(const ExploreRequest& request, const std::function<bool()>& interrupted, std::ostream& screen,
            std::ostream* progress) {
  return Explorer(request, interrupted, screen, progress).explore();
}

}  // namespace tchat
