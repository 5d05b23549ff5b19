#include "simulate/attractor_numbering.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "base/levels.hpp"
#include "motion/orbit_identity.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinite_distance = std::numeric_limits<double>::infinity();
constexpr double same_orbit = 1e-3;        // in sizes of differences; recognition leaves 1e-6 / (1 - multiplier)
constexpr double same_rest = level::same;  // in sizes that the motion had
constexpr double same_cloud = 0.25;        // means of some hundred points of motions that do not repeat themselves
constexpr double to_neighbour = 0.1;       // from one value of a parameter to the next
constexpr double to_next_of_branch = 1.0;  // where a branch joins them
constexpr double bend = 0.5;               // of a branch: second difference of its states, as a share of the first
constexpr std::size_t most_compared = 1000;

bool repeats(const AttractorSample& sample) { return repeats(sample.kind); }

ComparedOrbit cuts_of(const AttractorSample& sample) {
  return {sample.compared_signature(), sample.identity, sample.sizes, {}, {}, sample.period};
}

VectorXd sizes_of(const AttractorSample& a, const AttractorSample& b) {
  return a.sizes.cwiseMax(b.sizes).cwiseMax(std::numeric_limits<double>::min());
}

/// The largest difference, in sizes.
double largest_in(const VectorXd& sizes, const MatrixXd& differences) {
  return (differences.array().colwise() / sizes.array()).abs().maxCoeff();
}

/// Of two turns of one orbit a sweep sees one.
double distance_of_orbits(const AttractorSample& a, const AttractorSample& b) {
  return a.compared_signature() == b.compared_signature() ? compare_cuts(cuts_of(a), cuts_of(b)).distance
                                                          : infinite_distance;
}

/// States of b turned so that they belong to those of a: a signature may repeat itself within a period. Empty when the
/// signatures differ.
MatrixXd aligned(const AttractorSample& a, const AttractorSample& b) {
  if (a.compared_signature() != b.compared_signature()) return {};
  const CutComparison comparison = compare_cuts(cuts_of(a), cuts_of(b));
  if (!std::isfinite(comparison.distance)) return {};
  MatrixXd states(b.identity.rows(), b.identity.cols());
  for (Eigen::Index s = 0; s < states.cols(); ++s)
    states.col(s) = b.identity.col((s + comparison.shift) % states.cols());
  return states;
}

/// Do three orbits at neighbouring values lie on one smooth branch, as far as they are apart?
bool lie_on_branch(const AttractorSample& a, const AttractorSample& b, const AttractorSample& c) {
  const MatrixXd before = aligned(b, a), after = aligned(b, c);
  if (before.size() == 0 || after.size() == 0) return false;
  const auto size = [&](const MatrixXd& d) { return largest_in(sizes_of(a, c), d); };
  const double first = std::min(size(b.identity - before), size(after - b.identity));
  return size(before - 2.0 * b.identity + after) <= bend * first;
}

double cloud_distance(const AttractorSample& a, const AttractorSample& b) {
  if (a.identity.cols() == 0 || b.identity.cols() == 0) return infinite_distance;
  return largest_in(sizes_of(a, b), a.identity.rowwise().mean() - b.identity.rowwise().mean());
}

double rest_distance(const AttractorSample& a, const AttractorSample& b) {
  if (a.identity.cols() != 1 || b.identity.cols() != 1) return infinite_distance;
  return largest_in(sizes_of(a, b), a.identity - b.identity);
}

std::string mode_text(const std::vector<IndexVector>& watched) {
  std::string text;
  for (const IndexVector& v : watched)
    text += fmt::format("{}{},{},{}", text.empty() ? "" : ";", v.field, v.event, v.jump);
  return text;
}

/// Gives numbers; keeps the table of the heading.
class Numberer {
 public:
  Numberer(const std::vector<SampleRecord>& records, const std::vector<AttractorSample>& known)
      : records_(records), known_(known) {
    numbers_.of_record.assign(records.size(), 0);
    numbers_.left_after.assign(records.size(), 0);
  }

