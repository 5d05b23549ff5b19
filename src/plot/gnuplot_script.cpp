#include "plot/gnuplot_script.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "plot/picture_styles.hpp"

namespace tchat {

namespace {

std::string quoted(const LabelText& text) {
  return gnuplot_quoted(text.text) + (text.markup ? " enhanced" : " noenhanced");
}

/// The name of a file as gnuplot takes it: one that begins with | would be a command, with ~ a home folder.
std::string file_name(const std::string& path) { return path.find_first_of("|~") == 0 ? "./" + path : path; }

/// `scale`: of the lengths, 1 for the usual ones.
std::string dash_pattern(Dash dash, double scale) {
  switch (dash) {
    case Dash::solid:
      return "solid";
    case Dash::dashed:
      return fmt::format("({:.3g},{:.3g})", 14.0 * scale, 8.0 * scale);
    default:
      return fmt::format("({:.3g},{:.3g})", 3.0 * scale, 5.0 * scale);
  }
}

/// gnuplot's number of a filled symbol, of the open one beneath it.
int point_type(Symbol symbol, bool filled) {
  const int open = [symbol] {
    switch (symbol) {
      case Symbol::square:
        return 4;
      case Symbol::triangle:
        return 8;
      case Symbol::reversed_triangle:
        return 10;
      case Symbol::diamond:
        return 12;
      case Symbol::pentagon:
        return 14;
      default:
        return 6;
    }
  }();
  return filled || symbol == Symbol::dot ? open + 1 : open;
}

/// Triangles and diamonds look smaller than squares and circles of the same nominal size.
double shape_factor(Symbol symbol) {
  switch (symbol) {
    case Symbol::triangle:
    case Symbol::reversed_triangle:
    case Symbol::diamond:
      return 1.2;
    case Symbol::dot:
      return 0.5;
    default:
      return 1.0;
  }
}

class ScriptWriter {
 public:
  ScriptWriter(const Figure& figure, const FigureLayout& layout, const PictureTarget& target)
      : figure_(figure),
        layout_(layout),
        target_(target),
        units_(terminal_units(target.format, figure.width, layout.font)) {}

  std::string write() {
    head();
    for (std::size_t k = 0; k < figure_.panels.size(); ++k) data(figure_.panels[k], k);
    texts_of_figure();
    key();
    if (figure_.panels.size() > 1) line("set multiplot");
    for (std::size_t k = 0; k < figure_.panels.size(); ++k) figure_.panels[k].z ? panel_in_space() : panel(k);
    if (figure_.panels.size() > 1) line("unset multiplot");
    if (target_.format != PictureFormat::window) line("unset output");
    return std::move(text_);
  }

 private:
  void line(const std::string& command) { text_ += command + '\n'; }

  std::string stroke(const Stroke& s, double dash_scale = 1.0) const {
    return fmt::format("dt {} lw {:.3g} lc rgb '{}'", dash_pattern(s.dash, dash_scale), s.width * units_.line_width,
                       s.colour);
  }

  double point_size(const Marker& marker) const {
    return marker.size * marker_radius * layout_.font * units_.point_size * shape_factor(marker.symbol);
  }

  std::string points(const Marker& marker, bool filled, const std::string& colour) const {
    return fmt::format("pt {} ps {:.3g} lw {:.3g} lc rgb '{}'", point_type(marker.symbol, filled), point_size(marker),
                       2.0 * units_.line_width, colour);
  }

  /// White beneath a symbol: an open one hides the curve, a filled one stays apart from its neighbours.
  std::string background(Marker marker) const {
    if (marker.filled) marker.size *= 1.25;
    return points(marker, true, "#ffffff");
  }

  /// Places on the paper as gnuplot's screen coordinates.
  std::string screen(double x, double y) const {
    return fmt::format("screen {:.5f}, screen {:.5f}", x / figure_.width, y / figure_.height);
  }

  double font_size(double ratio) const { return layout_.font * ratio * units_.font; }

  void head() {
    line("# Written by tchat plot: `gnuplot -d THIS_FILE` draws the picture again.");
    line("set encoding utf8");
    line("set minussign");
    line(terminal_line(target_.format, target_.window, figure_.width, figure_.height, layout_.font));
    if (target_.format != PictureFormat::window) line("set output " + gnuplot_quoted(file_name(target_.path)));
    line("");
  }

  // Data ---------------------------------------------------------------------------------------------------------

  void data(const Panel& panel, std::size_t number) {
    int count = 0;
    for (const Cloud& cloud : panel.clouds) {
      line(fmt::format("$cloud{}_{} << END", number + 1, ++count));
      for (const PicturePoint& p : cloud.points)
        if (std::isfinite(p.x) && std::isfinite(p.y)) line(fmt::format("{:.10g} {:.10g}", p.x, p.y));
      line("END");
    }
    count = 0;
    for (const Curve& curve : panel.curves) {
      line(fmt::format("$curve{}_{} << END", number + 1, ++count));
      for (const PicturePoint& p : curve.points) line(is_finite(p) ? numbers(panel, p, " ") : "");
      line("END");
    }
    count = 0;
    for (const auto& [style, group] : marker_groups(panel, number)) {
      line(fmt::format("$points{}_{} << END", number + 1, ++count));
      for (const Marker& marker : group) line(numbers(panel, marker.at, " "));
      line("END");
    }
    line("");
  }

