#include "simulate/recorded_period.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace tchat {

namespace {

using Eigen::VectorXd;

/// Of each state over all segments; infinite for what is not compared.
VectorXd ranges(const std::vector<SimulatedSegment>& segments, const std::vector<Eigen::Index>& ignorable) {
  VectorXd low = segments.front().low, high = segments.front().high;
  for (const SimulatedSegment& segment : segments) {
    low = low.cwiseMin(segment.low);
    high = high.cwiseMax(segment.high);
  }
  VectorXd range = (high - low).cwiseMax(std::numeric_limits<double>::min());
  for (const Eigen::Index k : ignorable) range(k) = std::numeric_limits<double>::infinity();
  return range;
}

VectorXd sizes(const std::vector<SimulatedSegment>& segments, const std::vector<Eigen::Index>& ignorable) {
  VectorXd size = VectorXd::Constant(segments.front().low.size(), std::numeric_limits<double>::min());
  for (const SimulatedSegment& segment : segments)
    size = size.cwiseMax(segment.low.cwiseAbs()).cwiseMax(segment.high.cwiseAbs());
  for (const Eigen::Index k : ignorable) size(k) = std::numeric_limits<double>::infinity();
  return size;
}

}  // namespace

RecordedPeriod recorded_period(const std::vector<SimulatedSegment>& segments, std::optional<long> events,
                               const std::vector<Eigen::Index>& ignorable) {
  const auto whole = static_cast<std::size_t>(
      std::find_if(segments.begin(), segments.end(),
                   [](const SimulatedSegment& segment) { return segment.ended_by != SegmentEnd::event; }) -
      segments.begin());
  if (whole == 0) return {};
  const VectorXd range = ranges(segments, ignorable);
  std::size_t period = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t q = 1; q < whole; ++q) {
    if (segments[q].index != segments[0].index) continue;
    if (events && static_cast<long>(q) != *events) continue;
    const double distance = (segments[q].after - segments[0].after).cwiseQuotient(range).lpNorm<Eigen::Infinity>();
    if (!(distance < 0.5 * least)) continue;
    least = distance;
    period = q;
  }
  if (period == 0) return {};
  const auto begin = segments.begin() + 1;
  std::vector<SimulatedSegment> part(begin, begin + static_cast<std::ptrdiff_t>(period));
  VectorXd size = sizes(part, ignorable);
  return {std::move(part), std::move(size)};
}

}  // namespace tchat
