#include "linear/frontal_lu.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

#include "linear/partial_lu.hpp"

namespace tchat {

namespace {

std::size_t at(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

/// Blocks that hold more than this times the entries of the matrix do not pay.
constexpr std::ptrdiff_t most_blown_up = 5;

/// What stands for y number k among the columns of the last front, and the number again.
int place_of_y(int k) { return -1 - k; }

}  // namespace

/// Which rows and columns go into which front.
class FrontalLu::Plan {
 public:
  /// `with_long_rows`: are long ones written with y?
  Plan(int size, std::span<const int> rows, std::span<const int> columns, std::span<const int> groups,
       bool with_long_rows)
      : size_(size),
        rows_(rows),
        columns_(columns),
        groups_(groups),
        first_(at(size), std::numeric_limits<int>::max()),
        last_(at(size), -1),
        eliminated_(at(size), false),
        number_of_y_(at(size), -1),
        entries_of_rows_(at(size)),
        border_entries_(at(size)) {
    for (std::size_t k = 0; k < rows.size(); ++k) {
      entries_of_rows_[at(rows[k])].push_back(static_cast<int>(k));
      if (groups[at(rows[k])] == border_row) border_entries_[at(columns[k])].push_back(static_cast<int>(k));
    }
    for (int row = 0; row < size; ++row) {
      if (groups[at(row)] == border_row) {
        border_.push_back(row);
      } else {
        rows_of_groups_.resize(std::max(rows_of_groups_.size(), at(groups[at(row)]) + 1));
        rows_of_groups_[at(groups[at(row)])].push_back(row);
      }
    }
    if (with_long_rows) choose_long_rows();
    for (int row = 0; row < size; ++row)
      for (const int k : entries_of_rows_[at(row)])
        if (groups[at(row)] != border_row) extend(columns[at(k)], groups[at(row)]);
    for (const std::vector<int>& far : far_)
      for (const int k : far) first_[at(columns[at(k)])] = kept;
  }

  int groups() const { return static_cast<int>(rows_of_groups_.size()); }
  bool has_long_rows() const { return !far_.empty(); }
  /// Then the fronts are of no use.
  bool blown_up() const { return area_ > most_blown_up * std::ssize(rows_); }

  /// Fronts of these groups, the last one of all of them; the numbers of those that leave rows. Where nothing would be
  /// eliminated no front is made.
  std::vector<int> add(int first, int last, std::vector<Front>& fronts) {
    Front front;
    std::vector<int> children;
    if (last - first == 1) {
      front.own_rows = rows_of_groups_[at(first)];
    } else {
      const int middle = first + (last - first) / 2;
      children = add(first, middle, fronts);
      const std::vector<int> others = add(middle, last, fronts);
      children.insert(children.end(), others.begin(), others.end());
      for (const int child : children) front.children.push_back({child, {}});
    }
    const bool whole = first == 0 && last == groups();
    if (whole) front.own_rows.insert(front.own_rows.end(), border_.begin(), border_.end());
    choose_columns(first, last, whole, front, fronts);
    if (front.pivots == 0 && front.own_rows.empty()) return children;
    choose_places(whole, front, fronts);
    fronts.push_back(std::move(front));
    return {static_cast<int>(fronts.size()) - 1};
  }

  /// The far entries at their columns of the last front.
  std::vector<LongRow> long_rows(const Front& last) const {
    std::vector<LongRow> result;
    std::ptrdiff_t first = 0;
    for (const std::vector<int>& far : far_) {
      result.push_back({rows_[at(far.front())], first, {}});
      for (const int k : far) result.back().far.push_back({k, place(last, columns_[at(k)])});
      first += std::ssize(far);
    }
    return result;
  }

 private:
  static constexpr int kept = -1;  // column that no front but the last one eliminates

  void extend(int column, int group) {
    first_[at(column)] = std::min(first_[at(column)], group);
    last_[at(column)] = std::max(last_[at(column)], group);
  }

