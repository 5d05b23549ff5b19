/// What the user wrote after `tchat plot`, sorted: files with the labels that follow them, and options.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plot/branch_figure.hpp"

namespace tchat {

/// The options as they are written.
struct PlotArguments {
  std::vector<std::string> words;  ///< files and labels
  bool multipliers = false;
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
  std::string plugin;
  std::string surfaces;
  int dimension = 0;
  std::string size;
  std::string output;
  std::string script;
};

/// A file of a run and the labels named after it.
struct PlotItem {
  enum class Kind { points, solutions, diagnostics, trajectory, data };
  Kind kind = Kind::points;
  std::string path;
  std::vector<std::string> labels;
};

/// Words into files and labels. A word is a file when there is one of that name, or p.WORD or q.WORD (q.WORD when a
/// label follows), or WORD.trajectory; what kind of file is judged by its first line. Throws UserError for a word that
/// is neither.
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
