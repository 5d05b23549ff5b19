/// Which colour a row of a sweep has.
///
/// Columns that tell things apart (attractor, kind, period, impacts, start) have a colour for each of their numbers;
/// every other quantity has a scale of colours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plot/figure.hpp"
#include "plot/sweep_columns.hpp"

namespace tchat {

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
