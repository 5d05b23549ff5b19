#include "bvp/condensed_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <type_traits>

#include "linear_algebra/partial_lu.hpp"

namespace tchat {

namespace {

double largest_of(const std::vector<double>& values, double so_far) {
  for (const double v : values) so_far = std::max(so_far, std::abs(v));
  return so_far;
}

int total_coupling_rows(const DefiningSystem& system) {
  int total = 0;
  for (int s = 0; s < system.segments(); ++s) total += system.coupling_rows(s);
  return total;
}

std::vector<double> zeros(std::ptrdiff_t count) { return std::vector<double>(static_cast<std::size_t>(count), 0.0); }

/// `count` rows from `row` that are dense in some columns.
void put_dense(int row, int count, int column, int columns, std::vector<int>& row_list, std::vector<int>& column_list) {
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < columns; ++b) row_list.push_back(row + a), column_list.push_back(column + b);
}

/// Calls work with the dimension as a compile-time number where that is a common one: the loops over states are the
/// innermost ones and short.
template <class Work>
auto with_dimension(int n, Work&& work) {
  switch (n) {
    case 2:
      return work(std::integral_constant<int, 2>{});
    case 3:
      return work(std::integral_constant<int, 3>{});
    case 4:
      return work(std::integral_constant<int, 4>{});
    case 5:
      return work(std::integral_constant<int, 5>{});
    case 6:
      return work(std::integral_constant<int, 6>{});
    default:
      return work(n);
  }
}

/// One node's columns of the rows of a Gauss point: value * jacobian (row by row) + slope * identity.
template <class Dimension>
void put_node(Dimension n, double* __restrict columns, int width, double value, double slope,
              const double* __restrict jacobian) {
  for (int a = 0; a < n; ++a, columns += width, jacobian += n)
    for (int b = 0; b < n; ++b) columns[b] = value * jacobian[b] + (a == b ? slope : 0.0);
}

}  // namespace

double OrbitResidual::largest() const {
  return largest_of(integral, largest_of(coupling, largest_of(collocation, 0.0)));
}

bool OrbitResidual::finite() const {
  const auto good = [](const std::vector<double>& v) { return all_finite(v.data(), static_cast<int>(v.size())); };
  return good(collocation) && good(coupling) && good(integral);
}

CondensedSystem::CondensedSystem(const DefiningSystem& system, const OrbitShape& shape, int border_rows)
    : system_(system),
      shape_(shape),
      n_(shape.dimension),
      globals_(system.free_count()),
      scalars_(1 + globals_),
      border_(border_rows),
      rule_(shape.collocation),
      interval_(interval_kernel(n_, shape.collocation, scalars_)),
      join_(join_kernel(n_, scalars_)),
      joins_(joins_of_halves(shape.intervals)),
      lu_(make_sparse()) {
  assert((n_ + 1) * shape.segments + globals_ == total_coupling_rows(system) + border_rows);
  const std::ptrdiff_t blocks = block(shape.segments, 0);
  const int interval_rows = interval_.rows() + border_;
  const int join_rows = join_.rows() + border_;
  interval_blocks_ = {blocks, interval_rows * interval_.width()};
  interval_swaps_ = {blocks, interval_.pivots()};
  join_blocks_ = {blocks, join_rows * join_.width()};
  join_swaps_ = {blocks, join_.pivots()};
  interval_rhs_ = {blocks, interval_rows};
  join_rhs_ = {blocks, join_rows};
  first_blocks_ = {shape.segments, n_ * n_};
  last_blocks_ = first_blocks_;
  scalar_blocks_ = {shape.segments, n_ * scalars_};
  border_blocks_ = {shape.segments, border_ * (2 * n_ + scalars_)};
  segment_rhs_ = {shape.segments, n_ + border_};
  triplet_values_.resize(triplet_rows_.size());
  rhs_ = zeros(lu_.size());
  solution_ = rhs_;

  x_ = slope_ = f_ = zeros(n_);
  fx_ = scaled_ = zeros(n_ * n_);
  fp_ = zeros(n_ * globals_);
  local_ = zeros(interval_.width());
  join_local_ = zeros(join_.width());
  zero_ = make_residual();
  zero_rhs_ = zeros(std::max(interval_rows, join_rows));
}