  /// Long rows have more than twice the usual number of entries; those in columns that many groups share are far.
  void choose_long_rows() {
    constexpr int most_neighbours = 4, long_from = 2;
    std::vector<int> touching(at(size_), 0), last_seen(at(size_), -1);
    std::vector<std::size_t> lengths;
    for (int group = 0; group < groups(); ++group)
      for (const int row : rows_of_groups_[at(group)]) {
        lengths.push_back(entries_of_rows_[at(row)].size());
        for (const int k : entries_of_rows_[at(row)])
          if (std::exchange(last_seen[at(columns_[at(k)])], group) != group) ++touching[at(columns_[at(k)])];
      }
    const auto median = lengths.begin() + std::ssize(lengths) / 2;
    std::nth_element(lengths.begin(), median, lengths.end());
    const std::size_t usual = *median;
    for (const std::vector<int>& rows : rows_of_groups_)
      for (const int row : rows) {
        std::vector<int>& entries = entries_of_rows_[at(row)];
        if (entries.size() <= long_from * usual) continue;
        const auto far = std::stable_partition(entries.begin(), entries.end(),
                                               [&](int k) { return touching[at(columns_[at(k)])] <= most_neighbours; });
        if (far == entries.end()) continue;
        number_of_y_[at(row)] = static_cast<int>(far_.size());
        far_.emplace_back(far, entries.end());
        entries.erase(far, entries.end());
      }
  }

  void choose_columns(int first, int last, bool whole, Front& front, const std::vector<Front>& fronts) {
    std::vector<int> all;
    for (const Child& child : front.children) {
      const Front& from = fronts[at(child.front)];
      all.insert(all.end(), from.columns.begin() + from.pivots, from.columns.end());
      front.rows += from.left();
    }
    for (const int row : front.own_rows) {
      for (const int k : entries_of_rows_[at(row)])
        if (!eliminated_[at(columns_[at(k)])]) all.push_back(columns_[at(k)]);
      if (number_of_y_[at(row)] >= 0) all.push_back(size_ + number_of_y_[at(row)]);
    }
    front.rows += static_cast<int>(front.own_rows.size());
    front.border = whole ? 0 : static_cast<int>(border_.size());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    if (whole) all.erase(std::lower_bound(all.begin(), all.end(), size_), all.end());
    const auto others = std::stable_partition(all.begin(), all.end(), [&](int column) {
      return whole || (column < size_ && first_[at(column)] >= first && last_[at(column)] < last);
    });
    front.pivots = static_cast<int>(others - all.begin());
    front.columns = all;
    front.width = static_cast<int>(all.size());
  }

  /// Of what the children leave, and of entries. The last front of long rows is dense whatever is done.
  void choose_places(bool whole, Front& front, const std::vector<Front>& fronts) {
    if (!whole || !has_long_rows()) area_ += std::ptrdiff_t{front.rows + front.border} * front.width;
    if (blown_up()) return;
    for (Child& child : front.children) {
      const Front& from = fronts[at(child.front)];
      for (auto column = from.columns.begin() + from.pivots; column != from.columns.end(); ++column)
        child.columns.push_back(whole && *column >= size_ ? place_of_y(*column - size_) : place(front, *column));
    }
    choose_entries(whole, front);
    for (int k = 0; k < front.pivots; ++k) eliminated_[at(front.columns[at(k)])] = true;
  }

  /// Own rows have all of their entries here that are not in fronts before; border rows those of the columns that are
  /// eliminated here.
  void choose_entries(bool whole, Front& front) const {
    int number = front.rows - static_cast<int>(front.own_rows.size());
    for (const int row : front.own_rows) {
      for (const int k : entries_of_rows_[at(row)])
        if (const int column = columns_[at(k)]; !eliminated_[at(column)])
          front.entries.push_back({k, number * front.width + place(front, column)});
      if (const int y = number_of_y_[at(row)]; y >= 0)
        front.entries.push_back({one, number * front.width + place(front, size_ + y)});
      ++number;
    }
    if (whole) return;
    for (int j = 0; j < front.pivots; ++j)
      for (const int k : border_entries_[at(front.columns[at(j)])]) {
        const auto row = std::lower_bound(border_.begin(), border_.end(), rows_[at(k)]) - border_.begin();
        front.entries.push_back({k, (number + static_cast<int>(row)) * front.width + j});
      }
  }

  /// Of a column in the block; its width where it is not there.
  static int place(const Front& front, int column) {
    const auto begin = front.columns.begin(), others = begin + front.pivots, end = front.columns.end();
    auto found = std::lower_bound(begin, others, column);  // both parts are sorted
    if (found == others || *found != column) found = std::lower_bound(others, end, column);
    return found != end && *found == column ? static_cast<int>(found - begin) : front.width;
  }

