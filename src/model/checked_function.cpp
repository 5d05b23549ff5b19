#include "model/checked_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/levels.hpp"
#include "base/limit_at_zero.hpp"
#include "model/scales.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double trust_factor = 20.0;                      // on the error estimate of the differences
constexpr double relative_tolerance = level::differences;  // of a function's scale

}  // namespace

double checked_range(double value) {
  const double size = std::abs(value);
  return is_ordinary(size) ? 1.0 + size : size;
}

std::string point_text(const HybridSystem& system, const TestPoint& at) {
  std::string text = "x = (";
  for (int k = 1; k <= system.dimension(); ++k)
    text += fmt::format("{}{:.6g}", k > 1 ? ", " : "", system.unit_of(k) * at.x(k - 1));
  return text + ")";
}

CheckedFunction::CheckedFunction(const HybridSystem& system, FunctionKind kind, int index)
    : CheckedFunction(system, kind, index, std::vector<int>(static_cast<std::size_t>(system.parameters()))) {
  std::iota(active_.begin(), active_.end(), 1);
}

CheckedFunction::CheckedFunction(const HybridSystem& system, FunctionKind kind, int index, std::vector<int> active)
    : system_(system), kind_(kind), index_(index), active_(std::move(active)) {}

VectorXd CheckedFunction::value(const TestPoint& at) const {
  VectorXd out(rows());
  system_.value(kind_, index_, at.x.data(), at.par.data(), out.data());
  return out;
}

MatrixXd CheckedFunction::first(const TestPoint& at, VectorXd& value) const {
  MatrixXd derivative(rows(), variables());
  value.resize(rows());
  system_.first(kind_, index_, at.x.data(), at.par.data(), active_, value.data(), derivative.data(),
                derivative.data() + rows() * system_.dimension());
  return derivative;
}

MatrixXd CheckedFunction::second(const TestPoint& at, const VectorXd& direction, VectorXd& along) const {
  MatrixXd derivative(rows(), variables());
  along.resize(rows());
  system_.second(kind_, index_, at.x.data(), at.par.data(), active_, direction.data(), along.data(), derivative.data(),
                 derivative.data() + rows() * system_.dimension());
  return derivative;
}

double CheckedFunction::variable(const TestPoint& at, int c) const {
  return c < system_.dimension() ? at.x(c) : at.par(parameter(c) - 1);
}

TestPoint CheckedFunction::moved(TestPoint at, int c, double t) const {
  double& moving = c < system_.dimension() ? at.x(c) : at.par(parameter(c) - 1);
  moving += t;
  return at;
}

TestPoint CheckedFunction::moved(TestPoint at, const VectorXd& steps) const {
  for (int c = 0; c < variables(); ++c) at = moved(std::move(at), c, steps(c));
  return at;
}

std::string CheckedFunction::variable_name(int c) const {
  if (c < 0) return "a random direction";
  return c < system_.dimension() ? system_.state_name(c + 1) : system_.parameter_name(parameter(c));
}

std::string CheckedFunction::row_name(int row) const {
  switch (kind_) {
    case FunctionKind::field:
      return fmt::format("f_{}[{}]", index_, system_.state_name(row + 1));
    case FunctionKind::event:
      return fmt::format("h_{}", index_);
    case FunctionKind::jump:
      return fmt::format("g_{}[{}]", index_, system_.state_name(row + 1));
    default:
      return fmt::format("q_{}[{}]", index_, row + 1);
  }
}

namespace {

/// How often differences are taken once more, with shorter and shorter steps that are no halvings of one another: the
/// last ones for functions that oscillate within the first.
constexpr std::size_t most_retries = 20;
constexpr double next_step = 0.37;
constexpr double same_digits = level::visible;  // of differences that agree

/// One column of derivatives against differences of several step lengths, which are taken as they are asked for.
class ColumnComparison {
 public:
  /// `along`: the function of a step in the column's variable. `scale`: of the function.
  ColumnComparison(std::function<VectorXd(double)> along, double step, double scale)
      : along_(std::move(along)), step_(step), scale_(scale) {
    differences_.reserve(most_retries + 2);  // references to them stay
    differences_.push_back(extrapolated_difference(along_, step));
  }

  /// Of an entry with these row, column and supplied value; nothing where no differences can be believed. A fault needs
  /// three step lengths whose differences agree: on a function that oscillates within the step, and on rounding, an
  /// error estimate may be small by chance, and with so many steps two of them agree by chance.
  std::optional<ComparedEntry> entry(ComparedEntry at) {
    if (!std::isfinite(differences_.front().value(at.row))) return std::nullopt;
    ComparedEntry found = compared(at, differences_.front());
    for (std::size_t k = 0; found.at_fault() && std::isfinite(at.supplied); ++k) {
      if (k == most_retries) return std::nullopt;
      const ExtrapolatedDifference& next = with_shorter_step(k);
      if (agree(k, at.row) && agree(k + 1, at.row)) break;
      if (std::isfinite(next.value(at.row))) found = compared(at, next);
    }
    return found;
  }

 private:
  double allowed(double error) const { return trust_factor * error + relative_tolerance * scale_; }

  ComparedEntry compared(ComparedEntry at, const ExtrapolatedDifference& difference) const {
    at.difference = difference.value(at.row);
    const double distance = std::abs(at.supplied - at.difference);
    at.relative = distance / scale_;
    at.excess = std::isfinite(at.supplied) ? distance / allowed(difference.error(at.row)) : INFINITY;
    return at;
  }