/// Pieces before those that they are part of, in an order that goes on with what was made last.
std::vector<CondensedSystem::Join> CondensedSystem::joins_of_halves(int intervals) {
  std::vector<Join> result;
  std::vector<Join> open{{0, halfway(0, intervals), intervals}};
  while (!open.empty()) {  // a piece, its right half, its left half: the reverse of the order wanted
    const Join at = open.back();
    open.pop_back();
    if (at.last - at.first < 2) continue;
    result.push_back(at);
    open.push_back({at.first, halfway(at.first, at.middle), at.middle});
    open.push_back({at.middle, halfway(at.middle, at.last), at.last});
  }
  std::reverse(result.begin(), result.end());
  return result;
}

SparseLu CondensedSystem::make_sparse() {
  const auto dense = [this](int row, int count, int column, int columns) {
    put_dense(row, count, column, columns, triplet_rows_, triplet_columns_);
  };
  int row = 0;
  for (int s = 0; s < shape_.segments; ++s) {
    dense(row, n_, start_unknown(s), 2 * n_ + 1);
    dense(row, n_, global_unknown(0), globals_);
    row += n_;
    CouplingPattern pattern(unknowns(), globals_, row, triplet_rows_, triplet_columns_);
    system_.coupling_pattern(s, pattern);
    row += system_.coupling_rows(s);
  }
  dense(row, border_, 0, global_unknown(globals_));
  row += border_;
  return {row, triplet_rows_, triplet_columns_};
}

OrbitResidual CondensedSystem::make_residual() const {
  OrbitResidual r;
  r.collocation = zeros(block(shape_.segments, 0) * shape_.collocation * n_);
  r.coupling = zeros(total_coupling_rows(system_));
  r.integral = zeros(system_.integral_conditions());
  return r;
}

// ---- residual -------------------------------------------------------------------------------------------------------

template <class Dimension>
void CondensedSystem::interpolate(Dimension n, const Orbit& x, int s, int j, int gauss_point) {
  const double* u = x.node(s, j * shape_.collocation);
  double* const value = x_.data();
  double* const slope = slope_.data();
  for (int a = 0; a < n; ++a) {
    double sum = 0.0;
    double slope_sum = 0.0;
    for (int i = 0; i <= shape_.collocation; ++i) {
      sum += rule_.value(gauss_point, i) * u[i * n + a];
      slope_sum += rule_.slope(gauss_point, i) * u[i * n + a];
    }
    value[a] = sum;
    slope[a] = slope_sum;
  }
}

void CondensedSystem::evaluate(const Orbit& x, OrbitResidual& residual) {
  const HybridSystem& hybrid = system_.system();
  const double* par = x.par.data();
  double* collocation = residual.collocation.data();
  double* coupling = residual.coupling.data();
  for (int s = 0; s < shape_.segments; ++s) {
    const IndexVector& v = system_.signature()[index(s)];
    for (int j = 0; j < shape_.intervals; ++j) {
      const double scale = (x.mesh[index(j + 1)] - x.mesh[index(j)]) * x.duration(s);
      for (int g = 0; g < shape_.collocation; ++g, collocation += n_) {
        with_dimension(n_, [&](auto n) { interpolate(n, x, s, j, g); });
        hybrid.value(FunctionKind::field, v.field, x_.data(), par, collocation);
        for (int a = 0; a < n_; ++a) collocation[a] = slope_[index(a)] - scale * collocation[a];
      }
    }
    system_.coupling_values(s, x, coupling);
    coupling += system_.coupling_rows(s);
  }
}

// ---- linearisation --------------------------------------------------------------------------------------------------

Linearization CondensedSystem::linearize(const Orbit& x, std::span<const OrbitVector> rows, OrbitResidual& residual) {
  double* collocation = residual.collocation.data();
  for (int s = 0; s < shape_.segments; ++s) {
    const Linearization outcome = condense_segment(x, s, rows, collocation);
    if (outcome != Linearization::ready) return outcome;
    collocation += shape_.intervals * shape_.collocation * n_;
  }
  if (!assemble(x, rows, residual)) return Linearization::not_finite;
  return lu_.factorize(triplet_values_) ? Linearization::ready : Linearization::singular;
}

