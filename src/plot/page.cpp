#include "plot/page.hpp"

#include <fmt/format.h>

#include <map>

#include "plot/page_figure.hpp"
#include "plot/page_files.hpp"
#include "plot/page_json.hpp"

namespace tchat {

namespace {

/// A text between tags.
std::string html_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else
      result += c;
  }
  return result;
}

std::string data_json(const SheetLayout& sheet, const PageContents& contents) {
  std::vector<std::string> figures, branches;
  std::map<std::string, std::size_t> places;  // by path: a file of several figures is written once
  for (std::size_t k = 0; k < sheet.figures.size(); ++k) {
    std::vector<std::size_t> places_in_figure;
    for (const BranchFile& file : contents.branches.at(k)) {
      const auto [place, is_new] = places.emplace(file.path, branches.size());
      if (is_new) branches.push_back(branch_json(file, contents.options));
      places_in_figure.push_back(place->second);
    }
    figures.push_back(figure_json(sheet.figures[k], places_in_figure));
  }
  return page_object({{"title", page_label(sheet.title)},
                      {"figures", page_list(figures)},
                      {"branches", page_list(branches)},
                      {"meanings", point_meanings_json()}});
}

/// Nothing may be loaded: what the page needs is in it.
constexpr const char* page_head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="tchat">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<link rel="icon" href="data:,">
)";

}  // namespace

std::string page_html(const SheetLayout& sheet, const PageContents& contents) {
  const LabelText& title = sheet.title.empty() ? sheet.figures.front().figure.title : sheet.title;
  std::string html = page_head;
  html += fmt::format("<title>{}</title>\n", html_text(title.empty() ? contents.name : title.text));
  html += fmt::format("<style>\n{}</style>\n</head>\n<body>\n{}", page_files.style, page_files.body);
  html += fmt::format("<script type=\"application/json\" id=\"data\">{}</script>\n", data_json(sheet, contents));
  html += fmt::format("<!--\n{}-->\n<script>{}</script>\n", page_files.library_licence, page_files.library);
  html += fmt::format("<script>\n(function () {{\n\"use strict\";\n{}}})();\n</script>\n</body>\n</html>\n",
                      page_files.script);
  return html;
}

}  // namespace tchat
