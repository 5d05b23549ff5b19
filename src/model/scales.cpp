#include "model/scales.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"

namespace tchat {

StateSizes::StateSizes(const Eigen::MatrixXd& states)
    : largest_(states.cwiseAbs().rowwise().maxCoeff()),
      couplings_(Eigen::MatrixXd::Zero(states.rows(), states.rows())),
      shares_(Eigen::MatrixXd::Zero(states.rows(), states.rows())),
      in_events_(Eigen::VectorXd::Zero(states.rows())) {}

StateSizes::Terms StateSizes::terms_of(const HybridSystem& system, FunctionKind kind, int index, const double* x,
                                       const double* par) {
  const Eigen::Index n = largest_.size();
  Terms of{Eigen::VectorXd(system.rows(kind)), Eigen::MatrixXd(system.rows(kind), n), 0.0};
  system.first(kind, index, x, par, {}, of.values.data(), of.terms.data(), nullptr);
  of.constant = of.values(0) - of.terms.row(0).dot(Eigen::Map<const Eigen::VectorXd>(x, n));
  of.terms = of.terms.cwiseAbs();
  if (kind == FunctionKind::field && of.terms.allFinite()) couplings_ = couplings_.cwiseMax(of.terms);
  of.terms *= largest_.asDiagonal();
  return of;
}

void StateSizes::add_states(const Terms& of) {
  const Eigen::VectorXd sums = of.terms.rowwise().sum() + of.values.cwiseAbs();
  for (Eigen::Index j = 0; j < sums.size(); ++j)
    if (sums(j) > 0.0 && std::isfinite(sums(j))) shares_.row(j) = shares_.row(j).cwiseMax(of.terms.row(j) / sums(j));
}

void StateSizes::add(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par) {
  const Terms of = terms_of(system, kind, index, x, par);
  if (kind != FunctionKind::event) return add_states(of);
  const double sum = of.terms.sum() + std::abs(of.constant);
  if (sum > 0.0 && std::isfinite(sum)) in_events_ = in_events_.cwiseMax(of.terms.row(0).transpose() / sum);
}

void StateSizes::add_at_rest(const HybridSystem& system, int field, const double* x, const double* par) {
  constexpr double cancelled = 0.01;
  const Terms of = terms_of(system, FunctionKind::field, field, x, par);
  add_states(of);
  in_balance_ = Eigen::VectorXd::Zero(largest_.size());
  for (Eigen::Index j = 0; j < of.values.size(); ++j) {
    const double sum = of.terms.row(j).sum();
    if (sum > 0.0 && std::abs(of.values(j)) <= cancelled * sum)
      in_balance_ = in_balance_->cwiseMax(of.terms.row(j).transpose() / sum);
  }
}

std::vector<bool> StateSizes::known(const std::vector<bool>& sure) const {
  constexpr double small = 1e-9, least_share = 1e-7;
  const Eigen::Index n = largest_.size();
  const auto is_number = [&](Eigen::Index i) {
    const bool is_rounding = in_balance_ && !((*in_balance_)(i) > least_share);
    return !is_rounding && largest_(i) >= std::numeric_limits<double>::min() && std::isfinite(largest_(i));
  };
  // What nothing depends on may be as large as it likes.
  double largest = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double of_others = shares_.col(i).sum() - shares_(i, i) + in_events_(i);
    if (is_number(i) && of_others > 0.0) largest = std::max(largest, largest_(i));
  }
  const bool is_sure = !sure.empty();
  std::vector<bool> has_size = is_sure ? sure : std::vector<bool>(static_cast<std::size_t>(n));
  const auto known = [&](Eigen::Index i) { return static_cast<bool>(has_size[static_cast<std::size_t>(i)]); };
  for (Eigen::Index i = 0; i < n; ++i)
    if (is_number(i) && ((!is_sure && largest_(i) > small * largest) || in_events_(i) > least_share))
      has_size[static_cast<std::size_t>(i)] = true;
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n && !known(i) && is_number(i); ++j)
        if (known(j) && shares_(j, i) > least_share) has_size[static_cast<std::size_t>(i)] = is_new = true;
  }
  return has_size;
}