Linearization CondensedSystem::condense_segment(const Orbit& x, int s, std::span<const OrbitVector> rows,
                                                double* collocation) {
  for (int j = 0; j < shape_.intervals; ++j) {
    double* a = interval_blocks_[block(s, j)];
    if (!fill_interval(x, s, j, a, collocation + j * shape_.collocation * n_)) return Linearization::not_finite;
    fill_border(s, j, rows, a);
    if (!interval_.eliminate(a, border_, interval_swaps_[block(s, j)])) return Linearization::singular;
  }
  for (const Join& at : joins_)
    if (!join(s, at)) return Linearization::singular;
  keep_segment_blocks(s);
  return Linearization::ready;
}

/// Collocation rows of one interval: slope - h T f at the Gauss points, columns (interior | left | right | T, p).
bool CondensedSystem::fill_interval(const Orbit& x, int s, int j, double* block, double* collocation) {
  return with_dimension(n_, [&](auto n) { return fill_interval_of(n, x, s, j, block, collocation); });
}

// clang-tidy does not see that `collocation` is written to, in an expression that depends on the template.
template <class Dimension>
// NOLINTNEXTLINE(readability-non-const-parameter)
bool CondensedSystem::fill_interval_of(Dimension n, const Orbit& x, int s, int j, double* block, double* collocation) {
  const int c = shape_.collocation;
  const int width = interval_.width();
  const int left = interval_.pivots();
  const int duration = left + 2 * n;
  const double h = x.mesh[index(j + 1)] - x.mesh[index(j)];
  const double scale = h * x.duration(s);
  const int field = system_.signature()[index(s)].field;
  double finite = 0.0;
  for (int g = 0; g < c; ++g) {
    interpolate(n, x, s, j, g);
    system_.system().first(FunctionKind::field, field, x_.data(), x.par.data(), system_.free_parameters(), f_.data(),
                           fx_.data(), fp_.data());
    double* const rows = block + g * n * width;
    double* const by_rows = scaled_.data();  // -h T f_x, row by row
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) {
        const double entry = fx_[index(b * n + a)];
        finite += entry - entry;
        by_rows[a * n + b] = -scale * entry;
      }
    for (int i = 0; i <= c; ++i) {
      // The nodes 1..c-1 come first, then node 0 and node c.
      double* const columns = rows + (i == 0 ? left : i == c ? left + n : (i - 1) * n);
      put_node(n, columns, width, rule_.value(g, i), rule_.slope(g, i), by_rows);
    }
    for (int a = 0; a < n; ++a) {
      const double f = f_[index(a)];
      finite += f - f;
      collocation[g * n + a] = slope_[index(a)] - scale * f;
      double* const row = rows + a * width + duration;
      row[0] = -h * f;
      for (int k = 0; k < globals_; ++k) row[1 + k] = -scale * fp_[index(k * n + a)];
    }
  }
  return finite == 0.0;
}

/// Border rows of one interval: the interior nodes and the left mesh node; the right one belongs to the next interval,
/// except at the end of the segment. The scalars' own weights are added when the segments are assembled.
void CondensedSystem::fill_border(int s, int j, std::span<const OrbitVector> rows, double* block) const {
  const int c = shape_.collocation;
  const int width = interval_.width();
  const int left = interval_.pivots();
  for (int r = 0; r < border_; ++r) {
    double* row = block + (interval_.rows() + r) * width;
    const Eigen::MatrixXd& weights = rows[index(r)].states;
    const int column = s * shape_.nodes() + j * c;
    const auto copy = [&](int node, double* to) { std::copy_n(weights.col(column + node).data(), n_, to); };
    for (int i = 1; i < c; ++i) copy(i, row + (i - 1) * n_);
    copy(0, row + left);
    std::fill(row + left + n_, row + width, 0.0);
    if (j == shape_.intervals - 1) copy(c, row + left + n_);
  }
}

