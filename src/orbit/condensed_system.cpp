#include "orbit/condensed_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numeric>

#include "base/levels.hpp"
#include "linear/frontal_lu.hpp"
#include "model/scales.hpp"
#include "orbit/collocation_rule.hpp"

namespace tchat {

namespace {

ArrayRange range_of(const std::vector<double>& values) {
  return array_functions().range(values.data(), static_cast<long>(values.size()));
}

int total_coupling_rows(const DefiningSystem& system) {
  int total = 0;
  for (int s = 0; s < system.segments(); ++s) total += system.coupling_rows(s);
  return total;
}

double dot(const EndVector& a, const EndVector& b) {
  return array_functions().dot(a.data(), b.data(), static_cast<long>(a.size()));
}

/// A closing row has a value of one on its null vector: the terms of that sum tell how much of it they take from each
/// other, whatever the units of the unknowns are.
bool is_pronounced(const EndVector& row, const EndVector& null_vector) {
  constexpr double most_cancelled = 1e3;  // digits that solutions may lose
  return std::transform_reduce(row.begin(), row.end(), null_vector.begin(), 0.0, std::plus<>(),
                               [](double a, double z) { return std::abs(a * z); }) < most_cancelled;
}

/// Entry by entry.
void divide(EndVector& v, const EndVector& units) {
  for (std::size_t k = 0; k < v.size(); ++k) v[k] /= units[k];
}

bool has_unit_length(const EndVector& v, const EndVector& units) {
  const double square = std::transform_reduce(v.begin(), v.end(), units.begin(), 0.0, std::plus<>(),
                                              [](double value, double unit) { return std::pow(value / unit, 2); });
  return std::abs(square - 1.0) < level::negligible;
}

bool are_finite(const std::vector<EndVector>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const EndVector& row) { return std::isfinite(dot(row, row)); });
}

/// Orthogonal to hardly anything, another one for each number.
void put_any_row(std::size_t number, EndVector& row) {
  for (std::size_t k = 0; k < row.size(); ++k)
    row[k] = std::cos(1.0 + (0.37 + 0.29 * static_cast<double>(number)) * static_cast<double>(k));
}

/// Gram and Schmidt, each row twice, as it may nearly depend on those before it; where it does to the last digit it
/// becomes any other row.
void make_orthonormal(std::vector<EndVector>& rows) {
  const auto add = [](double factor, const EndVector& from, EndVector& to) {
    array_functions().add(factor, from.data(), to.data(), static_cast<long>(to.size()));
  };
  const auto project = [&](std::size_t r) {
    for (std::size_t before = 0; before < r; ++before) add(-dot(rows[before], rows[r]), rows[before], rows[r]);
    return std::sqrt(dot(rows[r], rows[r]));
  };
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (int round = 0; round < 2; ++round) {
      double length = project(r);
      if (!(length > 0.0)) {
        put_any_row(r, rows[r]);
        length = project(r);
      }
      for (double& entry : rows[r]) entry /= length;
    }
}

std::vector<double> zeros(std::ptrdiff_t count) { return std::vector<double>(static_cast<std::size_t>(count), 0.0); }

/// `count` rows from `row` that are dense in some columns.
void put_dense(int row, int count, int column, int columns, std::vector<int>& row_list, std::vector<int>& column_list) {
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < columns; ++b) row_list.push_back(row + a), column_list.push_back(column + b);
}

/// Multiplications of the elimination of intervals, about: c n columns, of c n rows each, from rows of (c + 1) n.
double elimination_work(const OrbitShape& shape) {
  const double rows = static_cast<double>(shape.collocation) * shape.dimension;
  return rows * rows * rows / 2 * shape.intervals;
}

/// Whose work is shared by threads: that of segments where there are enough of them to keep all threads busy to the
/// end, else that of the pieces of each segment. None where threads would wait for one another longer than they work.
EliminationThreads sharing(const OrbitShape& shape, int threads) {
  // Within a segment joins wait for one another, and what one thread made goes to the cache of another one.
  constexpr double least_work = 1e6, least_within = 1e7;
  constexpr int segments_for_each = 4;
  const double of_segment = elimination_work(shape);
  if (shape.segments >= segments_for_each * threads && shape.segments * of_segment >= least_work) return {threads, 1};
  return of_segment >= least_within ? EliminationThreads{1, threads} : EliminationThreads{};
}

}  // namespace