  using MarkerStyle = std::tuple<Symbol, bool, double, std::string>;

  /// Markers that look alike are drawn together.
  std::map<MarkerStyle, std::vector<Marker>> marker_groups(const Panel& panel, std::size_t number) const {
    std::map<MarkerStyle, std::vector<Marker>> groups;
    for (std::size_t k = 0; k < panel.markers.size(); ++k) {
      Marker marker = panel.markers[k];
      marker.size *= layout_.panels[number].marker_scales[k];
      groups[{marker.symbol, marker.filled, marker.size, marker.colour}].push_back(marker);
    }
    for (const Marker& symbol : layout_.panels[number].symbols)
      groups[{symbol.symbol, symbol.filled, symbol.size, symbol.colour}].push_back(symbol);
    return groups;
  }

  /// Two coordinates, three in space.
  static std::string numbers(const Panel& panel, const PicturePoint& p, const char* between) {
    return panel.z ? fmt::format("{:.10g}{}{:.10g}{}{:.10g}", p.x, between, p.y, between, p.z)
                   : fmt::format("{:.10g}{}{:.10g}", p.x, between, p.y);
  }

  // What belongs to the whole figure -----------------------------------------------------------------------------

  void texts_of_figure() {
    double y = figure_.height - 1.1 * layout_.font;
    if (!figure_.title.empty()) {
      line(fmt::format("set label {} at {} center font ',{:.1f}'", quoted(figure_.title),
                       screen(0.5 * figure_.width, y), font_size(1.1)));
      y -= 1.4 * layout_.font;
    }
    if (!figure_.note.empty())
      line(fmt::format("set label {} at {} center font ',{:.1f}'", quoted(figure_.note), screen(0.5 * figure_.width, y),
                       font_size(label_font_ratio)));
  }

  /// Drawn by hand: gnuplot's own key estimates widths of texts by their number of letters.
  void key() {
    line("unset key");
    if (!layout_.key) return;
    const KeyPlace& place = *layout_.key;
    const double length = key_sample_length * place.font;
    for (std::size_t k = 0; k < figure_.key.size(); ++k) {
      const KeyEntry& entry = figure_.key[k];
      const PicturePoint& at = place.entries[k];
      if (entry.stroke)
        line(fmt::format("set arrow from {} to {} nohead front {}", screen(at.x, at.y), screen(at.x + length, at.y),
                         stroke(*entry.stroke)));
      if (entry.marker)
        line(fmt::format("set label '' at {} front point {}", screen(at.x + 0.5 * length, at.y),
                         points(*entry.marker, entry.marker->filled, entry.marker->colour)));
      line(fmt::format("set label {} at {} left front font ',{:.1f}'", quoted(entry.text),
                       screen(at.x + length + 0.5 * place.font, at.y), place.font * label_font_ratio * units_.font));
    }
  }

  // Panels -------------------------------------------------------------------------------------------------------

  void panel(std::size_t k) {
    const Panel& panel = figure_.panels[k];
    const PanelLayout& place = layout_.panels[k];
    const bool lowest = k + 1 == figure_.panels.size();
    line(fmt::format("set lmargin at screen {:.5f}", place.frame.left / figure_.width));
    line(fmt::format("set rmargin at screen {:.5f}", place.frame.right / figure_.width));
    line(fmt::format("set bmargin at screen {:.5f}", place.frame.bottom / figure_.height));
    line(fmt::format("set tmargin at screen {:.5f}", place.frame.top / figure_.height));
    line("set clip two");
    line("set tics front");  // neither lines nor points over them
    line(fmt::format("set border 15 lw {:.3g}", 1.5 * units_.line_width));
    axis('x', place.x, panel.x.label, lowest);
    axis('y', place.y, panel.y.label, true);
    arrows(panel, place);
    labels(panel, place);
    plot(panel, k);
    if (!lowest) line("unset label\nunset arrow\n");
  }

  void axis(char name, const AxisScale& scale, const LabelText& label, bool numbered) {
    line(fmt::format("set {}range [{:.10g}:{:.10g}]", name, scale.low, scale.high));
    if (scale.logarithmic) line(fmt::format("set logscale {}", name));
    line(numbered && !label.empty() ? fmt::format("set {}label {}", name, quoted(label))
                                    : fmt::format("unset {}label", name));
    if (scale.logarithmic)
      line(fmt::format("set {}tics in scale 1,0.5", name));
    else
      line(fmt::format("set {0}tics {1:.10g},{2:.10g}\nset {0}tics in scale 1,0.5\nset m{0}tics {3}", name,
                       scale.first_tic, scale.tic_step, scale.minor_tics));
    line(fmt::format("set format {} '{}'", name, numbered ? scale.format : ""));
  }

