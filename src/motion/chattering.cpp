#include "motion/chattering.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

constexpr double shrunk = 1e-3;
constexpr std::size_t ratios = 10;  // compared with each other
constexpr double agreement = 0.1;   // of 1 - rho
constexpr int too_many_zeros = 50;

}  // namespace

void ChatteringDetector::add(const IndexVector& index, double duration) {
  segments_.push_back({index, duration});
  if (segments_.size() > most_kept) segments_.pop_front();
  zeros_ = duration > 0.0 ? 0 : zeros_ + 1;
  const std::size_t last = segments_.size() - 1;
  for (std::size_t q = 1; q <= longest_pattern; ++q) {
    const bool is_shorter = last >= q && segments_[last - q].index == index && duration < segments_[last - q].duration;
    shrinking_[q] = is_shorter ? shrinking_[q] + 1 : 0;
  }
}

std::optional<ChatteringDetector::Accumulation> ChatteringDetector::accumulation() const {
  if (zeros_ >= too_many_zeros) return Accumulation{0.0, 0.0, 1};
  for (std::size_t q = 1; q <= longest_pattern; ++q)
    if (const auto found = accumulation(q)) return found;
  return std::nullopt;
}

std::optional<ChatteringDetector::Accumulation> ChatteringDetector::accumulation(std::size_t q) const {
  if (segments_.empty()) return std::nullopt;
  const std::size_t turns = std::min(shrinking_[q], segments_.size() - 1) / q;
  if (turns < 3 || shrinking_[q] < ratios) return std::nullopt;
  const std::size_t last = segments_.size() - 1;
  if (!(segments_[last].duration < shrunk * segments_[last - q * turns].duration)) return std::nullopt;

  double sum = 0.0;
  double least = 1.0;
  double largest = 0.0;
  for (std::size_t k = last + 1 - ratios; k <= last; ++k) {
    const double ratio = segments_[k].duration / segments_[k - q].duration;
    sum += ratio;
    least = std::min(least, ratio);
    largest = std::max(largest, ratio);
  }
  const double ratio = sum / static_cast<double>(ratios);
  if (largest - least > agreement * (1.0 - ratio)) return std::nullopt;
  double turn = 0.0;
  for (std::size_t k = last + 1 - q; k <= last; ++k) turn += segments_[k].duration;
  return Accumulation{turn * ratio / (1.0 - ratio), ratio, static_cast<int>(q)};
}

}  // namespace tchat