  /// Differences that are values of an oscillation by chance are about as large as its amplitude by the step, whatever
  /// constant the function has beside it.
  bool agree(std::size_t k, int row) {
    const ExtrapolatedDifference &b = with_shorter_step(k), &a = differences_[k];
    const double step = step_ * std::pow(next_step, k + 1);
    const double larger = std::max(std::abs(a.value(row)), std::abs(b.value(row)));
    const double here = along_(0.0)(row);
    const double amplitude = std::max(std::abs(along_(step)(row) - here), std::abs(along_(-step)(row) - here));
    const double of_amplitude = level::differences * amplitude + level::rounding_of_sums * std::abs(here);
    return std::abs(a.value(row) - b.value(row)) <= same_digits * larger + of_amplitude / step;
  }

  const ExtrapolatedDifference& with_shorter_step(std::size_t k) {
    if (differences_.size() == k + 1)
      differences_.push_back(extrapolated_difference(along_, step_ * std::pow(next_step, k + 1)));
    return differences_[k + 1];
  }

  std::function<VectorXd(double)> along_;
  double step_, scale_;
  std::vector<ExtrapolatedDifference> differences_;
};

/// How far entries of `supplied` move with the last digits of the variables, one after the other.
MatrixXd rounding_of(const CheckedFunction& function, const TestPoint& at, const MatrixXd& here,
                     const std::function<MatrixXd(const TestPoint&)>& supplied) {
  constexpr double few_digits = 8.0 * std::numeric_limits<double>::epsilon();
  MatrixXd noise = MatrixXd::Zero(here.rows(), here.cols());
  for (int c = 0; c < function.variables(); ++c)
    for (const double t : {few_digits, -few_digits}) {
      const MatrixXd near = supplied(function.moved(at, c, t * function.variable(at, c)));
      if (near.allFinite()) noise = noise.cwiseMax((near - here).cwiseAbs());
    }
  return noise;
}

}  // namespace

MatrixComparison compare_with_differences(const CheckedFunction& function, const TestPoint& at,
                                          const std::function<MatrixXd(const TestPoint&)>& supplied,
                                          const std::function<VectorXd(const TestPoint&)>& value) {
  MatrixComparison comparison;
  const MatrixXd here = supplied(at);
  const double scale = 1.0 + std::max(value(at).lpNorm<Eigen::Infinity>(), here.lpNorm<Eigen::Infinity>());
  std::optional<MatrixXd> noise;
  for (int c = 0; c < function.variables(); ++c) {
    ColumnComparison column([&](double t) { return value(function.moved(at, c, t)); },
                            0.02 * checked_range(function.variable(at, c)), scale);
    for (int r = 0; r < function.rows(); ++r) {
      ComparedEntry place;
      place.row = r;
      place.column = c;
      place.supplied = here(r, c);
      std::optional<ComparedEntry> entry = column.entry(place);
      if (entry && entry->at_fault()) {
        if (!noise) noise = rounding_of(function, at, here, supplied);
        if (std::abs(entry->supplied - entry->difference) <= trust_factor * (*noise)(r, c)) entry.reset();
      }
      if (!entry) continue;
      if (entry->at_fault()) comparison.faults.push_back(*entry);
      if (entry->excess > comparison.worst.excess) comparison.worst = *entry;
    }
  }
  return comparison;
}

MatrixComparison compare_along_directions(const CheckedFunction& function, const TestPoint& at,
                                          const std::vector<VectorXd>& directions,
                                          const std::function<MatrixXd(const TestPoint&)>& supplied,
                                          const std::function<VectorXd(const TestPoint&)>& value) {
  MatrixComparison comparison;
  const MatrixXd here = supplied(at);
  for (const VectorXd& direction : directions) {
    VectorXd reach = direction;
    for (int c = 0; c < function.variables(); ++c) reach(c) *= checked_range(function.variable(at, c));
    const VectorXd along = here * reach;
    const double scale =
        1.0 + std::max(value(at).lpNorm<Eigen::Infinity>(), (here.cwiseAbs() * reach.cwiseAbs()).maxCoeff());
    ColumnComparison column([&](double t) { return value(function.moved(at, t * reach)); }, 0.02, scale);
    for (int r = 0; r < function.rows(); ++r) {
      ComparedEntry place;
      place.row = r;
      place.column = -1;
      place.supplied = along(r);
      const std::optional<ComparedEntry> entry = column.entry(place);
      if (!entry) continue;
      if (entry->at_fault()) return compare_with_differences(function, at, supplied, value);
      if (entry->excess > comparison.worst.excess) comparison.worst = *entry;
    }
  }
  return comparison;
}

namespace {

constexpr int levels = 10;

}  // namespace

ExtrapolatedDifference extrapolated_difference(const std::function<Eigen::VectorXd(double)>& phi, double step) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  std::vector<LimitAtZero> tableaus;  // in h^2
  double h = step;
  for (int level = 0; level < levels; ++level, h /= 2.0) {
    const Eigen::VectorXd above = phi(h);
    const Eigen::VectorXd below = phi(-h);
    tableaus.resize(static_cast<std::size_t>(above.size()));
    for (Eigen::Index i = 0; i < above.size(); ++i)
      tableaus[static_cast<std::size_t>(i)].add(h * h, (above(i) - below(i)) / (2.0 * h),
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
