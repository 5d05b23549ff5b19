#include "app/plot_arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/recorded_labels.hpp"
#include "files/simulation_files.hpp"
#include "plot/figure.hpp"
#include "plot/label_text.hpp"
#include "plot/orbit_figure.hpp"
#include "plot/underlay.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_directory(path, error);
}

bool is_label(const std::string& word) {
  return (parse_integer(word) && *parse_integer(word) >= 0) || parse_typed_label(word) || word == "all";
}

std::string beside(const std::string& word, char letter) {
  const fs::path path(word);
  return (path.parent_path() / (std::string(1, letter) + "." + path.filename().string())).string();
}

/// The file that a word names; "" when there is none.
std::string file_of(const std::string& word, bool label_follows) {
  if (is_file(word)) return word;
  const std::array<char, 3> letters = label_follows ? std::array{'q', 'p', 'd'} : std::array{'p', 'q', 'd'};
  for (const char letter : letters)
    if (is_file(beside(word, letter))) return beside(word, letter);
  for (const char* ending : {".trajectory", ".sweep"})
    if (is_file(word + ending)) return word + ending;
  return "";
}

PlotItem::Kind kind_of(const std::string& path) {
  if (looks_like_trajectory(path)) return PlotItem::Kind::trajectory;
  if (looks_like_sweep(path)) return PlotItem::Kind::sweep;
  const RunFileKind kind = run_file_kind(path);
  if (kind == RunFileKind::solutions) return PlotItem::Kind::solutions;
  const std::string name = fs::path(path).filename().string();
  if (name.find('.') != 1 && looks_like_data(path)) return PlotItem::Kind::data;  // p.NAME is meant to be a p-file
  return kind == RunFileKind::diagnostics ? PlotItem::Kind::diagnostics : PlotItem::Kind::points;
}

/// Why a word that is no file cannot mean anything else either.
std::string what_else(const std::string& word) {
  if (is_label(word)) return ", and labels come after the q-file that has them";
  const std::string name = fs::path(word).filename().string();
  if (name.size() > 2 && name[1] == '.') return " and no label";
  return fmt::format(" and no label, and there is no {} and no {}", beside(word, 'p'), beside(word, 'q'));
}

PlotArguments without_words(PlotArguments arguments) {
  arguments.words.clear();
  return arguments;
}