namespace {

/// Sizes s for which the entries |a_ij| s_j / s_i outside of the diagonal, none negative, have columns and rows of the
/// same sum (Osborne, Journal of the ACM 7, 1960), as far as these are larger than `negligible`.
Eigen::VectorXd osborne_sizes(Eigen::MatrixXd a, double negligible) {
  constexpr int most_sweeps = 50;
  const Eigen::Index n = a.rows();
  a.diagonal().setZero();
  Eigen::VectorXd sizes = Eigen::VectorXd::Ones(n);
  for (int sweep = 0; sweep < most_sweeps; ++sweep)
    for (Eigen::Index i = 0; i < n; ++i) {
      const double row = a.row(i).dot(sizes) / sizes(i) + negligible;
      const double column = a.col(i).dot(sizes.cwiseInverse()) * sizes(i) + negligible;
      if (row > 0.0 && column > 0.0) sizes(i) *= std::sqrt(row / column);
    }
  return sizes;
}

/// With the median 1. All 1 where these are usual.
Eigen::VectorXd balancing_sizes(const Eigen::MatrixXd& a) {
  const Eigen::Index n = a.rows();
  const Eigen::VectorXd sizes = osborne_sizes(a, 0.0);
  if (n == 0 || are_usual(sizes) || !sizes.allFinite()) return Eigen::VectorXd::Ones(n);
  Eigen::VectorXd sorted = sizes;
  std::sort(sorted.begin(), sorted.end());
  return sizes / sorted((n - 1) / 2);
}

}  // namespace

Eigen::VectorXd balancing_units(const Eigen::MatrixXd& a) {
  constexpr double share_of_diagonal = 1e-2;
  const double negligible =
      std::max(share_of_diagonal * a.diagonal().cwiseAbs().maxCoeff(), level::negligible * a.cwiseAbs().maxCoeff());
  const Eigen::VectorXd sizes = osborne_sizes(a.cwiseAbs(), negligible);
  return sizes.allFinite() ? units_of(sizes) : Eigen::VectorXd::Ones(a.rows());
}

Eigen::VectorXd StateSizes::sizes(bool balances) const {
  const std::vector<bool> has_size = known();
  Eigen::VectorXd result = largest_;
  std::vector<Eigen::Index> unknown;
  for (Eigen::Index i = 0; i < result.size(); ++i)
    if (!has_size[static_cast<std::size_t>(i)]) unknown.push_back(i);
  if (balances)
    result(unknown) = balancing_sizes(couplings_(unknown, unknown));
  else
    result(unknown).setOnes();
  return result;
}

Eigen::VectorXd sizes_at(const HybridSystem& system, int field, const Eigen::VectorXd& x, const Eigen::VectorXd& par) {
  const Eigen::Index n = x.size();
  Eigen::VectorXd f(n);
  Eigen::MatrixXd by_state(n, n);
  system.first(FunctionKind::field, field, x.data(), par.data(), {}, f.data(), by_state.data(), nullptr);
  Eigen::VectorXd sizes = x.cwiseAbs();
  if (!f.allFinite() || !by_state.allFinite()) return sizes;
  const Eigen::VectorXd accelerations = by_state * f;
  constexpr double never = std::numeric_limits<double>::infinity(), rounding = 1e-6;
  const auto shorter = [](double time, double other) { return other > 0.0 && other < time ? other : time; };
  // Where f_x is nilpotent, as [[-1, -1], [1, 1]] is, its eigenvalues are rounding, 1e-8.
  const Eigen::VectorXd units = balancing_units(by_state);
  const Eigen::MatrixXd balanced = units.cwiseInverse().asDiagonal() * by_state * units.asDiagonal();
  const double norm = balanced.cwiseAbs().rowwise().sum().maxCoeff();
  const double fastest = eigenvalues(by_state).cwiseAbs().maxCoeff();
  const double by_itself = shorter(never, fastest > rounding * norm ? 1.0 / fastest : never);
  Eigen::VectorXd times(n);
  for (Eigen::Index i = 0; i < n; ++i)
    times(i) = shorter(shorter(by_itself, sizes(i) / std::abs(f(i))), std::sqrt(sizes(i) / std::abs(accelerations(i))));
  // That of a state which is rounding of zero is far shorter than others.
  double longest = 0.0, shortest = never;
  for (const double time : times)
    if (std::isfinite(time)) longest = std::max(longest, time);
  for (const double time : times)
    if (time > rounding * longest) shortest = std::min(shortest, time);
  if (!std::isfinite(shortest)) return sizes;
  // Near rest, terms cancel in a state's equation. What integration resolves of it, 1e-10 of its size, is 100 times
  // their rounding.
  constexpr double resolved = 1e-4;
  const Eigen::VectorXd terms = by_state.cwiseAbs() * x.cwiseAbs();
  return sizes.cwiseMax(shortest * f.cwiseAbs()).cwiseMax(resolved * std::min(by_itself, longest) * terms);
}

