#include "plot/gnuplot_script.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "plot/picture_sheet.hpp"

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

std::string colour_of(const std::string& colour) {
  return colour.starts_with('#') ? fmt::format("rgb '{}'", colour) : colour;
}

/// Triangles and diamonds look smaller than squares and circles of the same nominal size.
struct GnuplotSymbol {
  int open;  // number of the open symbol, the filled one follows
  double size;
};

GnuplotSymbol gnuplot_symbol(Symbol symbol) {
  switch (symbol) {
    case Symbol::square:
      return {4, 1.0};
    case Symbol::triangle:
      return {8, 1.2};
    case Symbol::reversed_triangle:
      return {10, 1.2};
    case Symbol::diamond:
      return {12, 1.2};
    case Symbol::pentagon:
      return {14, 1.0};
    case Symbol::dot:
      return {6, 0.5};
    default:
      return {6, 1.0};
  }
}

/// The whole picture in pixels.
struct Page {
  int width, height;
};

/// One figure in its part of the page.
class FigureWriter {
 public:
  /// `panels_before`: of other figures on the page.
  FigureWriter(const PlacedFigure& placed, const Page& page, std::size_t panels_before, PictureFormat format,
               std::string& text)
      : figure_(placed.figure),
        layout_(placed.layout),
        left_(placed.left),
        bottom_(placed.bottom),
        page_(page),
        panels_before_(panels_before),
        format_(format),
        units_(terminal_units(format, placed.figure.width, placed.layout.font)),
        text_(text) {}

  void write_data() {
    for (std::size_t k = 0; k < figure_.panels.size(); ++k) data(figure_.panels[k], k);
  }

  void write_panels() {
    texts_of_figure();
    key();
    colours();
    for (std::size_t k = 0; k < figure_.panels.size(); ++k) figure_.panels[k].z ? panel_in_space() : panel(k);
  }

 private:
  void line(const std::string& command) { text_ += command + '\n'; }

  std::string stroke(const Stroke& s, double dash_scale = 1.0) const {
    return fmt::format("dt {} lw {:.3g} lc rgb '{}'", dash_pattern(s.dash, dash_scale), s.width * units_.line_width,
                       s.colour);
  }

  std::string points(const Marker& marker, bool filled, const std::string& colour) const {
    const GnuplotSymbol symbol = gnuplot_symbol(marker.symbol);
    const double size = marker.size * marker_radius * layout_.font * units_.point_size * symbol.size;
    return fmt::format("pt {} ps {:.3g} lw {:.3g} lc {}",
                       symbol.open + (filled || marker.symbol == Symbol::dot ? 1 : 0), size, 2.0 * units_.line_width,
                       colour_of(colour));
  }

  /// White beneath a symbol: an open one hides the curve, a filled one stays apart from its neighbours.
  std::string background(Marker marker) const {
    if (marker.filled) marker.size *= 1.25;
    return points(marker, true, "#ffffff");
  }

  /// Places on the paper as gnuplot's screen coordinates.
  std::string screen(double x, double y) const { return fmt::format("screen {:.5f}, screen {:.5f}", across(x), up(y)); }
  double across(double x) const { return (left_ + x) / page_.width; }
  double up(double y) const { return (bottom_ + y) / page_.height; }

  /// Names of data: panels count through the whole page.
  std::size_t number_of(std::size_t panel) const { return panels_before_ + panel + 1; }

  double font_size(double ratio) const { return layout_.font * ratio * units_.font; }

  // Data ---------------------------------------------------------------------------------------------------------

  void data(const Panel& panel, std::size_t number) {
    if (panel.field) field(*panel.field, number);
    int count = 0;
    for (const Cloud& cloud : panel.clouds) {
      line(fmt::format("$cloud{}_{} << END", number_of(number), ++count));
      const double side = 0.6 * cloud.size * marker_radius * layout_.font;  // two dots in it look like one
      for (const PicturePoint& p : thinned_points(cloud.points, layout_.panels[number], side))
        line(fmt::format("{:.10g} {:.10g} {:.10g}", p.x, p.y, p.z));
      line("END");
    }
    count = 0;
    for (const Curve& curve : panel.curves) {
      line(fmt::format("$curve{}_{} << END", number_of(number), ++count));
      for (const PicturePoint& p : curve.points) line(is_finite(p) ? numbers(panel, p, " ") : "");
      line("END");
    }
    count = 0;
    for (const auto& [style, group] : marker_groups(panel, number)) {
      line(fmt::format("$points{}_{} << END", number_of(number), ++count));
      for (const Marker& marker : group) line(numbers(panel, marker.at, " "));
      line("END");
    }
    line("");
  }

