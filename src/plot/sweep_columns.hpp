/// What the axes and colours of a sweep show: its columns, and a colour for each row.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plot/figure.hpp"
#include "plot/label_text.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

// What axes and colours show of a sweep: columns of O.sweep, parameters that it does not sweep, and expressions of
// them.

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

// Which colour a row of a sweep has.
//
// Columns that tell things apart (attractor, kind, period, impacts, start) have a colour for each of their numbers;
// every other quantity has a scale of colours.

/// The colours of rows.
struct RowColours {
  std::vector<std::string> colours;  ///< #rrggbb, of categories; empty: a scale
  std::vector<LabelText> names;      ///< of each colour
  Palette palette;
  std::vector<double> numbers;  ///< in the palette, one for each of `rows`; NaN: no colour
};

struct ColourWish {
  std::string column;               ///< what read_sweep_quantity takes
  std::optional<double> low, high;  ///< of a scale
  LabelText label;                  ///< of a scale; empty: its own
};

/// The colours of these rows, the first of the first. Throws UserError for columns that are not there, and for a scale
/// without a finite number.
RowColours row_colours(const SweepTable& table, const std::string& path, const ColourWish& wish,
                       const std::vector<std::size_t>& rows);

/// "up", "down", "start 3".
std::string start_name(const SweepTable& table, int number);

/// Does the column tell things apart?
bool is_category(const SweepTable& table, const std::string& column);

}  // namespace tchat
