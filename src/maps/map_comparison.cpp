#include "maps/map_comparison.hpp"

#include <cmath>
#include <limits>

#include "linear/dense_matrix.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A deviation on the section with this penetration: along `direction`, whose h_D falls by 1.
VectorXd start_at(const DiscontinuityMap& map, const VectorXd& direction, double penetration) {
  double length = penetration;
  VectorXd d;
  for (int iteration = 0; iteration < 20; ++iteration) {
    d = map.onto_section(length * direction);
    const double factor = penetration / map.penetration_of_deviation(d);
    if (!(factor > 0.0) || !std::isfinite(factor)) return VectorXd::Constant(direction.size(), nan);
    if (std::abs(factor - 1.0) < 1e-3) break;  // which penetration it is does not matter, only that it is known
    length *= factor;
  }
  return d;
}

ComparedPenetration compared(const DiscontinuityMap& map, const VectorXd& direction, double penetration) {
  ComparedPenetration row{penetration, nan, {nan, nan, nan}};
  const VectorXd d = start_at(map, direction, penetration);
  if (!d.allFinite()) return row;
  row.penetration = map.penetration_of_deviation(d);
  const double y = std::sqrt(row.penetration);
  const VectorXd exact = map.smooth_deviation(d, y);
  row.change = exact.norm();
  for (std::size_t k = 0; k < expanded_orders.size(); ++k)
    row.errors[k] = (exact - map.expanded_deviation(d, y, expanded_orders[k])).norm();
  return row;
}

/// What rounding makes of an error: of the deviations, and of the coefficients of y^2.
double noise(const DiscontinuityMap& map, const ComparedPenetration& row) {
  constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  return rounding * row.change + map.expansion().error * row.penetration;
}

std::optional<ErrorOrder> fitted(const DiscontinuityMap& map, const std::vector<ComparedPenetration>& rows,
                                 std::size_t k) {
  constexpr double clear = 30.0;  // times the noise
  constexpr std::size_t points = 5;
  std::vector<const ComparedPenetration*> usable;
  for (const ComparedPenetration& row : rows)
    if (row.errors[k] > clear * noise(map, row)) usable.push_back(&row);
  if (usable.size() > points) usable.erase(usable.begin(), usable.end() - points);
  if (usable.size() < 2) return std::nullopt;
  double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0;
  const auto count = static_cast<double>(usable.size());
  for (const ComparedPenetration* row : usable) {
    mean_x += 0.5 * std::log(row->penetration) / count;
    mean_y += std::log(row->errors[k]) / count;
  }
  for (const ComparedPenetration* row : usable) {
    const double x = 0.5 * std::log(row->penetration) - mean_x;
    xx += x * x;
    xy += x * (std::log(row->errors[k]) - mean_y);
  }
  return ErrorOrder{xy / xx, usable.front()->penetration, usable.back()->penetration};
}

}  // namespace

MapComparison compare_with_expansion(const DiscontinuityMap& map, double largest, int decades) {
  MatrixXd rows(2, map.point().x.size());
  rows.row(0) = map.point().event_gradient.transpose();
  rows.row(1) = map.section_gradient().transpose();
  const VectorXd direction = least_squares(rows, Eigen::Vector2d(-1.0, 0.0));
  MapComparison result;
  double penetration = largest;
  for (int k = 0; k <= decades; ++k, penetration *= 0.1) result.rows.push_back(compared(map, direction, penetration));
  for (std::size_t k = 0; k < result.orders.size(); ++k) result.orders[k] = fitted(map, result.rows, k);
  return result;
}

}  // namespace tchat
