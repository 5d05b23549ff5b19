#include "orbit/critical_multiplier.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tchat {

namespace {

/// S with one full column and row of the border after it.
SparseLu make_bordered(const CondensedReturnMap& map) {
  std::vector<int> rows = map.rows();
  std::vector<int> columns = map.columns();
  for (int i = 0; i < map.size(); ++i) rows.push_back(i), columns.push_back(map.size());
  for (int i = 0; i < map.size(); ++i) rows.push_back(map.size()), columns.push_back(i);
  return {map.size() + 1, rows, columns};
}

void normalise(std::vector<double>& v) {
  const double norm = std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
  if (norm > 0.0)
    for (double& entry : v) entry /= norm;
}

}  // namespace

CriticalMultiplier::CriticalMultiplier(const DefiningSystem& system, const OrbitShape& shape, int multiplier)
    : multiplier_(multiplier),
      map_(system, shape),
      lu_(make_bordered(map_)),
      column_(static_cast<std::size_t>(map_.size())),
      row_(column_.size()),
      small_v_(column_.size() + 1),
      small_w_(column_.size() + 1),
      rhs_(column_.size() + 1, 0.0),
      v_(shape, system.free_count()),
      gradient_(shape, system.free_count()) {
  begin_border();
  rhs_.back() = 1.0;
}

/// Any border that leaves the matrix regular.
void CriticalMultiplier::begin_border() {
  for (std::size_t i = 0; i < column_.size(); ++i) {
    column_[i] = std::sin(1.0 + 0.7 * static_cast<double>(i));
    row_[i] = std::cos(0.3 + 0.9 * static_cast<double>(i));
  }
  normalise(column_);
  normalise(row_);
}

void CriticalMultiplier::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.insert(memory.end(), column_.begin(), column_.end());
  memory.insert(memory.end(), row_.begin(), row_.end());
}

void CriticalMultiplier::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return begin_border();
  const auto middle = memory.begin() + static_cast<std::ptrdiff_t>(column_.size());
  column_.assign(memory.begin(), middle);
  row_.assign(middle, memory.end());
}

bool CriticalMultiplier::solve_bordered(const CondensedSystem& condensed, const Orbit& x) {
  map_.values(condensed, x, multiplier_, values_);
  values_.insert(values_.end(), column_.begin(), column_.end());
  values_.insert(values_.end(), row_.begin(), row_.end());
  if (!lu_.factorize(values_)) return false;
  lu_.solve(rhs_.data(), small_v_.data());
  lu_.solve_transposed(rhs_.data(), small_w_.data());
  value_ = small_v_.back();
  return std::isfinite(value_) && std::isfinite(small_w_.front());
}

void CriticalMultiplier::follow_null_vectors() {
  std::copy_n(small_w_.begin(), column_.size(), column_.begin());
  std::copy_n(small_v_.begin(), row_.size(), row_.begin());
  normalise(column_);
  normalise(row_);
}

bool CriticalMultiplier::put_critical_vectors(CriticalVectors& vectors) const {
  vectors.multiplier = multiplier_;
  vectors.right = Eigen::VectorXd::Map(small_v_.data(), map_.size()).cast<std::complex<double>>();
  vectors.left = Eigen::VectorXd::Map(small_w_.data(), map_.size()).cast<std::complex<double>>();
  return true;
}

bool CriticalMultiplier::evaluate(CondensedSystem& condensed, const Orbit& x) {
  // The border follows the null vectors; the first time it takes some rounds to find them.
  for (int round = started_ ? 3 : 0; round < 4; ++round) {
    if (!solve_bordered(condensed, x)) return false;
    follow_null_vectors();
  }
  started_ = true;
  gradient_.set_zero();
  condensed.extend(small_v_.data(), v_);
  map_.subtract_derivative(condensed, x, small_w_.data(), std::span(&v_, 1), gradient_);
  const double* last = small_w_.data() + map_.last_connectivity_row();
  multiplicity_ = std::inner_product(last, last + condensed.shape().dimension, small_v_.begin(), 0.0);
  return true;
}

}  // namespace tchat
