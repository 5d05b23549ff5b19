/// What the user wrote after `tchat plot`, sorted: files with the labels that follow them, and options.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plot/branch_figure.hpp"

namespace tchat {

/// The options of one panel as they are written.
struct PlotArguments {
  std::vector<std::string> words;  ///< files and labels
  bool multipliers = false;
  bool section = false;
  bool time = false;
  bool one_panel = false;
  std::string x;
  std::string y;
  std::string z;
  std::string view;
  std::string x_range, y_range, z_range;
  bool log_x = false, log_y = false;
  std::string title, x_label, y_label, z_label;
  std::vector<std::string> legend;
  std::string labels;
  bool no_labels = false;
  bool numbers = false;
  bool black = false;  ///< branches
  bool grey = false;   ///< dots of sweeps
  std::string plugin;
  std::string surfaces;
  int dimension = 0;
  std::vector<std::string> at;  ///< choices of values of a sweep
  std::string dots;             ///< along y for sweeps, where it is not `y`
};

/// What stands between the panels in the list of words.
inline constexpr const char* panel_separator = "";

/// The whole command. What is a list here holds one text for all panels, or one for each.
struct PlotCommand {
  PlotArguments common;
  std::vector<std::string> panels;  ///< words of further panels, a separator between them
  std::vector<std::string> x, y, z, x_range, y_range, z_range, title, x_label, y_label, z_label, dots;
  bool same_ranges = false;
  std::string size;
  std::string output;
  std::string script;
};

/// The arguments of each panel, one at least. Texts of the key go to the panels by their files, in order; a single
/// title of several panels belongs to none of them. Throws UserError for options that are there neither once nor once
/// for each panel.
std::vector<PlotArguments> panel_arguments(const PlotCommand& command);

/// A file of a run and the labels named after it.
struct PlotItem {
  enum class Kind { points, solutions, diagnostics, trajectory, data, sweep };
  Kind kind = Kind::points;
  std::string path;
  std::vector<std::string> labels;
};

/// Words into files and labels. A word is a file when there is one of that name, or p.WORD or q.WORD (q.WORD when a
/// label follows), or WORD.trajectory, or WORD.sweep; what kind of file is judged by its first line. Throws UserError
/// for a word that is neither.
std::vector<PlotItem> read_plot_items(const std::vector<std::string>& words);

/// "0.5:2", "0.5:", ":2"; an end left out or a star is chosen from the data.
struct PlotRange {
  std::optional<double> low, high;
};
PlotRange read_plot_range(const std::string& text, const char* option);

/// "65,35"; nothing when the text is empty. Throws UserError.
struct PlotView {
  double tilt = 0.0, turn = 0.0;  ///< degrees, 0 to 180 and 0 to 360
};
std::optional<PlotView> read_plot_view(const std::string& text);

struct PlotSize {
  int width = 0, height = 0;
};
/// "1200x900". Throws UserError beyond 100 .. 10000 pixels.
PlotSize read_plot_size(const std::string& text);

/// "LP,PD", "all", "none"; empty: the default.
LabelSelection read_label_selection(const PlotArguments& arguments);

/// "a,b" -> {"a", "b"}
std::vector<std::string> split_at_commas(const std::string& text);

}  // namespace tchat
