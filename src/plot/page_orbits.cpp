#include "plot/page_orbits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include "base/user_error.hpp"
#include "files/orbit_trace.hpp"
#include "files/run_file_names.hpp"
#include "files/solution_file_reader.hpp"
#include "plot/page_json.hpp"
#include "settings/family.hpp"

namespace tchat {

namespace {

constexpr int orbit_digits = 7;
constexpr std::size_t most_orbits = 400;                    // of regular points
constexpr std::size_t most_numbers = 300'000;               // of all orbits: 3 MB
constexpr std::size_t fewest_times = 16, most_times = 400;  // of one segment

std::string orbit_number(double value) { return page_number(value, orbit_digits); }

/// Where a solution is in the p-file.
struct SolutionPlace {
  std::size_t section = 0, row = 0;
};

/// By index in the list of solutions; those of no row are left out.
std::map<int, SolutionPlace> places_of(const BranchFile& file) {
  std::map<int, SolutionPlace> places;
  for (std::size_t s = 0; s < file.sections.size(); ++s)
    for (std::size_t k = 0; k < file.solution[s].size(); ++k)
      if (file.solution[s][k] >= 0) places.emplace(file.solution[s][k], SolutionPlace{s, k});
  return places;
}

/// Of these solutions all that are not regular points, and evenly chosen regular ones.
std::set<int> chosen_solutions(const BranchFile& file, const std::map<int, SolutionPlace>& places) {
  std::vector<int> regular;
  std::set<int> chosen;
  for (const auto& [index, place] : places) {
    const bool is_regular = file.types[place.section][place.row] == "RG";
    if (is_regular)
      regular.push_back(index);
    else
      chosen.insert(index);
  }
  const std::size_t stride = (regular.size() + most_orbits - 1) / most_orbits;
  for (std::size_t k = 0; k < regular.size(); k += stride) chosen.insert(regular[k]);
  return chosen;
}

/// At most so many indices from 0 to `count` - 1, both ends among them.
std::vector<Eigen::Index> thinned_indices(std::size_t count, std::size_t most) {
  const std::size_t stride = count <= most ? 1 : (count + most - 2) / (most - 1);
  std::vector<Eigen::Index> indices;
  for (std::size_t k = 0; k + 1 < count; k += stride) indices.push_back(static_cast<Eigen::Index>(k));
  indices.push_back(static_cast<Eigen::Index>(count) - 1);
  return indices;
}

std::string named(const std::map<int, std::string>& names, int k, const char* otherwise) {
  const auto found = names.find(k);
  return found != names.end() ? found->second : fmt::format("{} {}", otherwise, k);
}

class OrbitWriter {
 public:
  OrbitWriter(const PointSection& section, const OrbitTrace& trace, std::size_t most)
      : section_(section), trace_(trace), most_(most) {}

  std::string json(const LabelledSolution& solution) const {
    std::vector<std::string> segments;
    for (std::size_t s = 0; s < trace_.segments.size(); ++s) segments.push_back(segment(s));
    std::vector<std::string> contacts;
    for (const UserPointKind& kind : all_kinds(solution))
      if (is_inside(kind)) contacts.push_back(contact(kind));
    return page_object({{"label", fmt::format("{}", solution.label)},
                        {"period", page_number(trace_.period())},
                        {"closed", trace_.is_closed ? "1" : "0"},
                        {"segments", page_list(segments)},
                        {"contacts", page_list(contacts)}});
  }

 private:
  std::string segment(std::size_t s) const {
    const TraceSegment& segment = trace_.segments[s];
    const auto indices = thinned_indices(segment.times.size(), most_);
    std::vector<std::string> states;
    for (Eigen::Index i = 0; i < segment.states.rows(); ++i)
      states.push_back(page_list(indices, [&](Eigen::Index k) { return orbit_number(segment.states(i, k)); }));
    const auto time = [&](Eigen::Index k) { return orbit_number(segment.times[static_cast<std::size_t>(k)]); };
    return page_object({{"t", page_list(indices, time)},
                        {"u", page_list(states)},
                        {"event", page_text(event_after(s))},
                        {"jump", page_text(jump_after(s))},
                        {"jumps", trace_.jumps_after(s) ? "1" : "0"},
                        {"endsReturn", trace_.ends_return(s) ? "1" : "0"}});
  }

  /// What the segment ends in; "" where the file does not say, and for a phase condition.
  std::string event_after(std::size_t s) const {
    if (section_.signature.empty()) return "";
    const int event = section_.signature[s % section_.signature.size()][1];
    return event > 0 ? named(section_.events, event, "event") : "";
  }

