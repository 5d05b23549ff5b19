#include "kinds/verify_between.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/messages.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
constexpr double no_distance = std::numeric_limits<double>::infinity();

double distance_from(const std::vector<Complex>& multipliers, double target) {
  double nearest = no_distance;
  for (const Complex& mu : multipliers) nearest = std::min(nearest, std::abs(mu - target));
  return nearest;
}

/// Of the products of two multipliers from 1.
double distance_of_pairs(const std::vector<Complex>& multipliers) {
  double nearest = no_distance;
  for (std::size_t i = 0; i < multipliers.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, std::abs(multipliers[i] * multipliers[j] - 1.0));
  return nearest;
}

/// Without one along the flow, which is 1 whatever the orbit is.
std::vector<Complex> without_trivial(std::vector<Complex> multipliers) {
  const auto nearest = std::min_element(multipliers.begin(), multipliers.end(), [](const Complex& a, const Complex& b) {
    return std::abs(a - 1.0) < std::abs(b - 1.0);
  });
  if (nearest != multipliers.end()) multipliers.erase(nearest);
  return multipliers;
}

/// Of the multiplier that points of a curve have.
double distance_on_curve(int curve, const std::vector<Complex>& multipliers) {
  switch (static_cast<PointType>(curve)) {
    case PointType::period_doubling:
      return distance_from(multipliers, -1.0);
    case PointType::torus:
      return distance_of_pairs(multipliers);
    default:
      return distance_from(multipliers, 1.0);
  }
}

bool has_critical_multiplier(int curve) {
  const auto type = static_cast<PointType>(curve);
  return type == PointType::fold || type == PointType::branch_point || type == PointType::period_doubling ||
         type == PointType::torus;
}

std::map<int, int> curves_of_branches(const std::vector<LabelledSolution>& solutions) {
  std::map<int, int> curves;
  for (const LabelledSolution& solution : solutions)
    if (const int curve = curve_type(solution.type);
        !keeps_contact(solution.problem_type) && has_critical_multiplier(curve))
      curves[solution.branch] = curve;
  return curves;
}

/// "87 to 97, 101", some of them.
std::string ranges(const std::vector<int>& numbers) {
  constexpr std::size_t most = 6;
  std::vector<std::string> words;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    words.push_back(end == i + 1 ? std::to_string(numbers[i]) : fmt::format("{} to {}", numbers[i], numbers[end - 1]));
    i = end;
  }
  if (words.size() > most) {
    words.resize(most);
    words.emplace_back("...");
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

PointsBetween look_between_labels(const std::vector<DiagnosticPoint>& points,
                                  const std::vector<LabelledSolution>& solutions, bool has_trivial, double tolerance) {
  const std::map<int, int> curves = curves_of_branches(solutions);
  PointsBetween between;
  for (const DiagnosticPoint& point : points) {
    between.lost.insert(between.lost.end(), point.lost.begin(), point.lost.end());
    if (point.label > 0) continue;
    ++between.points;
    between.inadmissible += point.admissible ? 0 : 1;
    const auto curve = curves.find(point.branch);
    if (curve == curves.end() || point.multipliers.empty()) continue;
    ++between.on_curves;
    const double distance =
        distance_on_curve(curve->second, has_trivial ? without_trivial(point.multipliers) : point.multipliers);
    if (distance > std::sqrt(tolerance)) between.strange.push_back(std::abs(point.point));
    if (distance > between.largest || between.where == 0) {
      between.largest = distance;
      between.where = std::abs(point.point);
    }
  }
  return between;
}

std::string describe(const PointsBetween& between, double tolerance) {
  if (between.on_curves == 0 && between.inadmissible == 0 && between.lost.empty()) return {};
  std::string text = fmt::format("Between the labels: {} point{}", between.points, between.points == 1 ? "" : "s");
  if (between.inadmissible > 0) text += fmt::format(", {} inadmissible", between.inadmissible);
  if (!between.strange.empty())
    text += fmt::format(", {} without the multiplier of the curve to {:.1e} (point {}; {:.1e} at point {})",
                        between.strange.size(), std::sqrt(tolerance), ranges(between.strange), between.largest,
                        between.where);
  else if (between.on_curves > 0)
    text += fmt::format(", the multiplier of the curve at {} of them to {:.1e}", between.on_curves, between.largest);
  for (const RecordedLoss& loss : between.lost)
    text += fmt::format("; from {:.8g} to {:.8g} {}", loss.from, loss.to, loss.text);
  return folded(text + ".");
}

}  // namespace tchat