CondensedSystem::Piece CondensedSystem::piece(int s, int first, int last) const {
  const bool one_interval = last - first == 1;
  const BlockKernel& kernel = one_interval ? interval_ : join_;
  const double* block =
      one_interval ? interval_blocks_[this->block(s, first)] : join_blocks_[this->block(s, halfway(first, last))];
  const int p = kernel.pivots();
  return {block + p * kernel.width() + p, block + kernel.rows() * kernel.width() + p, kernel.width()};
}

/// Columns (middle | first | last | scalars), rows (left piece; right piece; border).
bool CondensedSystem::join(int s, const Join& at) {
  const int width = join_.width();
  const int size = (join_.rows() + border_) * width;
  double* target = join_blocks_[block(s, at.middle)];
  std::fill(target, target + size, 0.0);
  const auto put_left = [&](const double* from, double* to) {
    for (int a = 0; a < n_; ++a) {
      to[a] += from[n_ + a];
      to[n_ + a] += from[a];
    }
    for (int a = 0; a < scalars_; ++a) to[3 * n_ + a] += from[2 * n_ + a];
  };
  const auto put_right = [&](const double* from, double* to) {
    for (int a = 0; a < n_; ++a) to[a] += from[a];
    for (int a = 0; a < n_ + scalars_; ++a) to[2 * n_ + a] += from[n_ + a];
  };
  const Piece left = piece(s, at.first, at.middle);
  const Piece right = piece(s, at.middle, at.last);
  for (int a = 0; a < n_; ++a) {
    put_left(left.rows + a * left.width, target + a * width);
    put_right(right.rows + a * right.width, target + (n_ + a) * width);
  }
  for (int r = 0; r < border_; ++r) {
    put_left(left.border + r * left.width, target + (join_.rows() + r) * width);
    put_right(right.border + r * right.width, target + (join_.rows() + r) * width);
  }
  return join_.eliminate(target, border_, join_swaps_[block(s, at.middle)]);
}

void CondensedSystem::keep_segment_blocks(int s) {
  const Piece whole = piece(s, 0, shape_.intervals);
  for (int a = 0; a < n_; ++a) {
    const double* from = whole.rows + a * whole.width;
    std::copy_n(from, n_, first_blocks_[s] + a * n_);
    std::copy_n(from + n_, n_, last_blocks_[s] + a * n_);
    std::copy_n(from + 2 * n_, scalars_, scalar_blocks_[s] + a * scalars_);
  }
  const int length = 2 * n_ + scalars_;
  for (int r = 0; r < border_; ++r) std::copy_n(whole.border + r * whole.width, length, border_blocks_[s] + r * length);
}

/// The matrix that UMFPACK sees, in the order of make_sparse().
bool CondensedSystem::assemble(const Orbit& x, std::span<const OrbitVector> rows, OrbitResidual& residual) {
  double* value = triplet_values_.data();
  double* coupling = residual.coupling.data();
  for (int s = 0; s < shape_.segments; ++s) {
    const double* scalars = scalar_blocks_[s];
    for (int a = 0; a < n_; ++a) {
      value = std::copy_n(first_block(s) + a * n_, n_, value);
      value = std::copy_n(last_block(s) + a * n_, n_, value);
      *value++ = scalars[a * scalars_];
    }
    for (int a = 0; a < n_; ++a) value = std::copy_n(scalars + a * scalars_ + 1, globals_, value);

    value = system_.coupling_derivatives(s, x, coupling, value);
    coupling += system_.coupling_rows(s);
  }
  const int length = 2 * n_ + scalars_;
  for (int r = 0; r < border_; ++r) {
    double* globals = value + shape_.segments * (2 * n_ + 1);
    std::copy_n(rows[index(r)].globals.data(), globals_, globals);
    for (int s = 0; s < shape_.segments; ++s) {
      const double* from = border_blocks_[s] + r * length;
      value = std::copy_n(from, 2 * n_ + 1, value);
      value[-1] += rows[index(r)].durations(s);
      for (int g = 0; g < globals_; ++g) globals[g] += from[2 * n_ + 1 + g];
    }
    value += globals_;
  }
  return residual.finite();
}

}  // namespace tchat
