#include "files/orbit_parts.hpp"

#include <algorithm>

namespace tchat {

namespace {

/// Times nearer to each other than this share of a segment are one.
constexpr double same_time = 1e-12;

double relative_time(const OrbitPart& part, std::size_t row) {
  return (part.times[row] - part.times.front()) / part.duration();
}

std::vector<double> relative_times(const std::vector<OrbitPart>& parts) {
  std::vector<double> all{0.0, 1.0};
  for (const OrbitPart& part : parts)
    for (std::size_t k = 0; part.duration() > 0.0 && k < part.times.size(); ++k) all.push_back(relative_time(part, k));
  std::sort(all.begin(), all.end());
  const auto is_same = [](double a, double b) { return b - a <= same_time; };
  all.erase(std::unique(all.begin(), all.end(), is_same), all.end());
  all.back() = 1.0;
  return all;
}

Eigen::VectorXd state_at(const OrbitPart& part, double tau) {
  const double t = part.times.front() + tau * part.duration();
  const auto after = std::upper_bound(part.times.begin(), part.times.end(), t);
  if (after == part.times.begin()) return part.states.col(0);
  if (after == part.times.end()) return part.states.rightCols(1);
  const auto k = static_cast<Eigen::Index>(after - part.times.begin());
  const double left = part.times[static_cast<std::size_t>(k) - 1];
  const double share = (t - left) / (*after - left);
  return (1.0 - share) * part.states.col(k - 1) + share * part.states.col(k);
}

}  // namespace

OrbitPart joined(const OrbitPart& first, const OrbitPart& second) {
  OrbitPart result = first;
  const double shift = first.times.back() - second.times.front();
  for (std::size_t k = 1; k < second.times.size(); ++k) result.times.push_back(second.times[k] + shift);
  const Eigen::Index n = first.states.rows();
  result.states.conservativeResize(n, static_cast<Eigen::Index>(result.times.size()));
  result.states.rightCols(second.states.cols() - 1) = second.states.rightCols(second.states.cols() - 1);
  return result;
}

DatFile data_of_parts(const std::vector<OrbitPart>& parts) {
  const Eigen::Index n = parts.front().states.rows();
  DatFile data;
  data.tau = relative_times(parts);
  data.states.resize(n * static_cast<Eigen::Index>(parts.size()), static_cast<Eigen::Index>(data.tau.size()));
  data.span = 0.0;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    data.span += parts[s].duration();
    data.durations.push_back(parts[s].duration());
    for (std::size_t k = 0; k < data.tau.size(); ++k)
      data.states.col(static_cast<Eigen::Index>(k)).segment(n * static_cast<Eigen::Index>(s), n) =
          state_at(parts[s], data.tau[k]);
  }
  return data;
}

}  // namespace tchat