double OrbitResidual::largest() const {
  return std::max({range_of(integral).largest, range_of(coupling).largest, of_collocation.largest});
}

bool OrbitResidual::finite() const {
  return of_collocation.finite && range_of(coupling).finite && range_of(integral).finite;
}

CondensedSystem::CondensedSystem(const DefiningSystem& system, const OrbitShape& shape, BorderRows border, int threads)
    : system_(system),
      shape_(shape),
      n_(shape.dimension),
      globals_(system.free_count()),
      scalars_(1 + globals_),
      border_(border.all()),
      closing_(border.closing),
      general_(border.general),
      rule_(shape.collocation),
      threads_(sharing(shape, threads)),
      segment_work_(threads_.segments),
      elimination_(shape, scalars_, general_, rule_, threads_),
      outcomes_(index(shape.segments)),
      lu_(make_sparse()) {
  assert((n_ + 1) * shape.segments + globals_ == total_coupling_rows(system) + border_);
  first_blocks_ = {shape.segments, n_ * n_};
  last_blocks_ = first_blocks_;
  scalar_blocks_ = {shape.segments, n_ * scalars_};
  border_blocks_ = {shape.segments, general_ * (2 * n_ + scalars_)};
  own_rhs_ = {shape.segments, n_ + general_};
  segment_rhs_ = own_rhs_;
  triplet_values_.resize(triplet_rows_.size());
  rhs_ = zeros(lu_.size());
  solution_ = rhs_;
  null_ends_.assign(index(std::max(closing_, 1)), rhs_);
  closing_rows_.assign(index(closing_), rhs_);
  end_units_.assign(rhs_.size(), 1.0);
  x_ = slope_ = zeros(n_);
}

SparseLu CondensedSystem::make_sparse() {
  const auto dense = [this](int row, int count, int column, int columns) {
    put_dense(row, count, column, columns, triplet_rows_, triplet_columns_);
  };
  std::vector<int> groups;
  int row = 0;
  for (int s = 0; s < shape_.segments; ++s) {
    dense(row, n_, start_unknown(s), 2 * n_ + 1);
    dense(row, n_, global_unknown(0), globals_);
    row += n_;
    CouplingPattern pattern(unknowns(), globals_, row, triplet_rows_, triplet_columns_);
    system_.coupling_pattern(s, pattern);
    row += system_.coupling_rows(s);
    groups.resize(index(row), s);
  }
  dense(row, border_, 0, global_unknown(globals_));
  row += border_;
  groups.resize(index(row), FrontalLu::border_row);
  return {row, triplet_rows_, triplet_columns_, groups};
}

OrbitResidual CondensedSystem::make_residual() const {
  OrbitResidual r = make_residual_of_ends();
  r.collocation = zeros(collocation_row(shape_.segments));
  return r;
}

OrbitResidual CondensedSystem::make_residual_of_ends() const {
  OrbitResidual r;
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
  residual.of_collocation = {0.0, true};
  for (int s = 0; s < shape_.segments; ++s) {
    const IndexVector& v = system_.signature()[index(s)];
    const double* const mesh = x.mesh_of(s);
    const double* const first = collocation;
    for (int j = 0; j < x.shape.intervals_of(s); ++j) {
      const double scale = (mesh[j + 1] - mesh[j]) * x.duration(s);
      for (int g = 0; g < shape_.collocation; ++g, collocation += n_) {
        with_dimension(n_, [&](auto n) { interpolate(n, x, s, j, g); });
        hybrid.value(FunctionKind::field, v.field, x_.data(), par, collocation);
        for (int a = 0; a < n_; ++a) collocation[a] = slope_[index(a)] - scale * collocation[a];
      }
    }
    widen(residual.of_collocation, array_functions().range(first, collocation - first));  // while it is in the cache
    system_.coupling_values(s, x, coupling);
    coupling += system_.coupling_rows(s);
  }
}