  int size_;
  std::span<const int> rows_, columns_, groups_;
  std::vector<int> first_, last_;      // groups with entries in a column
  std::vector<bool> eliminated_;       // columns
  std::ptrdiff_t area_ = 0;            // of the blocks so far
  std::vector<int> border_;            // rows
  std::vector<int> number_of_y_;       // of rows, -1: not a long one
  std::vector<std::vector<int>> far_;  // entries of long rows
  std::vector<std::vector<int>> rows_of_groups_, entries_of_rows_;
  std::vector<std::vector<int>> border_entries_;  // of columns: a search of the rows for each group would be quadratic
};

std::optional<FrontalLu> FrontalLu::make(int size, std::span<const int> rows, std::span<const int> columns,
                                         std::span<const int> groups) {
  Plan plan(size, rows, columns, groups, false);
  if (plan.groups() == 0) return std::nullopt;
  if (std::optional<FrontalLu> lu = make_with(plan, size, rows)) return lu;
  Plan of_long_rows(size, rows, columns, groups, true);
  return of_long_rows.has_long_rows() ? make_with(of_long_rows, size, rows) : std::nullopt;
}

std::optional<FrontalLu> FrontalLu::make_with(Plan& plan, int size, std::span<const int> rows) {
  FrontalLu lu;
  lu.size_ = size;
  plan.add(0, plan.groups(), lu.fronts_);
  if (plan.blown_up()) return std::nullopt;
  std::ptrdiff_t block = 0, right = 0, swaps = 0;
  int widest = 0;
  for (Front& front : lu.fronts_) {
    if (front.pivots > front.rows) return std::nullopt;
    front.block = std::exchange(block, block + std::ptrdiff_t{front.rows + front.border} * front.width);
    front.right = std::exchange(right, right + front.rows + front.border);
    front.swaps = std::exchange(swaps, swaps + front.pivots);
    widest = std::max(widest, front.width);
  }
  const Front& last = lu.fronts_.back();
  if (swaps != size || last.rows != last.pivots) return std::nullopt;
  lu.long_rows_ = plan.long_rows(last);
  if (plan.has_long_rows()) lu.last_.emplace(last.width);
  lu.entry_rows_.assign(rows.begin(), rows.end());
  lu.scales_.resize(at(size));
  lu.blocks_.resize(at(block));
  lu.rights_.resize(at(right));
  lu.swaps_.resize(at(swaps));
  lu.parity_without_exchanges_ = lu.find_parity_without_exchanges();
  lu.local_.resize(at(widest));
  lu.column_sizes_.resize(at(widest));
  lu.known_.resize(at(size + std::ssize(lu.long_rows_)));
  return lu;
}

bool FrontalLu::factorize(std::span<const double> values) {
  std::fill(scales_.begin(), scales_.end(), 0.0);
  for (std::size_t k = 0; k < values.size(); ++k) scales_[at(entry_rows_[k])] += std::abs(values[k]);
  for (double& scale : scales_) {
    if (!(scale > 0.0) || !std::isfinite(scale)) return false;
    scale = 1.0 / scale;
  }
  far_values_.clear();
  for (const LongRow& row : long_rows_)
    for (const Entry& entry : row.far) far_values_.push_back(values[at(entry.value)] * scales_[at(row.row)]);
  for (std::size_t k = 0; k < fronts_.size(); ++k) {
    const Front& front = fronts_[k];
    fetch_front(k + 1);
    double* block = blocks_.data() + front.block;
    std::fill_n(block, std::ptrdiff_t{front.rows + front.border} * front.width, 0.0);
    for (const Entry& entry : front.entries)
      block[entry.place] +=
          entry.value == one ? 1.0 : values[at(entry.value)] * scales_[at(entry_rows_[at(entry.value)])];
    put_children(front, block);
    if (!eliminate_pivots(front, block)) return false;
  }
  return true;
}

/// Prefetches block, columns and entries of a front. Does nothing if there is no front of this number.
void FrontalLu::fetch_front(std::size_t number) const {
  if (number >= fronts_.size()) return;
  const Front& front = fronts_[number];
  fetch_ahead(blocks_.data() + front.block, std::ptrdiff_t{front.rows + front.border} * front.width);
  fetch_ahead(front.columns.data(), std::ssize(front.columns));
  fetch_ahead(front.entries.data(), std::ssize(front.entries));
}

bool FrontalLu::eliminate_pivots(const Front& front, double* block) {
  constexpr double nearly_dependent = 1e-9;  // what is left of a column: the digits of its pivot that rounding spares
  const bool last = &front == &fronts_.back();
  if (last && last_) return last_->factorize(block);
  if (!last)
    for (int j = 0; j < front.pivots; ++j) {
      double& size = column_sizes_[at(j)] = 0.0;
      for (int i = 0; i < front.rows + front.border; ++i) size = std::max(size, std::abs(block[i * front.width + j]));
    }
  if (!eliminate(DynamicSizes{front.rows, front.pivots, front.width}, block, front.border, swaps_.data() + front.swaps))
    return false;
  if (!last)
    for (int j = 0; j < front.pivots; ++j)
      if (std::abs(block[j * front.width + j]) * nearly_dependent * column_sizes_[at(j)] > 1.0) return false;
  return true;
}

/// What the children have left of their rows, and of the border rows. In the last front the latter are own rows.
void FrontalLu::put_children(const Front& front, double* block) const {
  int row = 0;
  for (const Child& child : front.children) {
    const Front& from = fronts_[at(child.front)];
    const double* left = blocks_.data() + from.block + std::ptrdiff_t{from.pivots} * from.width + from.pivots;
    const auto add_row = [&](int to) {
      double* target = block + std::ptrdiff_t{to} * front.width;
      for (std::size_t j = 0; j < child.columns.size(); ++j)
        if (child.columns[j] >= 0)
          target[child.columns[j]] += left[j];
        else if (left[j] != 0.0)
          add_far(left[j], long_rows_[at(place_of_y(child.columns[j]))], target);
      left += from.width;
    };
    for (int i = 0; i < from.left(); ++i) add_row(row++);
    for (int r = 0; r < from.border; ++r) add_row(front.rows + front.border - from.border + r);
  }
}

/// `factor` times y of a long row to a row of the last front.
void FrontalLu::add_far(double factor, const LongRow& row, double* target) const {
  const double* value = far_values_.data() + row.first;
  for (const Entry& entry : row.far) target[entry.place] += factor * *value++;
}

/// y of the long rows from the unknowns of the last front.
void FrontalLu::find_far_sums(const double* x) {
  double* y = known_.data() + size_;
  for (const LongRow& row : long_rows_) {
    const double* value = far_values_.data() + row.first;
    double sum = 0.0;
    for (const Entry& entry : row.far) sum += *value++ * x[entry.place];
    *y++ = sum;
  }
}

/// The right-hand side of a front's rows from b and what the children have left.
void FrontalLu::gather_right(const Front& front, const double* b, double* right) const {
  double* own = right;
  std::fill_n(right, front.rows + front.border, 0.0);
  for (const Child& child : front.children) {
    const Front& from = fronts_[at(child.front)];
    const double* left = rights_.data() + from.right + from.pivots;
    own = std::copy_n(left, from.left(), own);
    for (int r = 0; r < from.border; ++r) right[front.rows + front.border - from.border + r] += left[from.left() + r];
  }
  for (const int row : front.own_rows) *own++ += b[row] * scales_[at(row)];
}

void FrontalLu::solve(const double* b, double* x) {
  for (std::size_t k = 0; k < fronts_.size(); ++k) {
    const Front& front = fronts_[k];
    fetch_front(k + 1);
    double* right = rights_.data() + front.right;
    gather_right(front, b, right);
    if (&front == &fronts_.back() && last_) break;
    forward(DynamicSizes{front.rows, front.pivots, front.width}, blocks_.data() + front.block, front.border,
            swaps_.data() + front.swaps, right);
  }
  if (last_) solve_last(x);
  for (std::size_t k = fronts_.size() - (last_ ? 1 : 0); k-- > 0;) {
    const Front& front = fronts_[k];
    fetch_front(k - 1);  // at 0 there is no such front
    for (int j = front.pivots; j < front.width; ++j) {
      const int column = front.columns[at(j)];
      local_[at(j)] = column < size_ ? x[column] : known_[at(column)];
    }
    backward(DynamicSizes{front.rows, front.pivots, front.width}, blocks_.data() + front.block,
             rights_.data() + front.right, local_.data());
    for (int j = 0; j < front.pivots; ++j) x[front.columns[at(j)]] = local_[at(j)];
  }
}

/// As a large matrix; its right-hand side is there.
void FrontalLu::solve_last(double* x) {
  const Front& front = fronts_.back();
  double* solution = rights_.data() + front.right;
  last_->solve(solution);
  for (int j = 0; j < front.width; ++j) x[front.columns[at(j)]] = solution[j];
  find_far_sums(solution);
}

/// P S = L U, where S are the scaled rows: S^T x = U^T L^T P x.
void FrontalLu::solve_transposed(const double* b, double* x) {
  std::fill(std::copy_n(b, size_, known_.begin()), known_.end(), 0.0);
  for (const Front& front : fronts_) {
    double* w = rights_.data() + front.right;
    const double* row = blocks_.data() + front.block;
    for (int k = 0; k < front.pivots; ++k) w[k] = known_[at(front.columns[at(k)])];
    if (&front == &fronts_.back() && last_) break;
    for (int k = 0; k < front.pivots; ++k, row += front.width) {
      const double value = w[k] *= row[k];
      for (int j = k + 1; j < front.pivots; ++j) w[j] -= row[j] * value;
      for (int j = front.pivots; j < front.width; ++j) known_[at(front.columns[at(j)])] -= row[j] * value;
    }
  }
  if (last_) {
    double* w = rights_.data() + fronts_.back().right;
    for (std::size_t y = 0; y < long_rows_.size(); ++y) add_far(known_[at(size_) + y], long_rows_[y], w);
    last_->solve_transposed(w);
  }
  for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) {
    double* weights = rights_.data() + front->right;
    if (front != fronts_.rbegin() || !last_)
      forward_transposed(DynamicSizes{front->rows + front->border, front->pivots, front->width},
                         blocks_.data() + front->block, swaps_.data() + front->swaps, weights);
    scatter_weights(*front, weights, x);
  }
}

/// The weights of a front's rows to those that the children left, and to x.
void FrontalLu::scatter_weights(const Front& front, const double* weights, double* x) {
  const double* own = weights;
  for (const Child& child : front.children) {
    const Front& to = fronts_[at(child.front)];
    double* left = rights_.data() + to.right + to.pivots;
    std::copy_n(own, to.left(), left);
    std::copy_n(weights + front.rows + front.border - to.border, to.border, left + to.left());
    own += to.left();
  }
  for (const int row : front.own_rows) x[row] = *own++ * scales_[at(row)];
}

std::pair<int, double> FrontalLu::determinant() const {
  auto [sign, log2_size] = last_ ? last_->determinant() : std::pair{1, 0.0};
  sign *= parity();
  for (const Front& front : by_swaps())
    for (int k = 0; k < front.pivots; ++k) {
      const double reciprocal = blocks_[at(front.block + std::ptrdiff_t{k} * front.width + k)];
      if (reciprocal < 0.0) sign = -sign;
      log2_size -= std::log2(std::abs(reciprocal));
    }
  for (const double scale : scales_) log2_size -= std::log2(scale);
  return {sign, log2_size};
}

/// Every exchange of rows swaps two of them in the order in which they are chosen.
int FrontalLu::parity() const {
  int sign = parity_without_exchanges_;
  for (const Front& front : by_swaps())
    for (int k = 0; k < front.pivots; ++k) sign = swaps_[at(front.swaps + k)] == k ? sign : -sign;
  return sign;
}

/// That of the order in which columns are eliminated, times that of the rows where each front takes its first ones.
int FrontalLu::find_parity_without_exchanges() const {
  std::vector<int> columns, chosen;
  std::vector<std::vector<int>> left(fronts_.size());
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    const Front& front = fronts_[f];
    std::vector<int> rows;
    for (const Child& child : front.children)
      rows.insert(rows.end(), left[at(child.front)].begin(), left[at(child.front)].end());
    rows.insert(rows.end(), front.own_rows.begin(), front.own_rows.end());
    columns.insert(columns.end(), front.columns.begin(), front.columns.begin() + front.pivots);
    chosen.insert(chosen.end(), rows.begin(), rows.begin() + front.pivots);
    left[f].assign(rows.begin() + front.pivots, rows.end());
  }
  return permutation_parity(std::move(columns)) * permutation_parity(std::move(chosen));
}

}  // namespace tchat
