/// What axes and colours show of a sweep: columns of O.sweep, parameters that it does not sweep, and expressions of
/// them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "plot/label_text.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

struct SweepQuantity {
  LabelText label;
  std::vector<double> values;  ///< one a row
  std::vector<double> errors;  ///< half lengths of error bars, one a row; empty: there are none
};

/// `wanted` is a column by its heading in any case (mu, x2, lambda1, penetration, `kind` as the number of the kind), a
/// parameter by its name, COLUMN@+K for that column K rows later (the same value and start; NaN behind the last one),
/// or an expression of these. Throws UserError, with `option`, for what is none of these.
SweepQuantity read_sweep_quantity(const SweepTable& table, const std::string& path, const std::string& wanted,
                                  const char* option);

/// The column of that name in any case, "" when there is none.
std::string sweep_column(const SweepTable& table, const std::string& wanted);

/// The swept quantity of that column; nullptr for other columns.
const SweptQuantity* swept_quantity(const SweepTable& table, const std::string& column);

/// The columns of states: all behind the scalars that `names` begins with.
std::vector<std::string> sweep_states(const SweepTable& table);

/// One `--at`: "mu=-0.8", "start=2".
struct SweepChoice {
  std::string column;
  double value = 0.0;
};
/// Throws UserError for what is not NAME=NUMBER.
SweepChoice read_sweep_choice(const std::string& text);

/// The rows that meet all choices: of a swept quantity those of the value nearest to the one asked for, which must lie
/// between the sweep's ends; of other columns those with that very number. All rows without choices. A nearest value
/// that is another number gives a warning. Throws UserError for columns that are not there and when no row is left.
std::vector<std::size_t> chosen_rows(const SweepTable& table, const std::string& path,
                                     const std::vector<SweepChoice>& choices, std::vector<std::string>& warnings);

}  // namespace tchat
