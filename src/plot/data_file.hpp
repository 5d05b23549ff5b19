/// A user's own table of numbers, drawn as dots beneath branches: a brute-force diagram, measurements, another
/// program's results.
#pragma once

#include <string>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

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

}  // namespace tchat