// ---- linearisation --------------------------------------------------------------------------------------------------

Linearization CondensedSystem::linearize(const Orbit& x, std::span<const EndVector> closing,
                                         std::span<const OrbitVector> general, OrbitResidual& residual) {
  const Linearization condensed = condense(x, general, residual);
  if (condensed != Linearization::ready) return condensed;
  choose_units(x);
  if (!assemble(x, general, residual)) return Linearization::not_finite;
  return factorize(closing) ? Linearization::ready : Linearization::singular;
}

/// Where a length of vectors is asked for, free parameters are taken in units of their sizes. So are durations that are
/// short, for a matrix in whose rows they outweigh all else would seem singular, and those of no ordinary size.
void CondensedSystem::choose_units(const Orbit& x) {
  const double time = time_size(system_, x);
  if (!has_usual_time_) has_usual_time_ = time >= 1.0 && is_ordinary(time);
  const double unit = *has_usual_time_ ? 1.0 : time;
  for (int s = 0; s < shape_.segments; ++s) end_units_[index(duration_unknown(s))] = unit;
  for (int g = 0; g < globals_; ++g) end_units_[index(global_unknown(g))] = parameter_size(system_, x, g);
}

Linearization CondensedSystem::condense(const Orbit& x, std::span<const OrbitVector> general, OrbitResidual& residual) {
  adopt(x.shape);
  residual.of_collocation = {0.0, false};
  const Linearization outcome =
      threads_.segments > 1 ? condense_together(x, general, residual) : condense_one_by_one(x, general, residual);
  if (outcome == Linearization::ready) residual.of_collocation = {elimination_.largest_residual(), true};
  return outcome;
}

/// Orbits of one branch have equally many intervals, which may be dealt out anew.
void CondensedSystem::adopt(const OrbitShape& shape) {
  if (shape.own == shape_.own) return;
  assert(shape.in_common() == shape_.in_common());
  shape_ = shape;
  elimination_.deal_out(shape);
}

/// What the segments and the border leave.
bool CondensedSystem::factorize(std::span<const EndVector> closing) {
  assert(static_cast<int>(closing.size()) == (closing_ == 1 ? 1 : 0));
  if (closing_ == 0) return lu_.factorize(triplet_values_);
  const bool known = closing_ == 1 && factorize_with(closing);
  closing_rows_gave_way_ = !known || !is_pronounced(closing.front(), null_ends_.front());
  return !closing_rows_gave_way_ || close_along_null_vectors(known);
}

/// A matrix that is singular with its closing row becomes known with others. Null vectors that are known to few digits
/// are known to more with closing rows along them.
bool CondensedSystem::close_along_null_vectors(bool known) {
  constexpr int most_rounds = 3;
  known = known && are_finite(null_ends_);
  for (int trial = 0; trial < most_rounds && !known; ++trial) {
    for (std::size_t r = 0; r < closing_rows_.size(); ++r) {
      put_any_row(r + static_cast<std::size_t>(trial) * closing_rows_.size(), closing_rows_[r]);
      divide(closing_rows_[r], end_units_);
    }
    known = factorize_with(closing_rows_) && are_finite(null_ends_);
  }
  if (!known) return false;
  for (int round = 0; round < most_rounds; ++round) {
    std::copy(null_ends_.begin(), null_ends_.end(), closing_rows_.begin());
    for (EndVector& row : closing_rows_) divide(row, end_units_);
    make_orthonormal(closing_rows_);
    for (EndVector& row : closing_rows_) divide(row, end_units_);
    if (!factorize_with(closing_rows_)) return false;
    const auto is_nearly_its_row = [&](const EndVector& z) { return has_unit_length(z, end_units_); };
    if (std::all_of(null_ends_.begin(), null_ends_.end(), is_nearly_its_row)) break;
  }
  return true;
}

