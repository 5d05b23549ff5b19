/// What is drawn beneath the branches of a diagram: tables of the user's own, and sweeps.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plot/figure.hpp"
#include "plot/sweep_columns.hpp"

namespace tchat {

// What lies beneath the branches of a diagram, or is a picture without any: what a sweep has found.

struct Underlay {
  std::optional<ColourField> field;
  std::optional<Palette> palette;
  std::vector<Cloud> clouds;
  std::vector<Curve> curves;  ///< error bars, and the line where an exponent is zero
  std::vector<KeyEntry> key;
  LabelText x, y;  ///< of the axes when there are no branches

  /// Puts another one on top. Throws UserError when both have a map, or both a palette.
  void add(Underlay other);
};

// A user's own table of numbers, drawn as dots beneath branches: a brute-force diagram, measurements, another
// program's results.

/// The first two columns. '#' begins a comment; the last one before the numbers names the columns when it has as many
/// words.
struct DataFile {
  std::string path;
  std::string name;  ///< of the file without folder and ending
  std::string x_name, y_name;
  std::vector<PicturePoint> points;
};

/// Judged by the first row: two or more numbers and nothing else, and no line of a p-file.
bool looks_like_data(const std::string& path);

/// Throws UserError with the line for what is no table of numbers, or has no rows.
DataFile read_data_file(const std::string& path);

// A sweep as dots over one quantity, or as a map in colours over two.

struct SweepFile {
  std::string path;
  std::string name;  ///< of the file without folder and ending
  SweepTable table;
};

/// By the first line.
bool looks_like_sweep(const std::string& path);

/// Throws UserError.
SweepFile read_sweep(const std::string& path);

/// What is shown of it, and how.
struct SweepLook {
  std::string x, y, z;                  ///< what read_sweep_quantity takes, y also a list a,b; empty: chosen here
  std::vector<SweepChoice> choices;     ///< --at
  std::optional<double> z_low, z_high;  ///< of a scale of colours
  LabelText z_label;
  bool grey = false;              ///< the same for all starts
  bool beneath_branches = false;  ///< pale
  std::size_t sweep = 0;          ///< its place among those of the picture
  std::size_t clouds_before = 0;  ///< in the same picture, which have other colours
};

/// The file's `over`: A map is drawn where x and y are its two swept quantities, each value a cell: -z says what its
/// colour means, the attractor's number when nothing is said. Everything else is dots: x is the first swept quantity
/// and y the first recorded state (or what else the file has), a dot a row; -z colours dots too. Without it sweeps up
/// and down have a colour each. Exponents have error bars, and a line at zero.
///
/// Throws UserError for columns that are not there, and when there is nothing to show.
Underlay sweep_layer(const SweepFile& file, const SweepLook& look, std::vector<std::string>& warnings);

/// What is along y when nothing is said, as the name of a column.
std::string default_sweep_y(const SweepTable& table, const std::string& x);

}  // namespace tchat
