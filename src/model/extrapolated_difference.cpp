#include "model/extrapolated_difference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace tchat {

namespace {

constexpr int levels = 10;

/// Neville's tableau for one entry: column k cancels the error terms up to h^(2k).
class Tableau {
 public:
  double best = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::infinity();

  /// The central difference at the next step size, half the last one; `rounding` is its rounding error. A quotient that
  /// is not finite restarts the tableau.
  void add(double quotient, double rounding) {
    if (!std::isfinite(quotient)) {
      count_ = 0;
      return;
    }
    std::array<double, levels> row{};
    row[0] = quotient;
    double factor = 1.0;
    for (std::size_t k = 1; k <= count_; ++k) {
      factor *= 4.0;
      row[k] = row[k - 1] + (row[k - 1] - last_[k - 1]) / (factor - 1.0);
      const double change = std::max(std::abs(row[k] - row[k - 1]), std::abs(row[k] - last_[k - 1]));
      if (change + rounding < error) {
        error = change + rounding;
        best = row[k];
      }
    }
    last_ = row;
    ++count_;
  }

 private:
  std::array<double, levels> last_{};
  std::size_t count_ = 0;
};

}  // namespace

ExtrapolatedDifference extrapolated_difference(const std::function<Eigen::VectorXd(double)>& phi, double step) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  std::vector<Tableau> tableaus;
  double h = step;
  for (int level = 0; level < levels; ++level, h /= 2.0) {
    const Eigen::VectorXd above = phi(h);
    const Eigen::VectorXd below = phi(-h);
    tableaus.resize(static_cast<std::size_t>(above.size()));
    for (Eigen::Index i = 0; i < above.size(); ++i)
      tableaus[static_cast<std::size_t>(i)].add((above(i) - below(i)) / (2.0 * h),
                                                epsilon * (std::abs(above(i)) + std::abs(below(i))) / h);
  }
  ExtrapolatedDifference result;
  result.value.resize(static_cast<Eigen::Index>(tableaus.size()));
  result.error.resize(result.value.size());
  for (Eigen::Index i = 0; i < result.value.size(); ++i) {
    result.value(i) = tableaus[static_cast<std::size_t>(i)].best;
    result.error(i) = tableaus[static_cast<std::size_t>(i)].error;
  }
  return result;
}

}  // namespace tchat
