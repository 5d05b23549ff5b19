#include "explore/curve_catalogue.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "base/words.hpp"
#include "plugin/plugin_build.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// In units of the ranges: points are located far more accurately.
constexpr double place_tolerance = level::same;
/// Relative, of whole numbers of periods.
constexpr double period_tolerance = level::five_digits;

/// Of an equilibrium the mean and the largest value of a state are the state.
std::vector<std::size_t> number_columns(const PointSection& section, const CurveColumns& columns) {
  std::vector<std::size_t> result;
  for (const std::string& name : columns.monitors)
    if (const auto column = section.column(section.at_rest(name))) result.push_back(*column);
  return result;
}

/// A Hopf bifurcation of periodic orbits is where they have shrunk.
bool has_shrunk(const PointSection& section, const PointRow& row) {
  return family_of(section.problem_type).facts().headings.has_period && is_birth_of_orbits(row.type);
}

/// The equilibrium in an orbit that has shrunk, which the means give.
VectorXd numbers_of(const CurvePoint& point) {
  VectorXd numbers = point.numbers;
  if (!point.has_shrunk) return numbers;
  numbers(0) = 0.0;
  for (Index k = 2; k < numbers.size(); k += 2) numbers(k) = numbers(k - 1);
  return numbers;
}

/// Where a section passes a place: its numbers there, the first of which is the distance from the place.
using Passage = InterpolatedPoint;

/// Between points i and i + 1, in coordinates along and across the chord; false where the place is not beside it.
bool passes(const CurveSection& section, Index i, const Vector2d& place, Passage& passage) {
  const auto& points = section.points;
  const auto at = [&](Index k) -> const CurvePoint& { return points[static_cast<std::size_t>(k)]; };
  const Vector2d chord = at(i + 1).place - at(i).place;
  const double length = chord.norm();
  if (!(length > 0.0)) return false;
  const Vector2d along = chord / length;
  const Vector2d across(-along.y(), along.x());
  const double here = along.dot(place - at(i).place);
  if (here < -place_tolerance || here > length + place_tolerance ||
      std::abs(across.dot(place - at(i).place)) > length + place_tolerance)
    return false;
  const Index first = std::max<Index>(0, i - 1);
  const Index last = std::min<Index>(std::ssize(points) - 1, i + 2);
  std::vector<double> coordinate;
  Eigen::MatrixXd numbers(1 + at(i).numbers.size(), last - first + 1);
  for (Index k = first; k <= last; ++k) {
    coordinate.push_back(along.dot(at(k).place - at(i).place));
    numbers(0, k - first) = across.dot(at(k).place - place);
    numbers.col(k - first).tail(at(i).numbers.size()) = at(k).numbers;
  }
  passage = interpolate(coordinate, numbers, i - first, std::clamp(here, 0.0, length));
  return true;
}

bool is_near(const Passage& passage) {
  return std::abs(passage.numbers(0)) <= 2.0 * passage.uncertainty(0) + place_tolerance;
}

InterpolatedPoint orbit_at(const Passage& passage) {
  const Index count = passage.numbers.size() - 1;
  return {passage.numbers.tail(count), passage.uncertainty.tail(count)};
}

bool has_orbit(const Passage& passage, const VectorXd& numbers) {
  return passage.numbers.size() == numbers.size() + 1 && is_near(passage) && agrees(orbit_at(passage), numbers);
}

/// The same with periods that are whole numbers of each other.
bool has_orbit_repeated(const Passage& passage, VectorXd numbers) {
  if (passage.numbers.size() != numbers.size() + 1) return false;
  const double known = passage.numbers(1);
  const double ratio = std::max(known, numbers(0)) / std::min(known, numbers(0));
  if (known > 0.0 && numbers(0) > 0.0 && std::abs(ratio - std::round(ratio)) <= period_tolerance * ratio)
    numbers(0) = known;
  return has_orbit(passage, numbers);
}

bool any_passage(const CurveSection& section, const Vector2d& place,
                 const std::function<bool(const Passage&)>& is_wanted) {
  Passage passage;
  for (Index i = 0; i + 1 < std::ssize(section.points); ++i)
    if (passes(section, i, place, passage) && is_wanted(passage)) return true;
  return false;
}

CurvePoint curve_point(const PointSection& section, const PointRow& row, const CurveColumns& columns,
                       const std::vector<std::size_t>& monitors) {
  const auto second = section.column(columns.second), period = section.column("PERIOD");
  const double of_second = second ? row.values[*second] : std::numeric_limits<double>::quiet_NaN();
  CurvePoint point{{row.values.front() / columns.widths(0), of_second / columns.widths(1)},
                   VectorXd(1 + std::ssize(monitors)),
                   has_shrunk(section, row)};
  point.numbers(0) = period ? row.values[*period] / primitive_word(section.signature).repetitions : 0.0;
  for (Index k = 0; k < std::ssize(monitors); ++k)
    point.numbers(1 + k) = row.values[monitors[static_cast<std::size_t>(k)]];
  return point;
}

}  // namespace

std::vector<CurveSection> curve_sections(const std::string& curve, const std::string& kind, const PointFile& file,
                                         const CurveColumns& columns) {
  std::vector<CurveSection> result;
  for (const PointSection& section : file.sections) {
    const std::vector<std::size_t> monitors = number_columns(section, columns);
    CurveSection one{curve, kind, {}, {}};
    for (const PointRow& row : section.rows) {
      one.points.push_back(curve_point(section, row, columns, monitors));
      one.labels.push_back(row.label);
    }
    result.push_back(std::move(one));
  }
  return result;
}

