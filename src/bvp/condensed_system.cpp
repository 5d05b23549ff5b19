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

int total_end_conditions(const DefiningSystem& system) {
  int total = 0;
  for (int s = 0; s < system.segments(); ++s) total += system.end_conditions(s);
  return total;
}

int most_end_conditions(const DefiningSystem& system) {
  int most = 0;
  for (int s = 0; s < system.segments(); ++s) most = std::max(most, system.end_conditions(s));
  return most;
}

std::vector<double> zeros(std::ptrdiff_t count) { return std::vector<double>(static_cast<std::size_t>(count), 0.0); }

/// Rows are numbered as they are met; repeated calls keep a running position in the triplet list.
struct PatternBuilder {
  std::vector<int>& rows;
  std::vector<int>& columns;
  void dense(int row, int row_count, int column, int column_count) {
    for (int a = 0; a < row_count; ++a)
      for (int b = 0; b < column_count; ++b) rows.push_back(row + a), columns.push_back(column + b);
  }
  void diagonal(int row, int column, int count) {
    for (int a = 0; a < count; ++a) rows.push_back(row + a), columns.push_back(column + a);
  }
};

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

double OrbitResidual::largest() const { return largest_of(connection, largest_of(end, largest_of(collocation, 0.0))); }

bool OrbitResidual::finite() const {
  const auto good = [](const std::vector<double>& v) { return all_finite(v.data(), static_cast<int>(v.size())); };
  return good(collocation) && good(end) && good(connection);
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
      chain_(chain_kernel(n_, scalars_)),
      lu_(make_sparse()) {
  assert(shape.segments + globals_ == total_end_conditions(system) + border_rows);
  const std::ptrdiff_t blocks = block(shape.segments, 0);
  const int interval_rows = interval_.rows() + border_;
  const int chain_rows = chain_.rows() + border_;
  interval_blocks_ = zeros(blocks * interval_rows * interval_.width());
  interval_swaps_.resize(index(blocks * interval_.pivots()));
  chain_blocks_ = zeros(blocks * chain_rows * chain_.width());
  chain_swaps_.resize(index(blocks * chain_.pivots()));
  interval_rhs_ = zeros(blocks * interval_rows);
  chain_rhs_ = zeros(blocks * chain_rows);
  first_blocks_ = zeros(shape.segments * n_ * n_);
  last_blocks_ = first_blocks_;
  scalar_blocks_ = zeros(shape.segments * n_ * scalars_);
  border_blocks_ = zeros(shape.segments * border_ * (2 * n_ + scalars_));
  segment_rhs_ = zeros(shape.segments * (n_ + border_));
  triplet_values_.resize(triplet_rows_.size());
  rhs_ = zeros(lu_.size());
  solution_ = rhs_;

  const int conditions = most_end_conditions(system);
  x_ = slope_ = f_ = zeros(n_);
  fx_ = scaled_ = zeros(n_ * n_);
  fp_ = zeros(n_ * globals_);
  local_ = zeros(interval_.width());
  chain_local_ = zeros(chain_.width());
  h_ = zeros(conditions);
  hx_ = zeros(conditions * n_);
  hp_ = zeros(conditions * globals_);
  zero_ = make_residual();
  zero_rhs_ = zeros(std::max(interval_rows, chain_rows));
}

SparseLu CondensedSystem::make_sparse() {
  PatternBuilder pattern{triplet_rows_, triplet_columns_};
  const int m = shape_.segments;
  int row = 0;
  for (int s = 0; s < m; ++s) {
    const int conditions = system_.end_conditions(s);
    pattern.dense(row, n_, start_unknown(s), 2 * n_ + 1);
    pattern.dense(row, n_, global_unknown(0), globals_);
    row += n_;
    pattern.dense(row, conditions, end_unknown(s), n_);
    pattern.dense(row, conditions, global_unknown(0), globals_);
    row += conditions;
    pattern.diagonal(row, start_unknown((s + 1) % m), n_);
    pattern.dense(row, n_, end_unknown(s), n_);
    pattern.dense(row, n_, global_unknown(0), globals_);
    row += n_;
  }
  pattern.dense(row, border_, 0, global_unknown(globals_));
  row += border_;
  return {row, triplet_rows_, triplet_columns_};
}

OrbitResidual CondensedSystem::make_residual() const {
  OrbitResidual r;
  r.collocation = zeros(block(shape_.segments, 0) * shape_.collocation * n_);
  r.end = zeros(total_end_conditions(system_));
  r.connection = zeros(shape_.segments * n_);
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
  double* end = residual.end.data();
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
    system_.end_values(s, x.end(s), par, end);
    end += system_.end_conditions(s);
    double* connection = &residual.connection[index(s * n_)];
    hybrid.value(FunctionKind::jump, v.jump, x.end(s), par, connection);
    const double* next = x.start((s + 1) % shape_.segments);
    for (int a = 0; a < n_; ++a) connection[a] = next[a] - connection[a];
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
  const int block_size = (interval_.rows() + border_) * interval_.width();
  for (int j = 0; j < shape_.intervals; ++j) {
    double* a = &interval_blocks_[index(block(s, j) * block_size)];
    if (!fill_interval(x, s, j, a, collocation + j * shape_.collocation * n_)) return Linearization::not_finite;
    fill_border(s, j, rows, a);
    if (!interval_.eliminate(a, border_, &interval_swaps_[index(block(s, j) * interval_.pivots())]))
      return Linearization::singular;
  }
  for (int j = 1; j < shape_.intervals; ++j)
    if (!join(s, j)) return Linearization::singular;
  const int p = interval_.pivots();
  if (shape_.intervals == 1) {
    keep_segment_blocks(s, &interval_blocks_[index(block(s, 0) * block_size)], interval_.width(), p, p + n_, p + 2 * n_,
                        p, interval_.rows());
  } else {
    const int chain_size = (chain_.rows() + border_) * chain_.width();
    keep_segment_blocks(s, &chain_blocks_[index(block(s, shape_.intervals - 1) * chain_size)], chain_.width(), n_,
                        2 * n_, 3 * n_, n_, chain_.rows());
  }
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

/// Eliminates the mesh node between everything left of interval j and interval j:
/// columns (middle | first | last | scalars), rows (what came before; interval j; border).
bool CondensedSystem::join(int s, int j) {
  const int wi = interval_.width();
  const int wc = chain_.width();
  const int p = interval_.pivots();
  const int interval_size = (interval_.rows() + border_) * wi;
  const int chain_size = (chain_.rows() + border_) * wc;
  double* target = &chain_blocks_[index(block(s, j) * chain_size)];
  std::fill(target, target + chain_size, 0.0);

  const double* own = &interval_blocks_[index(block(s, j) * interval_size)];
  const auto put_own = [&](int from_row, int to_row) {
    const double* from = own + from_row * wi + p;
    double* to = target + to_row * wc;
    for (int a = 0; a < n_; ++a) to[a] += from[a];
    for (int a = 0; a < n_ + scalars_; ++a) to[2 * n_ + a] += from[n_ + a];
  };
  const bool opening = j == 1;
  const double* before = opening ? own - interval_size : target - chain_size;
  const auto put_before = [&](int from_row, int to_row) {
    double* to = target + to_row * wc;
    const double* from = before + from_row * (opening ? wi : wc) + (opening ? p : n_);  // (first | last | scalars)
    for (int a = 0; a < n_; ++a) {
      to[a] += from[n_ + a];
      to[n_ + a] += from[a];
    }
    for (int a = 0; a < scalars_; ++a) to[3 * n_ + a] += from[2 * n_ + a];
  };
  for (int a = 0; a < n_; ++a) {
    put_before((opening ? p : n_) + a, a);
    put_own(p + a, n_ + a);
  }
  for (int r = 0; r < border_; ++r) {
    put_before((opening ? interval_.rows() : chain_.rows()) + r, chain_.rows() + r);
    put_own(interval_.rows() + r, chain_.rows() + r);
  }
  return chain_.eliminate(target, border_, &chain_swaps_[index(block(s, j) * chain_.pivots())]);
}

void CondensedSystem::keep_segment_blocks(int s, const double* block, int width, int first, int last, int scalars,
                                          int row, int border_row) {
  for (int a = 0; a < n_; ++a) {
    const double* from = block + (row + a) * width;
    std::copy_n(from + first, n_, &first_blocks_[index((s * n_ + a) * n_)]);
    std::copy_n(from + last, n_, &last_blocks_[index((s * n_ + a) * n_)]);
    std::copy_n(from + scalars, scalars_, &scalar_blocks_[index((s * n_ + a) * scalars_)]);
  }
  const int length = 2 * n_ + scalars_;
  for (int r = 0; r < border_; ++r) {
    const double* from = block + (border_row + r) * width;
    double* to = &border_blocks_[index((s * border_ + r) * length)];
    std::copy_n(from + first, n_, to);
    std::copy_n(from + last, n_, to + n_);
    std::copy_n(from + scalars, scalars_, to + 2 * n_);
  }
}

/// The matrix that UMFPACK sees, in the order of make_sparse().
bool CondensedSystem::assemble(const Orbit& x, std::span<const OrbitVector> rows, OrbitResidual& residual) {
  const HybridSystem& hybrid = system_.system();
  const double* par = x.par.data();
  double* value = triplet_values_.data();
  double* end = residual.end.data();
  for (int s = 0; s < shape_.segments; ++s) {
    const double* scalars = &scalar_blocks_[index(s * n_ * scalars_)];
    for (int a = 0; a < n_; ++a) {
      value = std::copy_n(first_block(s) + a * n_, n_, value);
      value = std::copy_n(last_block(s) + a * n_, n_, value);
      *value++ = scalars[a * scalars_];
    }
    for (int a = 0; a < n_; ++a) value = std::copy_n(scalars + a * scalars_ + 1, globals_, value);

    const int conditions = system_.end_conditions(s);
    system_.end_derivatives(s, x.end(s), par, end, hx_.data(), hp_.data());
    end += conditions;
    for (int r = 0; r < conditions; ++r)
      for (int b = 0; b < n_; ++b) *value++ = hx_[index(b * conditions + r)];
    for (int r = 0; r < conditions; ++r)
      for (int g = 0; g < globals_; ++g) *value++ = hp_[index(g * conditions + r)];

    hybrid.first(FunctionKind::jump, system_.signature()[index(s)].jump, x.end(s), par, system_.free_parameters(),
                 f_.data(), fx_.data(), fp_.data());
    const double* next = x.start((s + 1) % shape_.segments);
    for (int a = 0; a < n_; ++a) residual.connection[index(s * n_ + a)] = next[a] - f_[index(a)];
    value = std::fill_n(value, n_, 1.0);
    for (int a = 0; a < n_; ++a)
      for (int b = 0; b < n_; ++b) *value++ = -fx_[index(b * n_ + a)];
    for (int a = 0; a < n_; ++a)
      for (int g = 0; g < globals_; ++g) *value++ = -fp_[index(g * n_ + a)];
  }
  const int length = 2 * n_ + scalars_;
  for (int r = 0; r < border_; ++r) {
    double* globals = value + shape_.segments * (2 * n_ + 1);
    std::copy_n(rows[index(r)].globals.data(), globals_, globals);
    for (int s = 0; s < shape_.segments; ++s) {
      const double* from = &border_blocks_[index((s * border_ + r) * length)];
      value = std::copy_n(from, 2 * n_ + 1, value);
      value[-1] += rows[index(r)].durations(s);
      for (int g = 0; g < globals_; ++g) globals[g] += from[2 * n_ + 1 + g];
    }
    value += globals_;
  }
  return residual.finite();
}

}  // namespace tchat
