#include "explore/explorer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

#include "constants/constants_file.hpp"
#include "constants/settings_type.hpp"
#include "explore/command_job.hpp"
#include "explore/orbit_catalogue.hpp"
#include "files/replaced_file.hpp"
#include "files/solution_file_reader.hpp"
#include "plugin/plugin_build.hpp"
#include "problem_type/point_type.hpp"
#include "problem_type/problem_type.hpp"
#include "run/next_command.hpp"
#include "setup/named_parameters.hpp"
#include "simulate/loaded_problem.hpp"
#include "sweep/sweep_file.hpp"
#include "text/number.hpp"
#include "text/user_error.hpp"
#include "text/words.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

/// "alpha=2.9:3.3:201" in its parts.
struct SweptRange {
  std::string parameter;
  double from = 0.0, to = 0.0;
  int count = 201;
};

SweptRange read_range(const std::string& text) {
  const auto refuse = [&] {
    throw UserError(
        fmt::format("--over {}: a parameter with the range of its values is needed, as alpha=2.9:3.3, or with "
                    "the number of values of the sweep, alpha=2.9:3.3:401",
                    in_quotes(text)));
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse();
  SweptRange range{text.substr(0, equals)};
  std::vector<std::string> parts;
  for (std::size_t from = equals + 1; from <= text.size();) {
    const std::size_t to = std::min(text.find(':', from), text.size());
    parts.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  if (parts.size() < 2 || parts.size() > 3) refuse();
  const std::optional<double> a = parse_real(parts[0]), b = parse_real(parts[1]);
  const std::optional<int> count = parts.size() == 3 ? parse_integer(parts[2]) : std::optional(range.count);
  if (!a || !b || !(*a < *b) || !count || *count < 2) refuse();
  range.from = *a, range.to = *b, range.count = *count;
  return range;
}

bool sets_parameter(const std::string& word) { return word.starts_with("PAR("); }

std::string number_text(double value) { return fmt::format("{:.17g}", value); }

/// Words quoted for the shell, with blanks before each.
std::string quoted(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += " " + quoted_for_shell(word);
  return text;
}

/// A switch that is to be followed, and what it begins at.
struct Candidate {
  ExploredBranch branch;
  std::size_t parent = 0;  ///< of the diagram's branches; beyond them without one
  std::size_t label = 0;   ///< of the parent's labels
};

class Explorer {
 public:
  Explorer(const ExploreRequest& request, const std::function<bool()>& interrupted, std::ostream& screen,
           std::ostream* progress)
      : request_(request),
        range_(read_range(request.over)),
        folder_(request.output.value_or(request.name + ".diagram")),
        screen_(screen),
        loaded_(load_for_simulation(simulation_request(request), progress)),
        problem_(request.problem.value_or(request.name)),
        begun_(std::chrono::steady_clock::now()),
        runner_(folder_, request.workers, [this, interrupted] { return interrupted() || is_late(); }),
        interrupted_(interrupted) {
    const HybridSystem& system = loaded_.library->system();
    if (system.parameter_index(range_.parameter) == 0 && !parse_integer(range_.parameter))
      throw UserError(fmt::format("--over {}: {} has no parameter of this name", range_.parameter, system.name()));
    for (const std::string& word : request.overrides) (sets_parameter(word) ? parameters_ : constants_).push_back(word);
    for (int k = 1; k <= system.dimension() && monitors_.size() + 2 <= max_monitors; ++k)
      for (const char* kind : {"mean", "max"}) monitors_.push_back(fmt::format("{}({})", kind, state_word(k)));
    diagram_.parameter = range_.parameter;
  }

  int explore() {
    fs::create_directories(folder_);
    if (!sweep()) return finish();
    follow(seeds());
    for (bool found = true; found && goes_on();) found = follow(more_seeds());
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

  bool is_late() const {
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begun_;
    return request_.seconds > 0.0 && time.count() > request_.seconds;
  }
  bool goes_on() const { return diagram_.complete && !interrupted_(); }

  std::string state_word(int k) const {
    const std::string name = loaded_.library->system().state_name(k);
    return name.find_first_of(" \t(),") == std::string::npos ? name : fmt::format("U({})", k);
  }
  std::string file(char letter, const std::string& name) const { return folder_ + "/" + letter + "." + name; }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  std::string at_value(double value) const { return fmt::format("PAR({})={}", range_.parameter, number_text(value)); }
  std::string icp() const {
    std::string list = "ICP=[" + range_.parameter;
    for (const std::string& name : monitors_) list += "," + name;
    return list + "]";
  }

  /// The words of all runs: the range, steps that are fractions of it, then what the user says.
  std::vector<std::string> run_words() const {
    const double width = range_.to - range_.from;
    std::vector<std::string> words{icp(),
                                   "RL0=" + number_text(range_.from),
                                   "RL1=" + number_text(range_.to),
                                   fmt::format("DS={:g}", width / 200.0),
                                   fmt::format("DSMAX={:g}", width / 20.0),
                                   "NMX=400"};
    words.insert(words.end(), constants_.begin(), constants_.end());
    return words;
  }

  void show(const std::string& text) const {
    if (!request_.quiet) screen_ << text << std::flush;
  }

  bool sweep() {
    CommandJob job{"sweep", {}, {}, {path("sweep.sweep")}};
    std::string states;
    for (const std::string& state : request_.states) states += " --state " + quoted_for_shell(state);
    std::vector<std::string> over{
        fmt::format("{}={}:{}:{}", range_.parameter, number_text(range_.from), number_text(range_.to), range_.count)};
    job.lines = {fmt::format("tchat sweep {}{} --over{}{}{} --follow both -o {} -j {} -q", problem_arguments(problem_),
                             constants_option(), quoted(over), states, quoted(parameters_),
                             quoted_for_shell(path("sweep")), request_.workers)};
    diagram_.first_jobs = {job};
    const JobResult result = runner_.run({job}).front();
    if (!result.was_run) {
      diagram_.complete = false;
      return false;
    }
    if (!result.succeeded) throw ComputationError(fmt::format("the sweep failed:\n{}", result.log));
    sweep_ = read_sweep_file(path("sweep.sweep"));
    return true;
  }

  std::string constants_option() const {
    return request_.constants ? " -c " + quoted_for_shell(*request_.constants) : "";
  }

  /// A branch through an attractor, from a state on it.
  Candidate from_state(const std::string& name, const std::string& origin, double value,
                       const std::string& state) const {
    Candidate candidate;
    ExploredBranch& branch = candidate.branch;
    branch.name = name;
    branch.origin = origin;
    candidate.parent = std::string::npos;
    const std::string arguments = problem_arguments(problem_);
    std::vector<std::string> simulated = parameters_;
    simulated.push_back(at_value(value));
    branch.job = {
        name,
        {fmt::format("tchat simulate {}{}{}{} --free {} -o {} --dat -q", arguments, constants_option(), state,
                     quoted(simulated), quoted_for_shell(range_.parameter), quoted_for_shell(path(name))),
         fmt::format("tchat run {} -c {} -d {} -o {} --both --clip -q{}", arguments, quoted_for_shell(path(name)),
                     quoted_for_shell(path(name)), quoted_for_shell(path(name)), quoted(run_words()))},
        {},
        files_of(name)};
    return candidate;
  }

  std::vector<std::string> files_of(const std::string& name) const {
    return {file('p', name), file('q', name), file('d', name), file('r', name)};
  }

  /// A branch for each attractor that repeats itself or rests.
  std::vector<Candidate> seeds() const {
    std::vector<Candidate> list;
    for (const SweepAttractor& attractor : sweep_.attractors) {
      if (attractor.kind != AttractorKind::periodic && attractor.kind != AttractorKind::rest) continue;
      const double value = sweep_.over.front().value(static_cast<long>(attractor.index));
      std::string state = " --state ";
      for (Eigen::Index k = 0; k < attractor.state.size(); ++k)
        state += (k > 0 ? "," : "") + number_text(attractor.state(k));
      if (!attractor.mode.empty()) state += " --mode " + quoted_for_shell(attractor.mode);
      list.push_back(from_state(fmt::format("a{}", attractor.number),
                                fmt::format("attractor {} at {} = {:.6g}", attractor.number, range_.parameter, value),
                                value, state));
    }
    return list;
  }

  /// Attractors of the sweep that lie on no branch yet, one of each number that has not been tried at its value.
  std::vector<Candidate> more_seeds() {
    std::vector<Candidate> list;
    std::set<int> numbers;
    for_each_sample([&](std::size_t row, int attractor, double value, double period) {
      const SweepAttractor& known = sweep_.attractors[static_cast<std::size_t>(attractor - 1)];
      if (known.kind != AttractorKind::periodic || !branch_of_sample(known, value, period).empty()) return;
      if (!numbers.insert(attractor).second || !tried_.insert({attractor, value}).second) return;
      const std::string state = state_of_row(row);
      if (state.empty()) return;
      list.push_back(from_state(fmt::format("a{}_{}", attractor, tried_.size()),
                                fmt::format("attractor {} at {} = {:.6g}", attractor, range_.parameter, value), value,
                                " --state " + state + " --before-event"));
    });
    return list;
  }

  std::string state_of_row(std::size_t row) const {
    std::string text;
    for (int k = 1; k <= loaded_.library->system().dimension(); ++k) {
      const std::vector<double>* column = sweep_.column(loaded_.library->system().state_name(k));
      if (column == nullptr || !std::isfinite((*column)[row])) return "";
      text += (k > 1 ? "," : "") + number_text((*column)[row]);
    }
    return text;
  }

  /// use(row, attractor, value, period in time) for the first row of each value and start that has an attractor.
  template <class Use>
  void for_each_sample(const Use& use) const {
    const std::vector<double>& index = *sweep_.column("index");
    const std::vector<double>& start = *sweep_.column("start");
    const std::vector<double>& attractor = *sweep_.column("attractor");
    const std::vector<double>& time = *sweep_.column("time");
    const std::vector<double>& value = *sweep_.column(sweep_.over.front().column());
    for (std::size_t row = 0; row < sweep_.rows(); ++row) {
      if (row > 0 && index[row] == index[row - 1] && start[row] == start[row - 1]) continue;
      if (attractor[row] >= 1.0) use(row, static_cast<int>(attractor[row]), value[row], time[row]);
    }
  }

  std::string branch_of_sample(const SweepAttractor& attractor, double value, double period) const {
    SignatureWord word;
    for (const IndexVector& v : parse_signature(attractor.signature)) word.push_back({v.field, v.event, v.jump});
    return catalogue_.branch_with_period(word, value, period);
  }

  /// Round after round; true where a branch has been found.
  bool follow(std::vector<Candidate> round) {
    bool found = false;
    while (!round.empty() && goes_on()) {
      std::vector<CommandJob> jobs;
      for (const Candidate& candidate : round) jobs.push_back(candidate.branch.job);
      const std::vector<JobResult> results = runner_.run(jobs);
      std::vector<Candidate> next;
      for (std::size_t i = 0; i < round.size(); ++i) found = take(round[i], results[i], next) || found;
      round = std::move(next);
    }
    return found;
  }

  void set_outcome(const Candidate& candidate, const std::string& leads_to, const std::string& remark) {
    if (candidate.parent >= diagram_.branches.size()) return;
    ExploredLabel& label = diagram_.branches[candidate.parent].labels[candidate.label];
    label.leads_to = leads_to;
    label.remark = remark;
  }

  /// Keeps a branch that is new, and adds what begins at its labels to the next round.
  bool take(const Candidate& candidate, const JobResult& result, std::vector<Candidate>& next) {
    ExploredBranch branch = candidate.branch;
    if (!result.was_run) {
      diagram_.complete = false;
      set_outcome(candidate, "", "not followed: the exploration was interrupted");
      return false;
    }
    if (!result.succeeded) {
      set_outcome(candidate, "", "failed: " + last_line(result.log));
      if (candidate.parent >= diagram_.branches.size())
        diagram_.joins.push_back(fmt::format("{} ({}): failed: {}", branch.name, branch.origin, last_line(result.log)));
      return false;
    }
    const PointFile points = read_point_file(file('p', branch.name));
    std::vector<CataloguedSection> sections = catalogued_sections(branch.name, points, monitors_);
    std::string known;
    for (const CataloguedSection& section : sections) {
      const std::string same = catalogue_.branch_of(section);
      if (same.empty() && section.parameter.size() > 1) {
        known.clear();
        break;
      }
      if (!same.empty()) known = same;
    }
    if (!known.empty()) {
      set_outcome(candidate, known, "");
      diagram_.joins.push_back(fmt::format("{} ({}): {} again", branch.name, branch.origin, known));
      return false;
    }
    if (static_cast<int>(diagram_.branches.size()) >= request_.branches) {
      diagram_.left = fmt::format("--branches {} reached", request_.branches);
      set_outcome(candidate, "", "left: " + diagram_.left);
      return false;
    }
    for (CataloguedSection& section : sections) catalogue_.add(std::move(section));
    describe(points, branch);
    set_outcome(candidate, branch.name, "");
    diagram_.branches.push_back(branch);
    show(fmt::format("{}: {}, {} = {:.6g} to {:.6g}\n", branch.name, branch.origin, range_.parameter, branch.from,
                     branch.to));
    add_switches(diagram_.branches.size() - 1, next);
    return true;
  }

  static std::string last_line(const std::string& log) {
    const std::string_view text = trimmed(log);
    const std::size_t end = text.find_last_of('\n');
    return std::string(end == std::string_view::npos ? text : text.substr(end + 1));
  }

  void describe(const PointFile& points, ExploredBranch& branch) const {
    branch.from = std::numeric_limits<double>::infinity();
    branch.to = -branch.from;
    for (const PointSection& section : points.sections) {
      for (const PointRow& row : section.rows) {
        branch.from = std::max(range_.from, std::min(branch.from, row.values.front()));
        branch.to = std::min(range_.to, std::max(branch.to, row.values.front()));
      }
      Signature signature;
      for (const auto& v : section.signature) signature.push_back({v[0], v[1], v[2]});
      if (const std::string text = to_string(signature);
          std::find(branch.signatures.begin(), branch.signatures.end(), text) == branch.signatures.end())
        branch.signatures.push_back(text);
    }
  }

  /// The commands that follow the labels of a branch.
  void add_switches(std::size_t at, std::vector<Candidate>& next) {
    const std::string name = diagram_.branches[at].name;
    const std::string constants = file('r', name);
    RunSettings settings = read_constants_file(constants);
    const HybridSystem& system = loaded_.library->system();
    resolve_names(settings, system);
    const SolutionFile solutions = read_solution_file(file('q', name));
    for (const LabelledSolution& solution : solutions.solutions) {
      const std::string type = type_name(solution);
      if (type == "EP" || type == "RG" || type.empty()) continue;
      ExploredLabel label{solution.label, type, stored_parameter(solution, settings.free_parameters.front()), "", ""};
      const NextStart start{solution.label, basic_type(solution.type), solution.kind};
      const bool is_curve = type == "LP" || type == "EX";
      const std::string command = is_curve ? "" : next_command(start, settings, system, problem_, path(name));
      diagram_.branches[at].labels.push_back(label);
      if (command.empty()) continue;
      add_switch(at, type, command, next);
    }
  }

  void add_switch(std::size_t at, const std::string& type, const std::string& command, std::vector<Candidate>& next) {
    const ExploredBranch& parent = diagram_.branches[at];
    const std::size_t number = parent.labels.size() - 1;
    ExploredLabel& label = diagram_.branches[at].labels.back();
    if (type == "TR") {
      label.remark = "left: tori are not followed";
      return;
    }
    Candidate candidate;
    candidate.parent = at;
    candidate.label = number;
    ExploredBranch& branch = candidate.branch;
    branch.parent = parent.name;
    branch.doublings = parent.doublings + (type == "PD" ? 1 : 0);
    if (branch.doublings > request_.doublings) {
      label.remark = fmt::format("left: --doublings {} reached", request_.doublings);
      return;
    }
    const std::string start = fmt::format("{}_{}{}", parent.name, type, label.label);
    branch.origin =
        fmt::format("{} {} of {} at {} = {:.6g}", type, label.label, parent.name, range_.parameter, label.parameter);
    const std::size_t both = command.find(" && ");
    branch.name = both == std::string::npos ? start : start + "_branch";
    branch.job = {branch.name, {}, {file('q', parent.name), file('r', parent.name)}, files_of(branch.name)};
    if (both != std::string::npos) branch.job.lines.push_back(command.substr(0, both) + " -q");
    std::string run = both == std::string::npos ? command : command.substr(both + 4);
    run += std::string(type == "BP" ? " --both" : "") + " --clip -q";
    std::vector<std::string> words = run_words();
    if (both != std::string::npos || type == "HB") {  // the sign of DS has been chosen
      std::erase_if(words, [](const std::string& word) { return word.starts_with("DS="); });
      run += quoted(words);
    } else {
      run += quoted(constants_);
    }
    branch.job.lines.push_back(run);
    next.push_back(std::move(candidate));
  }

  void measure_coverage() {
    std::map<int, UnexplainedAttractor> missing;
    for_each_sample([&](std::size_t row, int attractor, double value, double period) {
      const SweepAttractor& known = sweep_.attractors[static_cast<std::size_t>(attractor - 1)];
      const bool repeats = known.kind == AttractorKind::periodic;
      (repeats ? diagram_.periodic : diagram_.other) += 1;
      if (repeats && !branch_of_sample(known, value, period).empty()) {
        ++diagram_.on_branches;
        return;
      }
      UnexplainedAttractor& one = missing[attractor];
      if (one.count++ == 0) {
        const std::string state = state_of_row(row);
        one = {attractor, to_string(known.kind), value, value, 1, ""};
        if (!state.empty())
          one.command = fmt::format("tchat simulate {} --state {}{}", problem_arguments(problem_), state,
                                    quoted({at_value(value)}));
      }
      one.last = value;
    });
    for (auto& [number, one] : missing) diagram_.unexplained.push_back(std::move(one));
  }

  static void write(const std::string& path, const std::string& text) {
    ReplacedFile out(path);
    out.write(text);
    out.finish();
  }

  int finish() {
    if (sweep_.rows() > 0) measure_coverage();
    const std::string text = tree_text(diagram_);
    write(folder_ + ".txt", text);
    write(folder_ + ".json", tree_json(diagram_));
    write((fs::path(folder_).parent_path() / ("Makefile." + fs::path(folder_).filename().string())).string(),
          makefile_text(diagram_, folder_));
    show("\n" + text);
    return diagram_.branches.empty() ? 1 : 0;
  }

  ExploreRequest request_;
  SweptRange range_;
  std::string folder_;
  std::ostream& screen_;
  LoadedProblem loaded_;
  std::string problem_;
  std::vector<std::string> parameters_, constants_;
  std::vector<std::string> monitors_;
  std::chrono::steady_clock::time_point begun_;
  JobRunner runner_;
  std::function<bool()> interrupted_;
  SweepTable sweep_;
  OrbitCatalogue catalogue_;
  ExploredDiagram diagram_;
  std::set<std::pair<int, double>> tried_;
};

}  // namespace

int explore(const ExploreRequest& request, const std::function<bool()>& interrupted, std::ostream& screen,
            std::ostream* progress) {
  return Explorer(request, interrupted, screen, progress).explore();
}

}  // namespace tchat
