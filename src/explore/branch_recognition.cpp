#include "explore/branch_recognition.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "files/dat_file.hpp"
#include "files/solution_file_reader.hpp"
#include "model/parameter_vector.hpp"
#include "motion/simulation_run.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double same_parameter = 1e-9;  // relative to 1 + |p|
/// 100 times the tolerance of Newton's method for states, EPSU = 1e-7: meshes add to what that leaves.
constexpr double same_orbit = 1e-5;

bool is_at(double parameter, double value) {
  return std::abs(parameter - value) <= same_parameter * (1.0 + std::abs(value));
}

/// States that nothing depends on, looked for at the orbit's own states.
std::vector<Index> drifting_states(const HybridSystem& system, const LabelledSolution& orbit) {
  ParameterVector par = initial_parameters(system);
  for (Index k = 0; k < std::min<Index>(system.parameters(), std::ssize(orbit.parameters)); ++k)
    par(k) = orbit.parameters[static_cast<std::size_t>(k)];
  std::vector<VectorXd> points;
  for (const Index column : {Index(0), orbit.states.cols() / 2, orbit.states.cols() - 1})
    points.push_back(orbit.states.col(column).head(orbit.dimension));
  const std::vector<bool> flags = ignorable_states(system, points, par);
  std::vector<Index> states;
  for (std::size_t k = 0; k < flags.size(); ++k)
    if (flags[k]) states.push_back(static_cast<Index>(k));
  return states;
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
  for (Index row = std::ssize(section.labels) - 1; row >= 0; --row)
    for (const LabelledSolution& solution : file.solutions)
      if (solution.label == section.labels[static_cast<std::size_t>(row)] && is_regular(solution))
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
  return orbit_distance({&own.solution, own.section->own_signature}, {&other, known.own_signature},
                        drifting_states(system_, own.solution)) <= same_orbit;
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
    if (known.branch != branch || known.rests != own.section->rests ||
        known.signature.word != own.section->signature.word)
      continue;
    for (std::size_t row = 0; row < known.parameter.size(); ++row) {
      if (known.labels[row] == 0 || !is_at(known.parameter[row], own.parameter())) continue;
      if (is_same(own, known, read_label_of(commands_.file('q', branch), known.labels[row]))) return Verdict::same;
      verdict = Verdict::different;
    }
  }
  return verdict;
}

/// The nearest label of each place that has no label itself, each once.
std::vector<BranchRecognition::KnownStart> BranchRecognition::starts_near(const OwnOrbit& own,
                                                                          const std::string& branch) const {
  std::vector<KnownStart> starts;
  for (const BranchPlace& place : catalogue_.places_near(branch, *own.section, own.row)) {
    const CataloguedSection& known = *place.section;
    const auto is_labelled = [&](Index row) {
      const auto at = static_cast<std::size_t>(row);
      return known.labels[at] > 0 && is_at(known.parameter[at], own.parameter());
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
  if (!result.succeeded) return Verdict::unknown;
  Verdict verdict = Verdict::unknown;
  for (const LabelledSolution& other : read_solution_file(commands_.file('q', job.name)).solutions) {
    if (!is_at(stored_parameter(other, own.solution.free_parameters.front()), own.parameter())) continue;
    if (is_same(own, *start.section, other)) return Verdict::same;
    verdict = Verdict::different;
  }
  return verdict;
}

}  // namespace tchat