/// With these closing rows, and the null vectors that belong to them.
bool CondensedSystem::factorize_with(std::span<const EndVector> closing) {
  auto place = triplet_values_.begin() + closing_place_;
  for (const EndVector& row : closing) place = std::copy(row.begin(), row.end(), place);
  if (!lu_.factorize(triplet_values_)) return false;
  find_null_vectors();
  return true;
}

/// Where the collocation residual of segment s goes, or null.
double* CondensedSystem::collocation_of(int s, OrbitResidual& residual) const {
  return residual.collocation.empty() ? nullptr : &residual.collocation[index(collocation_row(s))];
}

Linearization CondensedSystem::condense_one_by_one(const Orbit& x, std::span<const OrbitVector> general,
                                                   OrbitResidual& residual) {
  for (int s = 0; s < shape_.segments; ++s) {
    const Linearization outcome =
        elimination_.condense(s, system_.system(), system_.signature()[index(s)].field, system_.free_parameters(), x,
                              general, collocation_of(s, residual));
    if (outcome != Linearization::ready) return outcome;
    keep_segment_blocks(s);
  }
  return Linearization::ready;
}

/// The problem is asked by this thread, for one segment at a time, and they are condensed by any. What is told is
/// what the first one says that is not ready.
Linearization CondensedSystem::condense_together(const Orbit& x, std::span<const OrbitVector> general,
                                                 OrbitResidual& residual) {
  segment_work_.run(
      shape_.segments,
      [&](int s) {
        elimination_.evaluate(s, system_.system(), system_.signature()[index(s)].field, system_.free_parameters(), x);
      },
      [&](int s, int thread) {
        outcomes_[index(s)] = elimination_.condense_evaluated(s, x, general, collocation_of(s, residual), thread);
        if (outcomes_[index(s)] == Linearization::ready) keep_segment_blocks(s);
      });
  const auto first = std::find_if(outcomes_.begin(), outcomes_.end(),
                                  [](Linearization outcome) { return outcome != Linearization::ready; });
  return first == outcomes_.end() ? Linearization::ready : *first;
}

void CondensedSystem::keep_segment_blocks(int s) {
  const double* from = elimination_.rows(s);
  const int length = elimination_.length();
  for (int a = 0; a < n_; ++a, from += length) {
    std::copy_n(from, n_, first_blocks_[s] + a * n_);
    std::copy_n(from + n_, n_, last_blocks_[s] + a * n_);
    std::copy_n(from + 2 * n_, scalars_, scalar_blocks_[s] + a * scalars_);
    own_rhs_[s][a] = -from[2 * n_ + scalars_];
  }
  from = elimination_.border(s);
  for (int r = 0; r < general_; ++r, from += length) {
    std::copy_n(from, length - 1, border_blocks_[s] + r * (length - 1));
    own_rhs_[s][n_ + r] = -from[length - 1];
  }
}

/// The matrix that SparseLu sees, in the order of make_sparse(), but for closing rows.
bool CondensedSystem::assemble(const Orbit& x, std::span<const OrbitVector> general, OrbitResidual& residual) {
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
  closing_place_ = value - triplet_values_.data();  // what stands there is put by factorize_with()
  value += closing_ * lu_.size();
  for (int r = 0; r < general_; ++r) value = put_general_row(r, general[index(r)], value);
  return residual.finite();
}

/// Number r of the general rows, condensed; the weights of the scalars themselves were left out there.
double* CondensedSystem::put_general_row(int r, const OrbitVector& row, double* value) const {
  const int length = 2 * n_ + scalars_;
  double* globals = value + shape_.segments * (2 * n_ + 1);
  std::copy_n(row.globals.data(), globals_, globals);
  for (int s = 0; s < shape_.segments; ++s) {
    const double* from = border_blocks_[s] + r * length;
    value = std::copy_n(from, 2 * n_ + 1, value);
    value[-1] += row.durations(s);
    for (int g = 0; g < globals_; ++g) globals[g] += from[2 * n_ + 1 + g];
  }
  return value + globals_;
}

}  // namespace tchat