/// Three points tell: the middle of the section, and on to its end. Its beginning is near where it was started.
std::string CurveCatalogue::curve_of(const CurveSection& section) const {
  std::string found;
  for (const double share : {0.5, 0.75, 0.95}) {
    const auto last = static_cast<double>(section.points.size() - 1);
    const CurvePoint& point = section.points[static_cast<std::size_t>(std::lround(share * last))];
    found = curve_at(section.kind, point);
    if (found.empty()) return "";
  }
  return found;
}

std::string CurveCatalogue::curve_at(const std::string& kind, const CurvePoint& point) const {
  const VectorXd numbers = numbers_of(point);
  for (const CurveSection& known : sections_) {
    const bool is_doubled = (kind == "BP" && known.kind == "PD") || (kind == "PD" && known.kind == "BP");
    if (known.kind != kind && !is_doubled) continue;
    const bool may_repeat = is_doubled || kind == "GR";  // an orbit that touches does so on every turn
    const auto same = [&](const Passage& passage) {
      return may_repeat ? has_orbit_repeated(passage, numbers) : has_orbit(passage, numbers);
    };
    if (any_passage(known, point.place, same)) return known.curve;
  }
  return "";
}

std::vector<std::string> CurveCatalogue::curves_through(const CurvePoint& point) const {
  std::vector<std::string> names;
  const VectorXd numbers = numbers_of(point);
  const auto same = [&](const Passage& passage) { return has_orbit_repeated(passage, numbers); };
  for (const CurveSection& known : sections_)
    if ((names.empty() || names.back() != known.curve) && any_passage(known, point.place, same))
      names.push_back(known.curve);
  return names;
}

CurveCommands::CurveCommands(const ExploreRequest& request, const ExplorationCommands& commands,
                             const HybridSystem& system, const ParameterVector& par)
    : commands_(commands),
      returns_(request.returns.value_or(4)),
      second_(read_swept_range("--and", *request.second, false)) {
  index_ = find_parameter("--and", system, second_);
  if (second_.parameter == commands.range().parameter)
    throw UserError(fmt::format("--and {}: this is the parameter of --over; another one is needed", second_.parameter));
  const double value = par(index_ - 1);
  if (value < second_.from || value > second_.to)
    throw UserError(
        fmt::format("--and {0}={1}:{2}: the diagram is at {0} = {3}, outside of this range; give it another "
                    "value, as 'PAR({0})={4}'",
                    second_.parameter, second_.from, second_.to, value, std::midpoint(second_.from, second_.to)));
}

std::string CurveCommands::free_parameters(bool rests) const {
  std::string names = commands_.range().parameter + "," + second_.parameter;
  if (!rests)
    for (const std::string& monitor : commands_.monitors()) names += "," + monitor;
  return fmt::format("ICP=[{}]", names);
}

/// Between what either range alone would have.
double CurveCommands::largest_step() const {
  const SweptRange& first = commands_.range();
  return std::sqrt((first.to - first.from) * (second_.to - second_.from)) / 20.0;
}

/// That go once across the rectangle and back, with such steps.
int CurveCommands::most_points() const {
  const SweptRange& first = commands_.range();
  const double ratio = (first.to - first.from) / (second_.to - second_.from);
  return static_cast<int>(std::clamp(60.0 * std::sqrt(std::max(ratio, 1.0 / ratio)), 400.0, 20000.0));
}

CommandJob CurveCommands::curve(const std::string& name, const Commands& commands, const std::string& source,
                                bool rests) const {
  CommandJob job = commands_.job_from(source, name, commands);
  const SweptRange& first = commands_.range();
  if (commands.size() > 1)
    job.commands.front() =
        words_of({commands.front(), {"-q", fmt::format("ICP=[{},{}]", first.parameter, second_.parameter)}});
  Command words{free_parameters(rests),
                fmt::format("RL0={}", first.from),
                fmt::format("RL1={}", first.to),
                fmt::format("BOUNDS={{{}: [{}, {}]}}", second_.parameter, second_.from, second_.to),
                fmt::format("DS={:g}", largest_step() / 10.0),
                fmt::format("DSMAX={:g}", largest_step()),
                fmt::format("NMX={}", most_points())};
  std::vector<int> returns(static_cast<std::size_t>(returns_));
  std::iota(returns.begin(), returns.end(), 1);
  if (commands.front().front() == "resegment") words.push_back(fmt::format("GCIPSI=[{}]", fmt::join(returns, ",")));
  job.commands.back() = words_of({commands.back(), {"--both", "--clip"}, words, commands_.constants()});
  return job;
}

CommandJob CurveCommands::slice(const std::string& name, const ResonantPoint& at, int sign) const {
  const std::string beside = name + "_beside";
  const double step = largest_step() / 5.0;
  Commands commands{
      words_of({{"run"},
                problem_words(commands_.problem()),
                {"-c", commands_.file('r', at.curve), "-s", commands_.path(at.curve), fmt::format("IRS={}", at.label),
                 "NMX=2", fmt::format("DS={:g}", sign * step), fmt::format("DSMAX={:g}", step), "ILP=0", "ISP=0",
                 "GCIPSI=[]", "-o", commands_.path(beside), "--clip", "-q"}})};
  for (Command& command : commands_.born_commands(beside, "EP1", at.returns, name))
    commands.push_back(std::move(command));
  return commands_.job_from(at.curve, name, std::move(commands));
}

}  // namespace tchat
