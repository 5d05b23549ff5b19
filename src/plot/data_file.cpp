#include "plot/data_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "base/number.hpp"
#include "base/text_file.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "files/point_file_reader.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr std::size_t least_of_point_file = 5;  // a header line of limits, or BR PT TY LAB and one value

bool is_row(const std::string& line) {
  const auto words = split_words(line);
  if (words.size() < 2 || (words.size() >= least_of_point_file && looks_like_point_file(line))) return false;
  return std::all_of(words.begin(), words.end(), [](std::string_view word) { return parse_real(word).has_value(); });
}

bool is_comment(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  return first == std::string::npos || line[first] == '#';
}

}  // namespace

bool looks_like_data(const std::string& path) {
  TextLines file(path, "something to draw");
  for (std::string line; file.next(line);)
    if (!is_comment(line)) return is_row(line);
  return false;
}

DataFile read_data_file(const std::string& path) {
  std::istringstream in(read_text_file(path, "a table of numbers", "two columns are drawn as dots"));
  DataFile data;
  data.path = path;
  data.name = std::filesystem::path(path).stem().string();
  std::string heading;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (is_comment(line)) {
      if (data.points.empty() && line.find('#') != std::string::npos) heading = line.substr(line.find('#') + 1);
      continue;
    }
    const auto words = split_words(line);
    const auto x = words.size() < 2 ? std::nullopt : parse_real(words[0]);
    const auto y = words.size() < 2 ? std::nullopt : parse_real(words[1]);
    if (!x || !y)
      throw UserError(fmt::format("{}:{}: found '{}', expected two numbers or more; the first two columns are drawn",
                                  path, number, line));
    if (const auto names = split_words(heading); data.points.empty() && names.size() == words.size())
      data.x_name = names[0], data.y_name = names[1];
    data.points.push_back({*x, *y});
  }
  if (data.points.empty()) throw UserError(fmt::format("{}: there are no numbers in it", path));
  return data;
}

}  // namespace tchat
