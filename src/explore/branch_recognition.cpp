#include "explore/branch_recognition.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/levels.hpp"
#include "base/words.hpp"
#include "files/dat_file.hpp"
#include "files/solution_file_reader.hpp"
#include "model/parameter_vector.hpp"
#include "model/scales.hpp"
#include "motion/orbit_identity.hpp"
#include "motion/recurrence.hpp"

namespace tchat {

namespace {

/// The state of "up from x = (0.1, -2)".
std::vector<double> numbers_of_start(const std::string& text) {
  std::vector<double> numbers;
  const std::size_t open = text.find("x = (");
  if (open == std::string::npos) return numbers;
  for (std::size_t at = open + 5; at < text.size();) {
    const std::size_t end = text.find_first_of(",)", at);
    if (end == std::string::npos) break;
    numbers.push_back(parse_real(std::string(trimmed(std::string_view(text).substr(at, end - at)))).value_or(NAN));
    at = end + 1;
  }
  return numbers;
}

/// What is watched on the first segment.
Command mode_words(const SweepAttractor& attractor) {
  return attractor.mode.empty() ? Command{} : Command{"--mode", attractor.mode};
}

Command state_words(const Eigen::VectorXd& state) {
  return {"--state", fmt::format("{}", fmt::join(state.begin(), state.end(), ","))};
}

}  // namespace

std::vector<std::size_t> AttractorSamples::first_rows() const {
  std::vector<std::size_t> rows;
  if (table_.rows() == 0) return rows;
  const std::vector<double>& index = *table_.column("index");
  const std::vector<double>& start = *table_.column("start");
  for (std::size_t row = 0; row < table_.rows(); ++row)
    if (row == 0 || index[row] != index[row - 1] || start[row] != start[row - 1]) rows.push_back(row);
  return rows;
}

void AttractorSamples::for_each(const std::function<void(const SweptAttractor&)>& use) const {
  for (const std::size_t row : first_rows()) {
    const double found = (*table_.column("attractor"))[row];
    const std::size_t number = found >= 1.0 ? static_cast<std::size_t>(found) : 0;
    if (number >= 1 && number <= table_.attractors.size())
      use({&table_.attractors[number - 1], row, (*table_.column(table_.over.front().column()))[row],
           (*table_.column("time"))[row]});
  }
}

std::vector<double> AttractorSamples::values_of(const SweptAttractor& sample,
                                                const std::vector<std::string>& names) const {
  std::vector<double> values;
  for (const std::string& name : names) {
    const std::vector<double>* const column = table_.column(name);
    values.push_back(column == nullptr ? std::numeric_limits<double>::quiet_NaN() : (*column)[sample.row]);
  }
  return values;
}

std::map<AttractorKind, int> AttractorSamples::kinds() const {
  std::map<AttractorKind, int> counts;
  for (const std::size_t row : first_rows()) ++counts[table_.kinds[row]];
  return counts;
}

std::optional<Eigen::VectorXd> AttractorSamples::numbers_of(const SweptAttractor& sample) const {
  const auto n = static_cast<int>(state_names_.size());
  Eigen::VectorXd state(n);
  for (int k = 1; k <= n; ++k) {
    const std::vector<double>* column = table_.state(k, state_names_);
    if (column == nullptr || !std::isfinite((*column)[sample.row])) return std::nullopt;
    state(k - 1) = (*column)[sample.row];
  }
  return state;
}

Command AttractorSamples::words_of(const SweptAttractor& sample) const {
  const std::optional<Eigen::VectorXd> state = numbers_of(sample);
  if (!state) return {};
  const Command words = state_words(*state);
  if (sample.attractor->kind != AttractorKind::periodic) return words;
  return tchat::words_of({words, mode_words(*sample.attractor), {"--before-event"}});
}

/// A motion that leaves says nothing of where attractors are.
Eigen::MatrixX2d AttractorSamples::box() const {
  const auto n = static_cast<int>(state_names_.size());
  Eigen::MatrixX2d box(n, 2);
  box.col(0).setConstant(INFINITY);
  box.col(1).setConstant(-INFINITY);
  const auto add = [&](int k, double value) {
    if (!std::isfinite(value)) return;
    box(k, 0) = std::min(box(k, 0), value);
    box(k, 1) = std::max(box(k, 1), value);
  };
  for (const std::string& start : table_.starts)
    if (const std::vector<double> numbers = numbers_of_start(start); std::ssize(numbers) == n)
      for (int k = 0; k < n; ++k) add(k, numbers[static_cast<std::size_t>(k)]);
  for (int k = 0; k < n; ++k)
    if (const std::vector<double>* column = table_.state(k + 1, state_names_))
      for (std::size_t row = 0; row < column->size(); ++row)
        if (table_.kinds[row] != AttractorKind::none && table_.kinds[row] != AttractorKind::escape)
          add(k, (*column)[row]);
  return box;
}

double AttractorSamples::size() const {
  const Eigen::MatrixX2d limits = box();
  return limits.allFinite() ? limits.cwiseAbs().maxCoeff() : 0.0;
}

std::vector<std::string> AttractorSamples::further_starts(
    int count, const std::function<bool(const Eigen::VectorXd&)>& is_inside) const {
  constexpr int tries = 50;
  const Eigen::MatrixX2d limits = box();
  const Eigen::Index n = limits.rows();
  if (!limits.allFinite()) return {};
  double base = 2.0;  // the sequence of Roberts: additive, with powers of the root of g^(n+1) = g + 1
  for (int step = 0; step < 100; ++step) base = std::pow(1.0 + base, 1.0 / static_cast<double>(n + 1));
  std::vector<std::string> states;
  for (int number = 1; number <= tries * count && std::ssize(states) < count; ++number) {
    Eigen::VectorXd state(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const double place = 0.5 + number * std::pow(base, -static_cast<double>(k + 1));
      state(k) = limits(k, 0) + (place - std::floor(place)) * (limits(k, 1) - limits(k, 0));
    }
    if (is_inside(state)) states.push_back(fmt::format("{:.4g}", fmt::join(state.begin(), state.end(), ",")));
  }
  return states;
}

Command AttractorSamples::words_of(const SweepAttractor& attractor) {
  return tchat::words_of({state_words(attractor.state), mode_words(attractor)});
}

double AttractorSamples::value_of(const SweepAttractor& attractor) const {
  return table_.over.front().value(static_cast<long>(attractor.index));
}

Signature signature_of(const SweepAttractor& attractor) {
  return attractor.signature.empty() ? Signature() : parse_signature(attractor.signature);
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double same_parameter = level::orbit;  // of the largest |p| of the branch
constexpr double same_orbit = level::same, clearly_different = level::five_digits;
/// The parameter of a fold is known far better than the place on the branch.
constexpr double same_at_fold = level::visible;

/// Has the parameter of a branch this value of another one?
bool is_at(double parameter, double value, const CataloguedSection& branch) {
  double largest = std::abs(value);
  for (const double other : branch.parameter) largest = std::max(largest, std::abs(other));
  return std::abs(parameter - value) <= same_parameter * largest;
}

/// Which solutions can be compared? Not tori.
bool is_comparable(const LabelledSolution& x) {
  const int n = x.dimension;
  if (n < 1 || x.states.size() == 0 || x.states.rows() % n != 0) return false;
  const FamilyFacts& facts = family_of(x.problem_type).facts();
  return !facts.headings.has_period ||
         (!keeps_contact(x.problem_type) && facts.has_return_map && !facts.has_several_returns);
}

/// The nodes of each segment.
std::vector<MatrixXd> segments_of(const LabelledSolution& x) {
  std::vector<MatrixXd> segments;
  for (Index row = 0; row < x.states.rows(); row += x.dimension)
    segments.push_back(x.states.middleRows(row, x.dimension));
  return segments;
}

/// Of an equilibrium: its state, and the sizes of the states.
ComparedOrbit compared_rest(const HybridSystem& system, int field, const VectorXd& x, const ParameterVector& par) {
  StateSizes sizes(x);
  sizes.add_at_rest(system, field, x.data(), par.data());
  return {{IndexVector{}}, x, sizes.sizes(), {}, {}, NAN};
}

/// Differences of states that nothing depends on count for nothing, and the number of impacts up to a limit neither.
std::optional<ComparedOrbit> compared_orbit(const HybridSystem& system, const LabelledSolution& solution,
                                            const Signature& signature) {
  if (!is_comparable(solution)) return std::nullopt;
  const std::vector<double> stored = in_layout(solution, system.layout()).parameters;
  ParameterVector par = initial_parameters(system);
  for (Index k = 0; k < std::min<Index>(system.parameters(), std::ssize(stored)); ++k)
    par(k) = stored[static_cast<std::size_t>(k)];
  if (!family_of(solution.problem_type).facts().headings.has_period)
    return compared_rest(system, signature.empty() ? 1 : signature.front().field,
                         solution.states.col(0).head(solution.dimension), par);
  ComparedOrbit orbit{signature, {}, {}, segments_of(solution), solution.tau, NAN};
  if (std::ssize(orbit.tau) != solution.states.cols() || std::ssize(orbit.segments) != std::ssize(signature))
    return std::nullopt;
  const Index m = std::ssize(orbit.segments);
  MatrixXd extremes(solution.dimension, 2 * m);
  orbit.ends.resize(solution.dimension, m);
  std::vector<VectorXd> points;
  for (Index s = 0; s < m; ++s) {
    const MatrixXd& nodes = orbit.segments[static_cast<std::size_t>(s)];
    extremes.col(2 * s) = nodes.rowwise().minCoeff();
    extremes.col(2 * s + 1) = nodes.rowwise().maxCoeff();
    orbit.ends.col(s) = nodes.rightCols(1);
    if (s == 0)
      for (const Index column : {Index(0), nodes.cols() / 2, nodes.cols() - 1}) points.emplace_back(nodes.col(column));
  }
  if (const auto first = static_cast<Index>(system.layout().duration(0)) - 1; first + m <= std::ssize(stored))
    orbit.period = std::accumulate(stored.begin() + first, stored.begin() + first + m, 0.0);
  StateSizes sizes(extremes);
  for (Index s = 0; s < m; ++s)
    sizes.add(system, FunctionKind::field, signature[static_cast<std::size_t>(s)].field, orbit.ends.col(s).data(),
              par.data());
  std::vector<bool> rounding = sizes.known();
  rounding.flip();
  orbit.sizes = sizes_of_differences(extremes.rowwise().minCoeff(), extremes.rowwise().maxCoeff(), rounding,
                                     ignorable_states(system, points, par));
  const std::vector<std::size_t> left = system.without_chatter(signature);
  if (std::ssize(left) == m) return orbit;
  ComparedOrbit common{{}, MatrixXd(solution.dimension, std::ssize(left)), orbit.sizes, {}, orbit.tau, orbit.period};
  for (const std::size_t s : left) {
    common.ends.col(std::ssize(common.signature)) = orbit.ends.col(static_cast<Index>(s));
    common.signature.push_back(signature[s]);
    common.segments.push_back(orbit.segments[s]);
  }
  return common;
}

LabelledSolution read_label_of(const std::string& path, int label) {
  const StartLabel wanted = read_label(std::to_string(label));
  return find_solution(read_solution_file(path, wanted).solutions, wanted, path);
}

/// Do no two orbits come together there? They do at a bifurcation, and where the velocity of an impact passes zero and
/// the branch turns.
bool is_regular(const LabelledSolution& solution) {
  if (is_bifurcation(static_cast<PointType>(basic_type(solution.type)))) return false;
  const std::vector<UserPointKind> kinds = all_kinds(solution);
  return std::none_of(kinds.begin(), kinds.end(), [](const UserPointKind& one) {
    return one.kind == UserPointKind::impact_velocity ||
           (one.kind == UserPointKind::other_type && is_bifurcation(static_cast<PointType>(one.index)));
  });
}

/// At a fold two orbits of one branch come together.
bool is_at_fold(const LabelledSolution& solution) {
  const std::vector<UserPointKind> kinds = all_kinds(solution);
  return is_fold(static_cast<PointType>(basic_type(solution.type))) &&
         std::none_of(kinds.begin(), kinds.end(), [](const UserPointKind& one) {
           return one.kind == UserPointKind::impact_velocity || one.kind == UserPointKind::other_type;
         });
}

Index nearest_labelled(const CataloguedSection& section, Index point) {
  Index nearest = -1;
  for (Index row = 0; row < std::ssize(section.labels); ++row)
    if (section.labels[static_cast<std::size_t>(row)] > 0 &&
        (nearest < 0 || std::abs(row - point) < std::abs(nearest - point)))
      nearest = row;
  return nearest;
}

}  // namespace

/// One of a section's own orbits, at one of its points.
struct BranchRecognition::OwnOrbit {
  const CataloguedSection* section = nullptr;
  Index row = 0;
  LabelledSolution solution;

