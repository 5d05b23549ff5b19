/// What a smooth function tends to at zero, from its values nearby; the digits that such a value has.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace tchat {

/// The limit of f(x) at x = 0 where f is smooth, by Neville's tableau: polynomials through the last points, one more
/// with each column. Of all its entries the one that agrees best with the two that it is made of, as orders grow and
/// rounding does.
class LimitAtZero {
 public:
  double best = std::numeric_limits<double>::quiet_NaN();  ///< from two points on
  double error = std::numeric_limits<double>::infinity();  ///< how well it agrees, and the rounding there

  /// f(x) = value at the next x, nearer to zero; `rounding`: what is uncertain of the value. A value that is not finite
  /// begins a new tableau.
  void add(double x, double value, double rounding) {
    if (!std::isfinite(value)) {
      last_.clear();
      return;
    }
    arguments_.push_back(x);
    std::vector<double> row{value};
    for (std::size_t k = 1; k <= last_.size(); ++k) {
      const double factor = arguments_[arguments_.size() - 1 - k] / x;
      row.push_back(row[k - 1] + (row[k - 1] - last_[k - 1]) / (factor - 1.0));
      const double change = std::max(std::abs(row[k] - row[k - 1]), std::abs(row[k] - last_[k - 1]));
      if (change + rounding < error) {
        error = change + rounding;
        best = row[k];
      }
    }
    last_ = std::move(row);
  }

 private:
  std::vector<double> arguments_, last_;
};

/// With the digits that its uncertainty leaves.
inline std::string known_digits(double value, double uncertainty) {
  const double share = uncertainty > 0.0 ? std::abs(value) / uncertainty : INFINITY;
  const double digits =
      std::isfinite(share) ? std::clamp(std::ceil(std::log10(std::max(share, 1.0))) + 1.0, 1.0, 12.0) : 12.0;
  return fmt::format("{:.{}g}", value, static_cast<int>(digits));
}

}  // namespace tchat