  /// Numbers in the palette row by row.
  void field(const ColourField& field, std::size_t number) {
    line(fmt::format("$field{} << END", number_of(number)));
    for (std::size_t row = 0; row < field.rows; ++row) {
      const auto begin = field.cells.begin() + static_cast<std::ptrdiff_t>(row * field.columns);
      line(fmt::format("{:.10g}", fmt::join(begin, begin + static_cast<std::ptrdiff_t>(field.columns), " ")));
    }
    line("END");
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

  /// The palette and, unless it explains itself, its bar.
  void colours() {
    line("unset colorbox");
    if (!figure_.palette) return;
    std::string stops;
    for (const auto& [number, colour] : figure_.palette->stops)
      stops += fmt::format("{}{:.10g} '{}'", stops.empty() ? "" : ", ", number, colour);
    line(fmt::format("set palette defined ({})", stops));
    line(fmt::format("set cbrange [{:.10g}:{:.10g}]", figure_.palette->low(), figure_.palette->high()));
    if (!layout_.colour_bar) return;
    const auto& [box, scale] = *layout_.colour_bar;
    line(fmt::format(
        "set colorbox vertical user origin {} size {}", screen(box.left, box.bottom),
        fmt::format("screen {:.5f}, screen {:.5f}", box.width() / page_.width, box.height() / page_.height)));
    line(fmt::format("set cbtics {:.10g} scale 0.5\nset format cb '{}'", scale.tic_step, scale.format));
    if (!figure_.palette->label.empty())  // gnuplot's own would lie on long numbers
      line(fmt::format("set label {} at {} center rotate by 90 front", quoted(figure_.palette->label),
                       screen(box.right + (2.1 + scale.widest_number) * layout_.font, box.centre().y)));
  }

  // Panels -------------------------------------------------------------------------------------------------------

  void panel(std::size_t k) {
    const Panel& panel = figure_.panels[k];
    const PanelLayout& place = layout_.panels[k];
    const bool lowest = k + 1 == figure_.panels.size();
    line(fmt::format("set lmargin at screen {:.5f}", across(place.frame.left)));
    line(fmt::format("set rmargin at screen {:.5f}", across(place.frame.right)));
    line(fmt::format("set bmargin at screen {:.5f}", up(place.frame.bottom)));
    line(fmt::format("set tmargin at screen {:.5f}", up(place.frame.top)));
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
    line(fmt::format("set {0}tics {1} scale 1,0.5\nset m{0}tics", name,
                     scale.logarithmic ? "autofreq" : fmt::format("{:.10g}", scale.tic_step)));
    line(fmt::format("set format {} '{}'", name, numbered ? scale.format : ""));
  }

  void arrows(const Panel& panel, const PanelLayout& place) {
    for (const Arrow& arrow : panel.arrows)
      line(fmt::format("set arrow from {} to {} head filled size screen {:.4f},18 fixed lw {:.3g} lc rgb '{}'",
                       numbers(panel, arrow.from, ","), numbers(panel, arrow.to, ","), 0.9 * layout_.font / page_.width,
                       1.5 * units_.line_width, arrow.colour));
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

  std::string image(const ColourField& field, std::size_t number) const {
    const auto axis = [](const char* index, double first, double last, std::size_t count) {
      const double step = count > 1 ? (last - first) / static_cast<double>(count - 1) : 1.0;
      return fmt::format("({:.12g}+({:.12g})*{})", first, step, index);
    };
    return fmt::format("$field{} matrix using {}:{}:3 with image notitle", number_of(number),
                       axis("$1", field.first.x, field.last.x, field.columns),
                       axis("$2", field.first.y, field.last.y, field.rows));
  }

  /// The smallest dots of an SVG are gnuplot's own: half a pixel in radius, and a shorter text.
  std::string dots(const Cloud& cloud) const {
    constexpr double smallest = 0.2;
    if (format_ == PictureFormat::svg && cloud.size <= smallest) return "dots lc " + colour_of(cloud.colour);
    return "points " + points({{}, Symbol::dot, true, cloud.size}, true, cloud.colour);
  }

  void plot(const Panel& panel, std::size_t number) {
    std::vector<std::string> elements;
    if (panel.field) elements.push_back(image(*panel.field, number));
    for (std::size_t c = 0; c < panel.clouds.size(); ++c)
      elements.push_back(fmt::format("$cloud{}_{} with {} notitle", number_of(number), c + 1, dots(panel.clouds[c])));
    for (std::size_t c = 0; c < panel.curves.size(); ++c)
      elements.push_back(fmt::format("$curve{}_{} with lines {} notitle", number_of(number), c + 1,
                                     stroke(panel.curves[c].stroke, layout_.panels[number].dash_scales[c])));
    int count = 0;
    for (const auto& [style, group] : marker_groups(panel, number)) {
      const Marker& marker = group.front();
      const std::string block = fmt::format("$points{}_{}", number_of(number), ++count);
      elements.push_back(fmt::format("{} with points {} notitle", block, background(marker)));
      elements.push_back(fmt::format("{} with points {} notitle", block, points(marker, marker.filled, marker.colour)));
    }
    if (layout_.colour_bar)
      elements.emplace_back("NaN with points palette notitle");  // gnuplot draws a bar that is used
    if (elements.empty()) elements.emplace_back("NaN notitle");
    line(fmt::format("{} {}", panel.z ? "splot" : "plot", fmt::join(elements, ", \\\n     ")));
  }

  // In space -----------------------------------------------------------------------------------------------------

  void panel_in_space() {
    const Panel& panel = figure_.panels.front();
    const PanelLayout& place = layout_.panels.front();
    // gnuplot's own margins leave the middle of the picture to the box; a tall key takes more of it.
    const double height = up(place.frame.top);
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
  double left_, bottom_;
  Page page_;
  std::size_t panels_before_;
  PictureFormat format_;
  TerminalUnits units_;
  std::string& text_;
};

std::string head(const SheetLayout& sheet, const PictureTarget& target) {
  std::string text = "# Written by tchat plot: `gnuplot -d THIS_FILE` draws the picture again.\n";
  text += "set encoding utf8\nset minussign\n";
  text += terminal_line(target.format, target.window, sheet.width, sheet.height, sheet.font) + '\n';
  if (target.format != PictureFormat::window) text += "set output " + gnuplot_quoted(file_name(target.path)) + '\n';
  return text + '\n';
}

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

std::string gnuplot_script(const SheetLayout& sheet, const PictureTarget& target) {
  std::string text = head(sheet, target);
  std::vector<FigureWriter> figures;
  std::size_t panels = 0;
  for (const PlacedFigure& placed : sheet.figures) {
    figures.emplace_back(placed, Page{sheet.width, sheet.height}, panels, target.format, text);
    panels += placed.figure.panels.size();
  }
  for (FigureWriter& figure : figures) figure.write_data();
  if (panels > 1) text += "set multiplot\n";
  if (!sheet.title.empty()) {
    const TerminalUnits units = terminal_units(target.format, sheet.width, sheet.font);
    text += fmt::format("set label {} at screen 0.5, screen {:.5f} center font ',{:.1f}'\n", quoted(sheet.title),
                        1.0 - 1.3 * sheet.font / sheet.height, 1.2 * sheet.font * units.font);
  }
  for (std::size_t k = 0; k < figures.size(); ++k) {
    // What the figure before has left behind.
    if (k > 0) text += "unset label\nunset arrow\nunset object\nunset logscale\n\n";
    figures[k].write_panels();
  }
  if (panels > 1) text += "unset multiplot\n";
  if (target.format != PictureFormat::window) text += "unset output\n";
  return text;
}

std::string gnuplot_script(const Figure& figure, const FigureLayout& layout, const PictureTarget& target) {
  SheetLayout sheet;
  sheet.figures.push_back({figure, layout, 0.0, 0.0});
  sheet.width = figure.width;
  sheet.height = figure.height;
  sheet.font = layout.font;
  return gnuplot_script(sheet, target);
}

}  // namespace tchat
