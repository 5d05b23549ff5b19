#include "plot/event_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/recorded_labels.hpp"
#include "model/events.hpp"
#include "plot/gnuplot.hpp"
#include "plugin/plugin_build.hpp"
#include "settings/constants_file.hpp"

namespace tchat {

namespace {

constexpr double tolerance = level::orbit;
constexpr int cells = 160;
constexpr Eigen::Index samples = 60;  // of a segment

/// Calls what(state, parameters) at points of all orbits.
template <class What>
void for_samples(const std::vector<OrbitTrace>& orbits, const std::vector<std::vector<double>>& parameters, What what) {
  for (std::size_t o = 0; o < orbits.size(); ++o)
    for (const TraceSegment& segment : orbits[o].segments) {
      const Eigen::Index step = std::max<Eigen::Index>(1, segment.states.cols() / samples);
      for (Eigen::Index k = 0; k < segment.states.cols(); k += step) {
        const Eigen::VectorXd x = segment.states.col(k);
        what(x, parameters[o].data());
      }
    }
}

/// A root of a function that changes sign between low and high.
template <class Function>
double bisected(Function f, double low, double high) {
  const bool negative = f(low) < 0.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    ((f(middle) < 0.0) == negative ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The curves h(x, y) = 0 in a window, as polylines, by gnuplot's contours; nothing where h is not finite.
template <class Function>
std::vector<std::vector<PicturePoint>> zero_contour(Function h, const StateWindow& window) {
  const double step_x = (window.high_x - window.low_x) / cells, step_y = (window.high_y - window.low_y) / cells;
  std::string script = "$h << END\n";
  for (int row = 0; row <= cells; ++row)
    for (int column = 0; column <= cells; ++column)
      script += fmt::format("{:.17g}{}", h(window.low_x + column * step_x, window.low_y + row * step_y),
                            column < cells ? " " : "\n");
  script += fmt::format(
      "END\nset contour base\nunset surface\nset cntrparam levels discrete 0\nset format '%.15g'\nset table $zeros\n"
      "splot $h matrix using ({:.17g}+{:.17g}*$1):({:.17g}+{:.17g}*$2):3\nunset table\nset print '-'\nprint $zeros\n",
      window.low_x, step_x, window.low_y, step_y);
  std::vector<std::vector<PicturePoint>> lines;
  bool continues = false;
  std::istringstream output(gnuplot_output(script));
  for (std::string text; std::getline(output, text);) {
    std::istringstream words(text);
    PicturePoint point;
    const bool is_vertex = static_cast<bool>(words >> point.x >> point.y);
    if (is_vertex && !continues) lines.emplace_back();
    if (is_vertex) lines.back().push_back(point);
    continues = is_vertex;
  }
  return lines;
}

}  // namespace

EventSurfaces::EventSurfaces(const HybridSystem& system, const std::vector<OrbitTrace>& orbits,
                             const std::vector<int>& events)
    : system_(system), orbits_(orbits) {
  for (const OrbitTrace& orbit : orbits) {
    parameters_.push_back(orbit.parameters);
    parameters_.back().resize(static_cast<std::size_t>(system.layout().room()), 0.0);
  }
  const int count = system.count(FunctionKind::event);
  for (const int event : events)
    if (event < 1 || event > count)
      throw UserError(
          fmt::format("--surfaces {}: problem {} has the event functions 1..{}", event, system.name(), count));
  events_ = events;
  if (events.empty())
    for (int event = 1; event <= count; ++event)
      if (!is_section(event)) events_.push_back(event);
}

bool EventSurfaces::depends_only_on(int event, const std::vector<int>& states) const {
  double largest = 0.0, others = 0.0;
  bool finite = true;
  for_samples(orbits_, parameters_, [&](const Eigen::VectorXd& x, const double* par) {
    const Eigen::VectorXd h = event_at(system_, event, x.data(), par).gradient;
    finite = finite && h.allFinite();
    for (Eigen::Index i = 0; i < h.size(); ++i) {
      largest = std::max(largest, std::abs(h(i)));
      if (std::find(states.begin(), states.end(), i) == states.end()) others = std::max(others, std::abs(h(i)));
    }
  });
  return finite && largest > 0.0 && others <= tolerance * largest;
}

/// h_j = c h_i,x f along all orbits, for some other event function i and some field.
bool EventSurfaces::is_section(int event) const {
  for (int other = 1; other <= system_.count(FunctionKind::event); ++other) {
    for (int field = 1; other != event && field <= system_.count(FunctionKind::field); ++field) {
      double product = 0.0, slope_square = 0.0, square = 0.0;
      for_samples(orbits_, parameters_, [&](const Eigen::VectorXd& x, const double* par) {
        Eigen::VectorXd f(x.size());
        system_.value(FunctionKind::field, field, x.data(), par, f.data());
        const double slope = event_at(system_, other, x.data(), par).gradient.dot(f);
        const double h = system_.event(event, x.data(), par);
        product += h * slope;
        slope_square += slope * slope;
        square += h * h;
      });
      const bool parallel =
          square > 0.0 && slope_square > 0.0 &&
          std::abs(product * product - square * slope_square) <= level::converged * square * slope_square;
      if (parallel) return true;
    }
  }
  return false;
}

double EventSurfaces::value(int event, const OrbitTrace& orbit, int a, double x, int b, double y) const {
  Eigen::VectorXd state = orbit.segments.front().states.col(0);
  state(a) = x;
  if (b >= 0) state(b) = y;
  const auto index = static_cast<std::size_t>(&orbit - orbits_.data());
  return system_.event(event, state.data(), parameters_[index].data());
}

/// One is a multiple of the other in the window.
bool EventSurfaces::same_zeros(int event, int other, int a, int b, const StateWindow& window) const {
  constexpr int points = 9;
  for (const OrbitTrace& orbit : orbits_) {
    double product = 0.0, square = 0.0, other_square = 0.0;
    for (int i = 0; i < points * points; ++i) {
      const int column = i % points, row = i / points;
      const double x = window.low_x + (window.high_x - window.low_x) * column / (points - 1);
      const double y = window.low_y + (window.high_y - window.low_y) * row / (points - 1);
      const double h = value(event, orbit, a, x, b, y), k = value(other, orbit, a, x, b, y);
      product += h * k;
      square += h * h;
      other_square += k * k;
    }
    const double size = square * other_square;
    if (!(size > 0.0) || !(std::abs(product * product - size) <= level::negligible * size)) return false;
  }
  return true;
}

/// Those that depend on these one or two states alone; events with the same zeros share an entry.
std::vector<NamedEvent> EventSurfaces::distinct_events(const std::vector<int>& states,
                                                       const StateWindow& window) const {
  const int second = states.size() > 1 ? states[1] : -1;
  std::vector<NamedEvent> distinct;
  for (const int event : events_) {
    if (!depends_only_on(event, states)) continue;
    const std::string& name = system_.function_name(FunctionKind::event, event);
    const auto same = std::find_if(distinct.begin(), distinct.end(), [&](const NamedEvent& other) {
      return same_zeros(other.number, event, states[0], second, window);
    });
    if (same != distinct.end())
      same->name += ", " + name;
    else
      distinct.push_back({event, name});
  }
  return distinct;
}

std::vector<EventSurfaces::Line> EventSurfaces::in_plane(int a, int b, const StateWindow& window) const {
  std::vector<Line> lines;
  for (const NamedEvent& event : distinct_events({a, b}, window)) {
    Line line{event, {}};
    for (const OrbitTrace& orbit : orbits_)
      for (auto& piece :
           zero_contour([&](double x, double y) { return value(event.number, orbit, a, x, b, y); }, window))
        if (std::find(line.pieces.begin(), line.pieces.end(), piece) == line.pieces.end())
          line.pieces.push_back(std::move(piece));
    if (!line.pieces.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<EventSurfaces::Level> EventSurfaces::of_state(int a, double low, double high) const {
  constexpr int steps = 400;
  std::vector<Level> levels;
  for (const NamedEvent& event : distinct_events({a}, {low, high, 0.0, 1.0})) {
    Level level{event, {}};
    for (const OrbitTrace& orbit : orbits_) {
      const auto h = [&](double x) { return value(event.number, orbit, a, x, -1, 0.0); };
      for (int k = 0; k < steps; ++k) {
        const double left = low + (high - low) * k / steps, right = low + (high - low) * (k + 1) / steps;
        if ((h(left) < 0.0) == (h(right) < 0.0)) continue;
        const double root = bisected(h, left, right);
        const bool known = std::any_of(level.values.begin(), level.values.end(), [&](double other) {
          return std::abs(other - root) <= tolerance * (high - low);
        });
        if (!known) level.values.push_back(root);
      }
    }
    if (!level.values.empty()) levels.push_back(std::move(level));
  }
  return levels;
}

namespace {

void take(ProblemChoice& choice, std::shared_ptr<ProblemLibrary> library) {
  const ProblemNames names = ProblemNames::of(library->system());
  choice.library = std::move(library);
  choice.states = names.states;
  choice.parameters = names.parameters;
}

/// The library; a Fortran plugin needs r.O, the constants of the run that wrote q.O.
std::shared_ptr<ProblemLibrary> load(const std::string& plugin, const std::string& solution_path) {
  return std::make_shared<ProblemLibrary>(resolve_plugin(plugin), [&solution_path] {
    return problem_sizes(read_constants_file(sibling_path(solution_path, 'r')));
  });
}

}  // namespace

ProblemChoice find_problem(const std::string& solution_path, const std::string& plugin, int dimension) {
  ProblemChoice choice;
  if (!plugin.empty()) {
    take(choice, load(plugin, solution_path));
    if (choice.system()->dimension() != dimension)
      throw UserError(fmt::format("-p {}: problem {} has {} states, the orbits of {} have {}", plugin,
                                  choice.system()->name(), choice.system()->dimension(), solution_path, dimension));
    return choice;
  }
  RecordedNames recorded = recorded_names(solution_path);
  choice.states = std::move(recorded.names.states);
  choice.parameters = std::move(recorded.names.parameters);
  choice.warning = std::move(recorded.warning);
  return choice;
}

}  // namespace tchat
