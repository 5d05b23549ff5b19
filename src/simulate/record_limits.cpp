#include "simulate/record_limits.hpp"

#include <fmt/format.h>

#include <vector>

#include "simulate/attractor_numbering.hpp"

namespace tchat {

namespace {

/// Keeps the first number that is out of range.
class RangeCheck {
 public:
  void number(const char* name, long value, long least, long largest) {
    if (!fault_.empty() || (value >= least && value <= largest)) return;
    fault_ = fmt::format("{} is {}; allowed are {} to {}", name, value, least, largest);
  }

  void count(const char* name, Eigen::Index value, Eigen::Index wanted, bool may_be_empty) {
    if (!fault_.empty() || value == wanted || (value == 0 && may_be_empty)) return;
    fault_ = fmt::format("{} has {} entries; needed are {}", name, value, wanted);
  }

  void index_vectors(const char* name, const std::vector<IndexVector>& vectors, const RecordLimits& limits, int least) {
    for (const IndexVector& v : vectors) {
      number(fmt::format("a field in the {}", name).c_str(), v.field, 1, limits.fields);
      number(fmt::format("an event function in the {}", name).c_str(), v.event, least, limits.events);
      number(fmt::format("a jump in the {}", name).c_str(), v.jump, least, limits.jumps);
    }
  }

  void require(bool holds, const char* fault) {
    if (fault_.empty() && !holds) fault_ = fault;
  }

  const std::string& fault() const { return fault_; }

 private:
  std::string fault_;
};

void check_states(const AttractorSample& sample, int dimension, RangeCheck& check) {
  const Eigen::Index n = dimension;
  if (sample.sections.cols() > 0) check.count("a recorded state", sample.sections.rows(), n, false);
  if (sample.largest.cols() > 0) check.count("a list of largest values", sample.largest.rows(), n, false);
  if (sample.identity.cols() > 0) check.count("a section state", sample.identity.rows(), n, false);
  check.count("the range", sample.range.size(), n, sample.identity.cols() == 0);
  check.count("the last state", sample.last.x.size(), n, true);
  check.require(!is_attractor(sample.kind) || sample.last.x.allFinite(), "the last state is not finite");
}

}  // namespace

RecordLimits RecordLimits::of(const HybridSystem& system) {
  RecordLimits limits;
  limits.dimension = system.dimension();
  limits.fields = system.count(FunctionKind::field);
  limits.events = system.count(FunctionKind::event);
  limits.jumps = system.count(FunctionKind::jump);
  return limits;
}

std::string fault_of(const SampleRecord& record, const RecordLimits& limits) {
  const AttractorSample& sample = record.sample;
  const bool is_known = record.start == start_of_known;
  const auto values = static_cast<long>(limits.values);
  RangeCheck check;
  check.number("start", record.start, start_of_known, limits.starts);
  check.number("index", static_cast<long>(record.index), is_known ? 1 : 0, is_known ? values + 1 : values - 1);
  check.number("known", sample.known, 0, is_known ? 0 : limits.known);
  check.number("impacts", sample.impacts, -1, static_cast<long>(sample.signature.size()));
  check.index_vectors("signature", sample.signature, limits, is_known ? 1 : no_function);
  check.index_vectors("watched index vectors", sample.last.watched, limits, 1);
  check_states(sample, limits.dimension, check);
  if (is_known && sample.kind == AttractorKind::periodic) {
    check.require(!sample.signature.empty(), "a periodic attractor has no signature");
    check.count("the range", sample.range.size(), limits.dimension, false);
    check.count("the last state", sample.last.x.size(), limits.dimension, false);
  }
  return check.fault();
}

}  // namespace tchat
