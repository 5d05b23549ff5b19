#include "plot/page.hpp"

#include <fmt/format.h>

#include <map>

#include "motion/growth_series.hpp"
#include "plot/page_figure.hpp"
#include "plot/page_files.hpp"

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

/// A file that several figures show is written once.
class WrittenFiles {
 public:
  /// The place of the file in the list. If it is new, make() writes its JSON.
  template <class File, class Make>
  std::size_t add(const File& file, const Make& make) {
    const auto [place, is_new] = places_.emplace(file.path, json_.size());
    if (is_new) json_.push_back(make());
    return place->second;
  }

  const std::vector<std::string>& json() const { return json_; }

 private:
  std::map<std::string, std::size_t> places_;  // by path
  std::vector<std::string> json_;
};

std::string data_json(const SheetLayout& sheet, const PageContents& contents) {
  std::vector<std::string> figures;
  WrittenFiles branches, sweeps;
  for (std::size_t k = 0; k < sheet.figures.size(); ++k) {
    FilePlaces places;
    for (const BranchFile& file : contents.files.at(k).branches)
      places.branches.push_back(branches.add(file, [&] { return branch_json(file, contents.options); }));
    for (const SweepFile& file : contents.files[k].sweeps)
      places.sweeps.push_back(sweeps.add(file, [&] { return sweep_json(file); }));
    figures.push_back(figure_json(sheet.figures[k], places));
  }
  return page_object({{"title", page_label(sheet.title)},
                      {"figures", page_list(figures)},
                      {"branches", page_list(branches.json())},
                      {"sweeps", page_list(sweeps.json())}});
}

/// Nothing may be loaded: what the page needs is in it.
constexpr const char* page_head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="tchat">
<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
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

namespace {

constexpr std::size_t most_sweep_numbers = 400'000;

}  // namespace

std::string sweep_json(const SweepFile& file) {
  const SweepTable& table = file.table;
  const bool is_written = table.rows() * (table.names.size() + 1) <= most_sweep_numbers;
  std::vector<std::string> names, columns;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    names.push_back(page_text(table.names[c]));
    if (is_written) columns.push_back(page_list(table.columns[c], [](double value) { return page_number(value); }));
  }
  names.push_back(page_text("kind"));
  if (is_written)
    columns.push_back(page_list(table.kinds, [](AttractorKind kind) { return page_text(to_string(kind)); }));
  const auto parameter = [](const std::pair<std::string, double>& one) {
    return page_list({page_text(one.first), page_number(one.second)});
  };
  return page_object({{"name", page_text(file.name)},
                      {"columns", page_list(names)},
                      {"values", is_written ? page_list(columns) : "null"},
                      {"fixed", page_list(table.parameters, parameter)}});
}

}  // namespace tchat
