#include "files/solution_identifier.hpp"

#include <fmt/format.h>

#include "base/user_error.hpp"

namespace tchat {

namespace {

/// Throws when a condition on the line at `place` does not hold.
struct Requirement {
  const std::string& place;
  void operator()(bool condition, const std::string& found) const {
    if (!condition)
      throw UserError(
          fmt::format("{}: {}; the first line of this solution is damaged: restore the file", place, found));
  }
};

/// The states are a whole number of segments, and PAR has room for their durations.
void check_segments(const SolutionIdentifier& id, const Requirement& need) {
  need(id.dimension() >= 1 && id.states() % id.dimension() == 0,
       fmt::format("{} states (integer 8 less 1) are not a whole number of segments of dimension {} (integer 14)",
                   id.states(), id.dimension()));
  const std::int64_t segments = id.states() / id.dimension();
  need(segments <= max_segments,
       fmt::format("{} segments (integer 8 less 1, over integer 14), at most {} allowed", segments, max_segments));
  need(id.values[15] >= 0 && id.values[15] <= most_parameters,
       fmt::format("{} parameters of the problem (integer 16), 0 to {} allowed", id.values[15], most_parameters));
  const int first = id.layout().first_duration();
  need(id.parameters() - id.internal_parameters() >= first - 1 + segments,
       fmt::format("NPAR = {} parameters (integer 12) have no room for the durations PAR({}..{})", id.parameters(),
                   first, first - 1 + segments));
}

}  // namespace

std::int64_t SolutionIdentifier::numbers(bool direction) const {
  const std::int64_t plain = time_points() * numbers_per_point() + parameters();
  return direction ? plain + 2 * free_parameters() + time_points() * states() : plain;
}

std::int64_t SolutionIdentifier::standard_lines(bool direction) const {
  const std::int64_t plain = (states() / 7 + 1) * time_points() + (parameters() + 6) / 7;
  if (!direction) return plain;
  return plain + (free_parameters() + 19) / 20 + (free_parameters() + 6) / 7 + (states() + 6) / 7 * time_points();
}

void check_numbering(const SolutionIdentifier& id, const std::string& place) {
  constexpr int largest = 999'999'999;
  const Requirement need{place};
  need(id.branch() <= largest, fmt::format("branch {} (integer 1) is greater than {}", id.values[0], largest));
  need(id.label() >= 0, fmt::format("label {} (integer 4) is negative", id.label()));
  need(id.label() <= largest, fmt::format("label {} (integer 4) is greater than {}", id.label(), largest));
}

void check_counts(const SolutionIdentifier& id, const std::string& place) {
  const Requirement need{place};
  need(id.free_parameters() >= 0, fmt::format("NFPR = {} free parameters (integer 5)", id.free_parameters()));
  need(id.time_points() >= 1, fmt::format("NTPL = {} time points (integer 7), at least 1 expected", id.time_points()));
  need(id.numbers_per_point() >= 2, fmt::format("NAR = {} numbers per time point (integer 8), t and at least one state "
                                                "expected",
                                                id.numbers_per_point()));
  need(id.lines() >= 1, fmt::format("NROWPR = {} lines (integer 9), at least 1 expected", id.lines()));
  need(id.mesh_intervals() >= 0 && id.collocation_points() >= 0,
       fmt::format("NTST = {} or NCOL = {} (integers 10 and 11) is negative", id.mesh_intervals(),
                   id.collocation_points()));
  const std::int64_t nodes = id.mesh_intervals() * id.collocation_points() + 1;
  need(id.time_points() == nodes,
       fmt::format("NTPL = {} time points (integer 7), but NTST NCOL + 1 = {}", id.time_points(), nodes));
  need(id.parameters() >= 0, fmt::format("NPAR = {} parameters (integer 12)", id.parameters()));
  need(id.internal_parameters() >= 0 && id.internal_parameters() <= id.parameters(),
       fmt::format("NPARI = {} internal values (integer 13) of NPAR = {} parameters", id.internal_parameters(),
                   id.parameters()));
  need(id.dimension() >= 0, fmt::format("NDIM = {} (integer 14)", id.dimension()));
  if (id.is_ours()) check_segments(id, need);
}

void check_line_count(const SolutionIdentifier& id, const std::string& place) {
  const Requirement need{place};
  need(
      id.lines() == id.standard_lines(false) || id.lines() == id.standard_lines(true),
      fmt::format("NROWPR = {} lines (integer 9) are announced, the file has fewer, and the other counts make it {} or "
                  "{} lines",
                  id.lines(), id.standard_lines(false), id.standard_lines(true)));
}

}  // namespace tchat
