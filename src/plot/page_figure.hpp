/// Figures as JSON for the script of a page.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plot/label_text.hpp"
#include "plot/picture_sheet.hpp"

namespace tchat {

// JSON for pages: compact, and safe inside a <script> element.

/// A quoted string. '<', '>' and '&' become escapes, so that no text of a file can close the element; bytes that are
/// no UTF-8 become U+FFFD, and control characters blanks.
std::string page_text(std::string_view text);

/// A text of the picture: {"t": text}, with "m": 1 where it is markup.
std::string page_label(const LabelText& text);

/// The number with the digits from which it is read back exactly; null when it is not finite or stands for infinity.
std::string page_number(double value);

/// The number to `digits` significant digits; null likewise.
std::string page_number(double value, int digits);

/// [a,b,...] of JSON values.
std::string page_list(const std::vector<std::string>& values);

/// {"name":value,...} of JSON values.
std::string page_object(std::initializer_list<std::pair<std::string_view, std::string>> members);

/// [a,b,...] with the JSON value that `make` returns for each element.
template <class List, class Make>
std::string page_list(const List& list, const Make& make) {
  std::vector<std::string> values;
  for (const auto& element : list) values.push_back(make(element));
  return page_list(values);
}

// A figure with its layout as JSON, for the script of a page, which draws it in a window of any size.

/// Places of the figure's files in the page's lists of branches and sweeps.
struct FilePlaces {
  std::vector<std::size_t> branches, sweeps;
};

/// Texts, key, palette and panels. Throws UserError for a figure in space.
std::string figure_json(const PlacedFigure& placed, const FilePlaces& places);

}  // namespace tchat