  void arrows(const Panel& panel, const PanelLayout& place) {
    for (const Arrow& arrow : panel.arrows)
      line(fmt::format("set arrow from {} to {} head filled size screen {:.4f},18 fixed lw {:.3g} lc rgb '{}'",
                       numbers(panel, arrow.from, ","), numbers(panel, arrow.to, ","),
                       0.9 * layout_.font / figure_.width, 1.5 * units_.line_width, arrow.colour));
    for (std::size_t k = 0; k < panel.markers.size(); ++k) {
      if (k >= place.labels.size() || !place.labels[k] || !place.labels[k]->far) continue;
      const Box& box = place.labels[k]->box;
      const PicturePoint at = place.on_paper(panel.markers[k].at);
      const double x = std::clamp(at.x, box.left, box.right), y = std::clamp(at.y, box.bottom, box.top);
      line(fmt::format("set arrow from {} to {} nohead lw {:.3g} lc rgb '#606060'", screen(at.x, at.y), screen(x, y),
                       1.0 * units_.line_width));
    }
  }

  void labels(const Panel& panel, const PanelLayout& place) {
    for (std::size_t k = 0; k < panel.markers.size(); ++k) {
      if (k >= place.labels.size() || !place.labels[k]) continue;
      const PicturePoint centre = place.labels[k]->box.centre();
      line(fmt::format("set label {} at {} center front font ',{:.1f}'", quoted(panel.markers[k].label),
                       screen(centre.x, centre.y), font_size(label_font_ratio)));
    }
  }

  void plot(const Panel& panel, std::size_t number) {
    std::vector<std::string> elements;
    for (std::size_t c = 0; c < panel.clouds.size(); ++c)
      elements.push_back(fmt::format("$cloud{}_{} with points {} notitle", number + 1, c + 1,
                                     points(cloud_marker(""), true, panel.clouds[c].colour)));
    for (std::size_t c = 0; c < panel.curves.size(); ++c)
      elements.push_back(fmt::format("$curve{}_{} with lines {} notitle", number + 1, c + 1,
                                     stroke(panel.curves[c].stroke, layout_.panels[number].dash_scales[c])));
    int count = 0;
    for (const auto& [style, group] : marker_groups(panel, number)) {
      const Marker& marker = group.front();
      const std::string block = fmt::format("$points{}_{}", number + 1, ++count);
      elements.push_back(fmt::format("{} with points {} notitle", block, background(marker)));
      elements.push_back(fmt::format("{} with points {} notitle", block, points(marker, marker.filled, marker.colour)));
    }
    if (elements.empty()) elements.emplace_back("NaN notitle");
    line(fmt::format("{} {}", panel.z ? "splot" : "plot", fmt::join(elements, ", \\\n     ")));
  }

  // In space -----------------------------------------------------------------------------------------------------

  void panel_in_space() {
    const Panel& panel = figure_.panels.front();
    const PanelLayout& place = layout_.panels.front();
    // gnuplot's own margins leave the middle of the picture to the box; a tall key takes more of it.
    const double height = place.frame.top / figure_.height;
    line(fmt::format("set view {:.4g},{:.4g},{:.3g},1.05", figure_.view_tilt, figure_.view_turn,
                     std::min(1.0, height + 0.08)));
    line("set xyplane relative 0");
    line(fmt::format("set border 4095 lw {:.3g} lc rgb '#909090'", 1.0 * units_.line_width));
    axis('x', place.x, panel.x.label, true);
    axis('y', place.y, panel.y.label, true);
    axis('z', place.z, panel.z->label, true);
    for (const char name : {'x', 'y', 'z'}) line(fmt::format("set {}tics textcolor rgb '#000000'", name));
    line("set xtics offset 0,-0.3\nset ytics offset 0.5,-0.2\nset xlabel offset 0,-0.8\nset ylabel offset 1,-0.5");
    line("set zlabel offset 1.5,0");
    arrows(panel, place);
    plot(panel, 0);
  }

  const Figure& figure_;
  const FigureLayout& layout_;
  const PictureTarget& target_;
  TerminalUnits units_;
  std::string text_;
};

}  // namespace

std::string values_script(const std::string& formula, std::size_t columns,
                          const std::vector<std::vector<double>>& rows) {
  std::string names, values;
  for (std::size_t k = 1; k <= columns; ++k) {
    names += fmt::format("{}c{}", k > 1 ? "," : "", k);
    values += fmt::format("{}${}", k > 1 ? "," : "", k);
  }
  std::string text = fmt::format("f({}) = {}\n", names, formula);
  text += "v(z) = abs(imag(z)) <= 1e-9*abs(z) ? real(z) : NaN\n$rows << END\n";
  for (const std::vector<double>& row : rows) text += fmt::format("{:.17g}\n", fmt::join(row, " "));
  return text + fmt::format(
                    "END\nset table $values\nplot $rows using (sprintf('%.17g', v(f({})))) with table\n"
                    "unset table\nset print '-'\nprint $values\n",
                    values);
}

std::string gnuplot_script(const Figure& figure, const FigureLayout& layout, const PictureTarget& target) {
  return ScriptWriter(figure, layout, target).write();
}

}  // namespace tchat