bool is_ordinary(double size) {
  constexpr double ordinary = 1024.0;
  size = std::abs(size);
  const bool is_known = size >= std::numeric_limits<double>::min() && std::isfinite(size);
  return !is_known || (size <= ordinary && size >= 1.0 / ordinary);
}

double default_weight(double size) { return is_ordinary(size) ? 1.0 : 1.0 / (size * size); }

bool are_usual(const Eigen::VectorXd& sizes) {
  constexpr double usual = 64.0;
  return std::all_of(sizes.begin(), sizes.end(), [](double size) {
    return size < std::numeric_limits<double>::min() || (size <= usual && size >= 1.0 / usual);
  });
}

double size_for_tolerance(double size) {
  constexpr double least = 1e-30;  // far above the smallest numbers, also times a tolerance
  return size > 0.0 ? std::clamp(size, least, 1.0 / least) : 1.0;
}

Eigen::VectorXd sizes_from_ranges(const Eigen::VectorXd& ranges, const Eigen::VectorXd& sizes) {
  return ranges.binaryExpr(sizes, [](double range, double size) {
    return range > level::located * size ? range : size_for_tolerance(size);
  });
}

Eigen::VectorXd sizes_of_differences(const Eigen::VectorXd& low, const Eigen::VectorXd& high,
                                     const std::vector<bool>& rounding, const std::vector<bool>& left_out) {
  constexpr double share = 1e-3;
  const auto has = [](const std::vector<bool>& flags, Eigen::Index i) {
    const auto k = static_cast<std::size_t>(i);
    return k < flags.size() && flags[k];
  };
  Eigen::VectorXd sizes = high - low;
  double largest = 0.0;
  for (Eigen::Index i = 0; i < sizes.size(); ++i)
    if (!has(left_out, i)) largest = std::max(largest, sizes(i));
  sizes += share * low.cwiseAbs().cwiseMax(high.cwiseAbs());
  for (Eigen::Index i = 0; i < sizes.size(); ++i) {
    if (has(rounding, i)) sizes(i) += share * largest;
    if (has(left_out, i)) sizes(i) = std::numeric_limits<double>::infinity();
  }
  return sizes;
}

double length_in_sizes(const Eigen::VectorXd& d, const Eigen::VectorXd& sizes) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < d.size(); ++i)
    if (d(i) != 0.0) sum += std::pow(d(i) / sizes(i), 2);
  return std::sqrt(sum);
}

Eigen::VectorXd units_of(const Eigen::VectorXd& sizes) {
  if (are_usual(sizes)) return Eigen::VectorXd::Ones(sizes.size());
  return sizes.unaryExpr([](double size) { return std::exp2(std::round(std::log2(size_for_tolerance(size)))); });
}

Eigen::VectorXd units_of_states(const HybridSystem& system) {
  Eigen::VectorXd units(system.dimension());
  for (int k = 1; k <= system.dimension(); ++k) units(k - 1) = system.unit_of(k);
  return units;
}

}  // namespace tchat