  double parameter() const { return section->parameter[static_cast<std::size_t>(row)]; }
};

/// Where a run along a known branch starts, and how many points it is away from the value at most.
struct BranchRecognition::KnownStart {
  const CataloguedSection* section = nullptr;
  int label = 0;
  Index points = 0;
};

std::optional<BranchRecognition::OwnOrbit> BranchRecognition::last_regular_orbit(
    const CataloguedSection& section) const {
  const SolutionFile file = read_solution_file(commands_.file('q', section.branch));
  for (bool (*const is_wanted)(const LabelledSolution&) : {&is_regular, &is_at_fold})
    for (Index row = std::ssize(section.labels) - 1; row >= 0; --row)
      for (const LabelledSolution& solution : file.solutions)
        if (solution.label == section.labels[static_cast<std::size_t>(row)] && is_wanted(solution))
          return OwnOrbit{&section, row, solution};
  return std::nullopt;
}

std::optional<KnownBranch> BranchRecognition::branch_of(const CataloguedSection& section) const {
  const KnownBranch by_numbers{catalogue_.branch_of(section)};
  const std::vector<std::string> near = catalogue_.branches_near(section);
  if (near.empty()) return by_numbers;
  const std::optional<OwnOrbit> own = last_regular_orbit(section);
  if (!own) return by_numbers;
  bool is_refuted = false;
  for (const std::string& branch : near) {
    const Verdict verdict = compare(*own, branch);
    if (verdict == Verdict::interrupted) return std::nullopt;
    if (verdict == Verdict::same) return KnownBranch{branch, catalogue_.has_beginning(branch, section)};
    is_refuted = is_refuted || (verdict == Verdict::different && branch == by_numbers.name);
  }
  return is_refuted ? KnownBranch{} : by_numbers;
}

bool BranchRecognition::is_same(const OwnOrbit& own, const CataloguedSection& known,
                                const LabelledSolution& other) const {
  if (own.solution.problem_type != other.problem_type) return false;
  const auto a = compared_orbit(system_, own.solution, own.section->own_signature),
             b = compared_orbit(system_, other, known.own_signature);
  return a && b && orbit_distance(*a, *b) <= (is_at_fold(own.solution) ? same_at_fold : same_orbit);
}

BranchRecognition::Verdict BranchRecognition::compare(const OwnOrbit& own, const std::string& branch) const {
  Verdict verdict = compare_with_labels(own, branch);
  if (verdict == Verdict::same) return verdict;
  for (const KnownStart& start : starts_near(own, branch)) {
    verdict = compare_with_run(own, start);
    if (verdict != Verdict::different) return verdict;
  }
  return verdict;
}

/// Unknown where no label is at this value.
BranchRecognition::Verdict BranchRecognition::compare_with_labels(const OwnOrbit& own,
                                                                  const std::string& branch) const {
  Verdict verdict = Verdict::unknown;
  for (const CataloguedSection& known : catalogue_.sections()) {
    if (known.branch != branch || known.rests != own.section->rests) continue;
    for (std::size_t row = 0; row < known.parameter.size(); ++row) {
      if (known.labels[row] == 0 || !is_at(known.parameter[row], own.parameter(), known)) continue;
      if (is_same(own, known, read_label_of(commands_.file('q', branch), known.labels[row]))) return Verdict::same;
      verdict = Verdict::different;
    }
  }
  return verdict;
}

std::optional<MirroredBranch> BranchRecognition::mirror_of(const CataloguedSection& section) const {
  if (section.rests) return std::nullopt;
  const std::vector<LabelledSolution> solutions = read_solution_file(commands_.file('q', section.branch)).solutions;
  for (const CataloguedSection& known : catalogue_.sections()) {
    if (known.branch == section.branch || known.rests) continue;
    if (std::optional<MirroredBranch> mirror = mirror_in(known, section, solutions)) return mirror;
  }
  return std::nullopt;
}

std::optional<MirroredBranch> BranchRecognition::mirror_in(const CataloguedSection& known,
                                                           const CataloguedSection& section,
                                                           const std::vector<LabelledSolution>& solutions) const {
  for (const LabelledSolution& solution : solutions) {
    const auto own = std::find(section.labels.begin(), section.labels.end(), solution.label);
    // Where branches meet, orbits say nothing of the others.
    if (own == section.labels.end() || !is_regular(solution)) continue;
    const Index row = own - section.labels.begin();
    for (Index at = 0; at < std::ssize(known.labels); ++at) {
      const int label = known.labels[static_cast<std::size_t>(at)];
      const double period = known.numbers(0, at), own_period = section.numbers(0, row);
      if (label == 0 || std::abs(period - own_period) > same_orbit * period ||
          !is_at(known.parameter[static_cast<std::size_t>(at)], section.parameter[static_cast<std::size_t>(row)],
                 known))
        continue;
      const LabelledSolution other = read_label_of(commands_.file('q', known.branch), label);
      const auto a = compared_orbit(system_, solution, section.own_signature),
                 b = compared_orbit(system_, other, known.own_signature);
      if (!a || !b || solution.problem_type != other.problem_type) continue;
      // Where both branches have one orbit, that it is its own mirror image says nothing of the others.
      if (orbit_distance(*a, *b) <= clearly_different) continue;
      const auto flags = reflection(*a, *b, same_orbit);
      if (!flags) continue;
      MirroredBranch mirror{known.branch, {}};
      for (std::size_t k = 0; k < flags->size(); ++k)
        if ((*flags)[k]) mirror.states.push_back(system_.state_name(static_cast<int>(k) + 1));
      return mirror;
    }
  }
  return std::nullopt;
}

/// The nearest label of each place that has no label itself, each once.
std::vector<BranchRecognition::KnownStart> BranchRecognition::starts_near(const OwnOrbit& own,
                                                                          const std::string& branch) const {
  std::vector<KnownStart> starts;
  for (const BranchPlace& place : catalogue_.places_near(branch, *own.section, own.row)) {
    const CataloguedSection& known = *place.section;
    const auto is_labelled = [&](Index row) {
      const auto at = static_cast<std::size_t>(row);
      return known.labels[at] > 0 && is_at(known.parameter[at], own.parameter(), known);
    };
    const Index from = nearest_labelled(known, place.point);
    if (from < 0 || is_labelled(place.point) || is_labelled(place.point + 1)) continue;
    const int label = known.labels[static_cast<std::size_t>(from)];
    auto start = std::find_if(starts.begin(), starts.end(), [&](const KnownStart& one) { return one.label == label; });
    if (start == starts.end()) start = starts.insert(start, KnownStart{&known, label, 0});
    start->points = std::max(start->points, std::abs(from - place.point));
  }
  return starts;
}

/// Both ways from the label, so far that the value is passed.
BranchRecognition::Verdict BranchRecognition::compare_with_run(const OwnOrbit& own, const KnownStart& start) const {
  const CommandJob job = commands_.correction({own.section->branch, own.solution.label, start.section->branch,
                                               start.label, own.parameter(), 2 * static_cast<int>(start.points) + 40});
  const JobResult result = runner_.run({job}).front();
  if (!result.was_run) return Verdict::interrupted;
  if (!result.succeeded()) return Verdict::unknown;
  Verdict verdict = Verdict::unknown;
  for (const LabelledSolution& other : read_solution_file(commands_.file('q', job.name)).solutions) {
    const double parameter = stored_parameter(other, own.solution.free_parameters.front());
    if (!is_at(parameter, own.parameter(), *start.section)) continue;
    if (is_same(own, *start.section, other)) return Verdict::same;
    verdict = Verdict::different;
  }
  return verdict;
}

namespace {

void count_kinds(const Sweep& sweep, ExploredDiagram& diagram) {
  for (const auto& [kind, count] : sweep.samples.kinds())
    if (kind == AttractorKind::periodic)
      diagram.periodic += count;
    else if (kind == AttractorKind::rest)
      diagram.at_rest += count;
    else
      diagram.others[kind == AttractorKind::none ? "without attractor" : to_string(kind)] += count;
}

}  // namespace

bool is_followed(const SweepAttractor& attractor) {
  return attractor.kind == AttractorKind::periodic || attractor.kind == AttractorKind::rest;
}

std::vector<std::string> branches_of(const HybridSystem& system, const OrbitCatalogue& catalogue, const Sweep& sweep,
                                     const SweptAttractor& sample) {
  if (sample.attractor->kind == AttractorKind::rest) {
    const auto state = sweep.samples.numbers_of(sample);
    const std::string branch = state ? catalogue.branch_with_state(sample.value, *state, sweep.samples.size()) : "";
    return branch.empty() ? std::vector<std::string>{} : std::vector<std::string>{branch};
  }
  const Signature word = sweep.is_cut ? Signature{{1, 0, 0}} : signature_of(*sample.attractor);
  return catalogue.branches_with(common_word(system, word), sample.value, sample.period,
                                 sweep.samples.values_of(sample, sweep.monitors));
}

void measure_coverage(const HybridSystem& system, const Sweep& sweep, const OrbitCatalogue& catalogue,
                      const ExplorationCommands& commands, ExploredDiagram& diagram) {
  count_kinds(sweep, diagram);
  std::map<int, UnexplainedAttractor> missing;
  sweep.samples.for_each([&](const SweptAttractor& sample) {
    const SweepAttractor& known = *sample.attractor;
    const std::size_t branches = is_followed(known) ? branches_of(system, catalogue, sweep, sample).size() : 0;
    if (branches > 1) ++diagram.on_several;
    if (branches > 0) {
      ++diagram.on_branches;
      return;
    }
    UnexplainedAttractor& one = missing[known.number];
    if (one.count++ == 0) {
      const Command words = sweep.samples.words_of(sample);
      one.attractor = fmt::format("{}{}", sweep.letter, known.number);
      one.kind = to_string(known.kind);
      one.first = sample.value;
      one.command = words.empty() ? Command{} : commands.show(sample.value, words);
    }
    one.segments = known.kind == AttractorKind::periodic ? static_cast<int>(signature_of(known).size()) : 0;
    one.last = sample.value;
  });
  for (auto& [number, one] : missing) diagram.unexplained.push_back(std::move(one));
}

}  // namespace tchat