  const AttractorSample& sample(std::size_t r) const {
    const AttractorSample& own = records_[r].sample;
    return own.known > 0 ? known_[static_cast<std::size_t>(own.known) - 1] : own;
  }

  /// Among records of one parameter value: chaotic motions seen for no longer than others have taken to settle.
  void withhold_transients(const std::vector<std::size_t>& records) {
    constexpr double share = 0.5;
    long longest = 0;
    for (const std::size_t r : records)
      if (sample(r).kind != AttractorKind::chaotic && is_attractor(sample(r).kind))
        longest = std::max(longest, records_[r].sample.events);
    for (const std::size_t r : records)
      if (sample(r).kind == AttractorKind::chaotic &&
          static_cast<double>(longest) >= share * static_cast<double>(records_[r].sample.events))
        numbers_.left_after[r] = longest;
  }

  /// Has the record an attractor of its own?
  bool counts(std::size_t r) const { return is_attractor(sample(r).kind) && numbers_.left_after[r] == 0; }

  int new_number(std::size_t r) {
    const AttractorSample& from = sample(r);
    SweepAttractor attractor;
    attractor.number = static_cast<int>(numbers_.attractors.size()) + 1;
    attractor.kind = from.kind;
    if (repeats(from)) attractor.signature = to_string(from.signature);
    attractor.impacts = from.impacts;
    attractor.period = from.period;
    attractor.index = records_[r].index;
    attractor.mode = mode_text(from.last.watched);
    attractor.state = from.last.x;
    numbers_.attractors.push_back(std::move(attractor));
    return numbers_.attractors.back().number;
  }

  /// Records of one parameter value: the attractors there that differ, each with its records.
  struct Group {
    std::size_t first = 0;
    std::vector<std::size_t> records;
    int number = 0;
  };
  std::vector<Group> groups(const std::vector<std::size_t>& records) const {
    std::vector<Group> groups;
    std::map<int, std::size_t> of_known;
    for (const std::size_t r : records) {
      if (!counts(r)) continue;
      const int known = records_[r].sample.known;
      std::size_t g = groups.size();
      if (const auto at = of_known.find(known); known > 0 && at != of_known.end()) {
        g = at->second;
      } else {
        for (std::size_t k = groups.size() - std::min(groups.size(), most_compared); k < groups.size(); ++k)
          if (is_same_attractor(sample(groups[k].first), sample(r))) {
            g = k;
            break;
          }
        if (known > 0) of_known[known] = g;
      }
      if (g == groups.size()) groups.push_back({r, {}, 0});
      groups[g].records.push_back(r);
    }
    return groups;
  }

  /// Numbers of the neighbours' attractors, nearest pairs first; new ones for the rest. `groups` are of all values in
  /// order, those of value k get their numbers.
  void go_on(std::vector<std::vector<Group>>& all, std::size_t k) {
    const std::vector<Group> none;
    std::vector<Group>& groups = all[k];
    const std::vector<Group>& before = k > 0 ? all[k - 1] : none;
    const std::vector<Group>& before_that = k > 1 ? all[k - 2] : none;
    const std::vector<Group>& behind = k + 1 < all.size() ? all[k + 1] : none;
    const auto is_joined = [&](const Group& from, const Group& to) {
      const AttractorSample &a = sample(from.first), &b = sample(to.first);
      return std::any_of(before_that.begin(), before_that.end(),
                         [&](const Group& earlier) {
                           return earlier.number == from.number && lie_on_branch(sample(earlier.first), a, b);
                         }) ||
             std::any_of(behind.begin(), behind.end(),
                         [&](const Group& later) { return lie_on_branch(a, b, sample(later.first)); });
    };
    std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (std::size_t b = 0; b < before.size(); ++b) {
        const AttractorSample& there = sample(before[b].first);
        const double d = attractor_distance(there, sample(groups[g].first));
        const bool is_near = d <= (repeats(there) ? to_neighbour : same_cloud);
        if (is_near || (repeats(there) && d <= to_next_of_branch && is_joined(before[b], groups[g])))
          pairs.emplace_back(d, g, b);
      }
    std::sort(pairs.begin(), pairs.end());
    std::vector<bool> taken(before.size(), false);
    for (const auto& [d, g, b] : pairs) {
      if (groups[g].number > 0 || taken[b]) continue;
      groups[g].number = before[b].number;
      taken[b] = true;
    }
    for (Group& group : groups) {
      if (group.number == 0) group.number = new_number(group.first);
      for (const std::size_t r : group.records) numbers_.of_record[r] = group.number;
    }
  }

