#include "explore/branch_recognition.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "files/solution_file_reader.hpp"
#include "hybrid/parameter_vector.hpp"
#include "setup/parameter_values.hpp"
#include "simulation/recurrence.hpp"

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

/// Where no other branch passes: at a bifurcation the branches that meet have one orbit.
Index last_regular_label(const CataloguedSection& section) {
  for (Index row = std::ssize(section.labels) - 1; row >= 0; --row) {
    const auto at = static_cast<std::size_t>(row);
    if (section.labels[at] > 0 && !section.bifurcates[at]) return row;
  }
  return -1;
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

std::optional<std::string> BranchRecognition::branch_of(const CataloguedSection& section) const {
  const std::string by_numbers = catalogue_.branch_of(section);
  const Point own{&section, last_regular_label(section)};
  if (own.row < 0) return by_numbers;
  const std::vector<std::string> near = catalogue_.branches_near(section);
  if (near.empty()) return by_numbers;
  const LabelledSolution orbit =
      read_label_of(commands_.file('q', section.branch), section.labels[static_cast<std::size_t>(own.row)]);
  bool is_refuted = false;
  for (const std::string& branch : near) {
    const Verdict verdict = compare(own, orbit, branch);
    if (verdict == Verdict::interrupted) return std::nullopt;
    if (verdict == Verdict::same) return branch;
    is_refuted = is_refuted || (verdict == Verdict::different && branch == by_numbers);
  }
  return is_refuted ? "" : by_numbers;
}

bool BranchRecognition::is_same(const Point& own, const LabelledSolution& orbit, const CataloguedSection& known,
                                const LabelledSolution& other) const {
  return orbit_distance({&orbit, own.section->own_signature}, {&other, known.own_signature},
                        drifting_states(system_, orbit)) <= same_orbit;
}

BranchRecognition::Verdict BranchRecognition::compare(const Point& own, const LabelledSolution& orbit,
                                                      const std::string& branch) const {
  const Verdict by_labels = compare_with_labels(own, orbit, branch);
  if (by_labels == Verdict::same) return by_labels;
  Verdict verdict = by_labels;
  for (const BranchPlace& place : catalogue_.places_near(branch, *own.section, own.row)) {
    const auto is_labelled = [&](Index row) {
      const auto at = static_cast<std::size_t>(row);
      return place.section->labels[at] > 0 &&
             is_at(place.section->parameter[at], own.section->parameter[static_cast<std::size_t>(own.row)]);
    };
    if (is_labelled(place.point) || is_labelled(place.point + 1)) continue;
    verdict = compare_with_run(own, orbit, place);
    if (verdict != Verdict::different) return verdict;
  }
  return verdict;
}

/// Unknown where no label is at this value.
BranchRecognition::Verdict BranchRecognition::compare_with_labels(const Point& own, const LabelledSolution& orbit,
                                                                  const std::string& branch) const {
  Verdict verdict = Verdict::unknown;
  const double value = own.section->parameter[static_cast<std::size_t>(own.row)];
  for (const CataloguedSection& known : catalogue_.sections()) {
    if (known.branch != branch || known.rests != own.section->rests ||
        known.signature.word != own.section->signature.word)
      continue;
    for (std::size_t row = 0; row < known.parameter.size(); ++row) {
      if (known.labels[row] == 0 || !is_at(known.parameter[row], value)) continue;
      if (is_same(own, orbit, known, read_label_of(commands_.file('q', branch), known.labels[row])))
        return Verdict::same;
      verdict = Verdict::different;
    }
  }
  return verdict;
}

/// Both ways from the nearest label, so far that the value is passed.
BranchRecognition::Verdict BranchRecognition::compare_with_run(const Point& own, const LabelledSolution& orbit,
                                                               const BranchPlace& place) const {
  const CataloguedSection& known = *place.section;
  const Index from = nearest_labelled(known, place.point);
  if (from < 0) return Verdict::unknown;
  const double value = own.section->parameter[static_cast<std::size_t>(own.row)];
  const int label = known.labels[static_cast<std::size_t>(from)];
  const CommandJob job = commands_.correction(own.section->branch, known.branch, label, value,
                                              2 * std::abs(static_cast<int>(from - place.point)) + 40);
  const JobResult result = runner_.run({job}).front();
  if (!result.was_run) return Verdict::interrupted;
  if (!result.succeeded) return Verdict::unknown;
  Verdict verdict = Verdict::unknown;
  for (const LabelledSolution& other : read_solution_file(commands_.file('q', job.name)).solutions) {
    if (!is_at(stored_parameter(other, orbit.free_parameters.front()), value)) continue;
    if (is_same(own, orbit, known, other)) return Verdict::same;
    verdict = Verdict::different;
  }
  return verdict;
}

}  // namespace tchat