/// To each panel as many texts as it has words, to the last one all that are left.
void share_legend(std::vector<PlotArguments>& panels) {
  if (panels.size() == 1) return;
  std::vector<std::string> texts = panels.front().legend;
  for (PlotArguments& panel : panels) {
    const std::size_t count = &panel == &panels.back() ? texts.size() : std::min(panel.words.size(), texts.size());
    panel.legend.assign(texts.begin(), texts.begin() + static_cast<std::ptrdiff_t>(count));
    texts.erase(texts.begin(), texts.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

}  // namespace

std::vector<PlotArguments> panel_arguments(const PlotCommand& command) {
  std::vector<PlotArguments> panels(1, command.common);
  for (const std::string& word : command.panels) {
    if (word != panel_separator) {
      if (panels.size() == 1) panels.push_back(without_words(command.common));
      panels.back().words.push_back(word);
    } else if (!panels.back().words.empty()) {
      panels.push_back(without_words(command.common));
    }
  }
  if (panels.back().words.empty()) panels.pop_back();
  const auto share = [&panels](const std::vector<std::string>& texts, std::string PlotArguments::*where,
                               const char* option) {
    if (texts.size() > 1 && texts.size() != panels.size())
      throw UserError(fmt::format("{} is given {} times for {} panel{}; give it once, or once for each panel", option,
                                  texts.size(), panels.size(), panels.size() == 1 ? "" : "s"));
    for (std::size_t k = 0; k < panels.size() && !texts.empty(); ++k)
      panels[k].*where = texts[texts.size() == 1 ? 0 : k];
  };
  share(command.x, &PlotArguments::x, "-x");
  share(command.y, &PlotArguments::y, "-y");
  share(command.z, &PlotArguments::z, "-z");
  share(command.x_range, &PlotArguments::x_range, "--xrange");
  share(command.y_range, &PlotArguments::y_range, "--yrange");
  share(command.z_range, &PlotArguments::z_range, "--zrange");
  share(command.x_label, &PlotArguments::x_label, "--xlabel");
  share(command.y_label, &PlotArguments::y_label, "--ylabel");
  share(command.z_label, &PlotArguments::z_label, "--zlabel");
  share(command.dots, &PlotArguments::dots, "--dots");
  if (command.title.size() > 1 || panels.size() == 1) share(command.title, &PlotArguments::title, "--title");
  share_legend(panels);
  return panels;
}

std::vector<PlotItem> read_plot_items(const std::vector<std::string>& words) {
  std::vector<PlotItem> items;
  for (std::size_t k = 0; k < words.size(); ++k) {
    refuse_control_characters(words[k], "the file");
    const bool label_follows = k + 1 < words.size() && is_label(words[k + 1]) && !is_file(words[k + 1]);
    // After a q-file a label is a label, even where a file q.PD1 exists.
    const bool labels_possible = !items.empty() && items.back().kind == PlotItem::Kind::solutions;
    const std::string path = labels_possible && is_label(words[k]) ? "" : file_of(words[k], label_follows);
    if (path.ends_with(".events"))
      throw UserError(
          fmt::format("{} lists events, there is no picture of it; give the trajectory of the simulation", path));
    if (!path.empty()) {
      items.push_back({kind_of(path), path, {}});
    } else if (is_label(words[k]) && !items.empty()) {
      items.back().labels.push_back(words[k]);
    } else {
      throw UserError(
          fmt::format("{} is no file{}; give p-files (branches), or a q-file and its labels, as in tchat plot q.mems "
                      "GR1 PD1, or the trajectory of a simulation",
                      in_quotes(words[k]), what_else(words[k])));
    }
  }
  return items;
}

PlotRange read_plot_range(const std::string& text, const char* option) {
  PlotRange range;
  if (text.empty()) return range;
  const auto refuse = [&](const std::string& what) {
    throw UserError(fmt::format("{} {}: {}; a range is low:high, as in {} 0.5:2, and either end may be left out",
                                option, text, what, option));
  };
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) refuse("there is no colon");
  const auto end = [&](const std::string& part) -> std::optional<double> {
    if (part.empty() || part == "*") return std::nullopt;
    const auto value = parse_real(part);
    if (!value) refuse(fmt::format("{} is no number", in_quotes(part)));
    return value;
  };
  range.low = end(text.substr(0, colon));
  range.high = end(text.substr(colon + 1));
  if (range.low && range.high && !(*range.low < *range.high)) refuse("the first number must be the smaller one");
  return range;
}

std::optional<PlotView> read_plot_view(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto parts = split_at_commas(text);
  const auto tilt = parts.size() == 2 ? parse_real(parts[0]) : std::nullopt;
  const auto turn = parts.size() == 2 ? parse_real(parts[1]) : std::nullopt;
  if (!tilt || !turn || !(*tilt >= 0.0 && *tilt <= 180.0) || !(*turn >= 0.0 && *turn <= 360.0))
    throw UserError(
        fmt::format("--view {}: a view is a tilt from 0 to 180 and a turn from 0 to 360 degrees, as in "
                    "--view 65,35",
                    in_quotes(text)));
  return PlotView{*tilt, *turn};
}

PlotSize read_plot_size(const std::string& text) {
  if (text.empty()) return {};
  const std::size_t cross = text.find_first_of("xX");
  const auto pixels = [](const std::string& part) { return parse_integer(part).value_or(0); };
  const PlotSize size{pixels(text.substr(0, cross)), cross == std::string::npos ? 0 : pixels(text.substr(cross + 1))};
  if (std::min(size.width, size.height) < 100 || std::max(size.width, size.height) > 10000)
    throw UserError(fmt::format("--size {}: a size is width and height from 100 to 10000 pixels, as in --size 1200x900",
                                in_quotes(text)));
  return size;
}

LabelSelection read_label_selection(const PlotArguments& arguments) {
  LabelSelection selection;
  selection.numbers = arguments.numbers;
  selection.all = arguments.labels == "all";
  selection.defaults = arguments.labels.empty() && !arguments.no_labels;
  if (arguments.labels.empty() || arguments.no_labels || selection.all || arguments.labels == "none") return selection;
  const std::vector<std::string> known = all_point_types();
  for (std::string type : split_at_commas(arguments.labels)) {
    std::transform(type.begin(), type.end(), type.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    if (std::find(known.begin(), known.end(), type) == known.end())
      throw UserError(fmt::format("--labels {}: {} is no type of point; there are {}, or all, or none",
                                  arguments.labels, in_quotes(type), fmt::join(known, ", ")));
    selection.types.push_back(type);
  }
  return selection;
}

std::vector<std::string> split_at_commas(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size() && !text.empty();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

}  // namespace tchat