  void by_signature() {
    std::map<std::pair<AttractorKind, Signature>, int> numbers;
    for (std::size_t r = 0; r < records_.size(); ++r) {
      const AttractorSample& at = sample(r);
      if (!counts(r)) continue;
      int& number = numbers[{at.kind, at.compared_signature()}];
      if (number == 0) number = new_number(r);
      numbers_.of_record[r] = number;
    }
  }

  AttractorNumbers take() { return std::move(numbers_); }

 private:
  const std::vector<SampleRecord>& records_;
  const std::vector<AttractorSample>& known_;
  AttractorNumbers numbers_;
};

/// The record's position along the one swept parameter; 0 when only initial states are swept.
std::size_t parameter_position(const SweepGrid& grid, std::size_t index) {
  std::size_t rest = index;
  for (const SweptQuantity& quantity : grid.over()) {
    const auto count = static_cast<std::size_t>(quantity.count);
    if (!quantity.is_state) return rest % count;
    rest /= count;
  }
  return 0;
}

}  // namespace

bool is_attractor(AttractorKind kind) {
  return kind == AttractorKind::periodic || kind == AttractorKind::quasi_periodic || kind == AttractorKind::chaotic ||
         kind == AttractorKind::rest;
}

double attractor_distance(const AttractorSample& a, const AttractorSample& b) {
  if (a.kind != b.kind) return infinite_distance;
  if (repeats(a)) return distance_of_orbits(a, b);
  if (a.kind == AttractorKind::rest) return rest_distance(a, b);
  return cloud_distance(a, b);
}

bool is_same_attractor(const AttractorSample& a, const AttractorSample& b) {
  const double most = repeats(a) ? same_orbit : a.kind == AttractorKind::rest ? same_rest : same_cloud;
  return attractor_distance(a, b) <= most;
}

std::vector<AttractorSample> distinct_attractors(const std::vector<SampleRecord>& records) {
  std::vector<AttractorSample> distinct;
  for (const SampleRecord& record : records) {
    const bool is_new = std::none_of(distinct.begin(), distinct.end(), [&](const AttractorSample& other) {
      return is_same_attractor(other, record.sample);
    });
    if (is_attractor(record.sample.kind) && is_new) distinct.push_back(record.sample);
  }
  return distinct;
}

AttractorNumbers number_attractors(const std::vector<SampleRecord>& records, const std::vector<AttractorSample>& known,
                                   const SweepGrid& grid) {
  Numberer numberer(records, known);
  const auto parameters = std::count_if(grid.over().begin(), grid.over().end(),
                                        [](const SweptQuantity& quantity) { return !quantity.is_state; });
  if (parameters == 2) {
    numberer.by_signature();
    return numberer.take();
  }
  std::map<std::size_t, std::vector<std::size_t>> values;
  for (std::size_t r = 0; r < records.size(); ++r) values[parameter_position(grid, records[r].index)].push_back(r);
  std::vector<std::vector<Numberer::Group>> groups;
  for (const auto& [position, at] : values) {
    numberer.withhold_transients(at);
    groups.push_back(numberer.groups(at));
  }
  for (std::size_t k = 0; k < groups.size(); ++k) numberer.go_on(groups, k);
  return numberer.take();
}

}  // namespace tchat