  /// "jump impact", or "jump 2" without a name; "" where the file has no signature.
  std::string jump_after(std::size_t s) const {
    if (section_.signature.empty()) return "";
    const int jump = section_.signature[s % section_.signature.size()][2];
    if (jump <= 0) return "";
    const auto name = section_.jumps.find(jump);
    return name != section_.jumps.end() ? "jump " + name->second : fmt::format("jump {}", jump);
  }

  bool is_inside(const UserPointKind& kind) const {
    const bool is_contact = kind.kind == UserPointKind::contact || kind.kind == UserPointKind::impact_velocity;
    return is_contact && kind.segment >= 1 && static_cast<std::size_t>(kind.segment) <= trace_.segments.size();
  }

  /// The place of a grazing contact: the stored time nearest to it.
  std::string contact(const UserPointKind& kind) const {
    const TraceSegment& segment = trace_.segments[static_cast<std::size_t>(kind.segment) - 1];
    const double wanted = segment.times.front() + kind.tau * (segment.times.back() - segment.times.front());
    const auto after = std::lower_bound(segment.times.begin(), segment.times.end(), wanted);
    const auto k =
        std::min<std::ptrdiff_t>(after - segment.times.begin(), static_cast<std::ptrdiff_t>(segment.times.size()) - 1);
    std::vector<std::string> states;
    for (Eigen::Index i = 0; i < segment.states.rows(); ++i) states.push_back(orbit_number(segment.states(i, k)));
    return page_object({{"t", orbit_number(segment.times[static_cast<std::size_t>(k)])},
                        {"u", page_list(states)},
                        {"text", page_text("contact with " + named(section_.events, kind.index, "event"))}});
  }

  const PointSection& section_;
  const OrbitTrace& trace_;
  std::size_t most_;
};

std::string equilibrium_json(const LabelledSolution& solution) {
  std::vector<std::string> states;
  for (Eigen::Index i = 0; i < solution.states.rows(); ++i) states.push_back(page_number(solution.states(i, 0)));
  return page_object({{"label", fmt::format("{}", solution.label)}, {"equilibrium", page_list(states)}});
}

/// How many times of each segment are embedded when there are so many orbits.
std::size_t times_of_segment(const OrbitTrace& trace, std::size_t orbits) {
  const std::size_t share = most_numbers / std::max<std::size_t>(orbits, 1);
  const std::size_t rows = trace.segments.size() * (static_cast<std::size_t>(trace.dimension()) + 1);
  return std::clamp(share / rows, fewest_times, most_times);
}

std::string orbit_json(const LabelledSolution& solution, const PointSection& section, const std::string& path,
                       int dimension, std::size_t orbits) {
  if (solution.tau.size() < 2) return equilibrium_json(solution);
  const OrbitTrace trace = family_of(solution.problem_type).trace(solution, "", dimension, path);
  return OrbitWriter(section, trace, times_of_segment(trace, orbits)).json(solution);
}

/// Why the branch has no solutions, by its own files.
std::string why_missing(const BranchFile& file, const std::string& path) {
  std::error_code error;
  if (path.empty()) return fmt::format("no q-file belongs to the name {}", file.path);
  if (!std::filesystem::is_regular_file(path, error)) return fmt::format("{} is missing", path);
  for (const std::string& warning : file.warnings)
    if (warning.starts_with(path)) return warning;
  return fmt::format("{} holds none of the labels of {}", path, file.path);
}

}  // namespace

PageOrbits page_orbits(const BranchFile& file, int dimension) {
  PageOrbits result{"[]", {}, ""};
  const std::string path = sibling_path(file.path, 'q');
  const std::map<int, SolutionPlace> places = places_of(file);
  if (places.empty()) {
    result.missing = why_missing(file, path);
    return result;
  }
  const std::set<int> chosen = chosen_solutions(file, places);
  if (chosen.size() < places.size())
    result.missing = fmt::format("the page holds {} of the {} orbits of {}", chosen.size(), places.size(), path);
  std::vector<std::string> orbits;
  try {
    const SolutionFile solutions = read_solution_file(path);
    for (const int index : chosen) {
      const LabelledSolution& solution = solutions.solutions.at(static_cast<std::size_t>(index));
      const PointSection& section = file.sections[places.at(index).section];
      orbits.push_back(orbit_json(solution, section, path, dimension, chosen.size()));
      result.place[solution.label] = orbits.size() - 1;
    }
  } catch (const UserError& error) {
    result.missing = error.what();
  }
  result.json = page_list(orbits);
  return result;
}

}  // namespace tchat
