#include "explore/orbit_catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<std::string> state_columns(const PointSection& section) {
  std::vector<std::string> names;
  for (int k = 1; k <= section.dimension; ++k) names.push_back(section.state_name(k));
  return names;
}

/// Between point i and the next one.
bool passes(const CataloguedSection& section, Index i, double parameter) {
  const double a = section.parameter[static_cast<std::size_t>(i)];
  const double b = section.parameter[static_cast<std::size_t>(i + 1)];
  return std::min(a, b) <= parameter && parameter <= std::max(a, b) && a != b;
}

/// The orbits of a section at a parameter value, with the uncertainty of each number.
std::vector<InterpolatedPoint> orbits_at(const CataloguedSection& section, double parameter) {
  std::vector<InterpolatedPoint> result;
  for (Index i = 0; i + 1 < std::ssize(section.parameter); ++i)
    if (passes(section, i, parameter)) result.push_back(interpolate(section.parameter, section.numbers, i, parameter));
  return result;
}

/// A signature does not count how often an orbit is run round where nothing is cut: its period may be a multiple of
/// that of the known one, or a part of it.
VectorXd with_period_of(const InterpolatedPoint& known, VectorXd numbers) {
  const double ratio = numbers(0) / known.numbers(0);
  const double turns = std::max(1.0, std::round(std::max(ratio, 1.0 / ratio)));
  numbers(0) *= ratio > 1.0 ? 1.0 / turns : turns;
  return numbers;
}

/// Share of the largest number by which orbits may differ whose limits sum up more impacts or fewer.
constexpr double by_summed_impacts = 0.1;

bool are_near(const InterpolatedPoint& orbit, const VectorXd& numbers, bool has_other_impacts) {
  constexpr double errors = 5.0;
  const double share = has_other_impacts ? by_summed_impacts : level::five_digits;
  const double size = numbers.cwiseAbs().maxCoeff();
  return ((orbit.numbers - numbers).array().abs() <= errors * orbit.uncertainty.array() + share * size).all();
}

/// From the middle of a section to its end: its beginning is near where it bifurcates.
std::vector<Index> rows_compared(const CataloguedSection& section) {
  const auto last = static_cast<Index>(section.parameter.size()) - 1;
  std::vector<Index> rows;
  for (const double share : {0.4, 0.5, 0.6, 0.75, 0.95})
    rows.push_back(std::min<Index>(last, static_cast<Index>(std::lround(share * static_cast<double>(last)))));
  return rows;
}

/// Shares of the largest monitor. Where a largest value moves from one maximum to another, interpolation is coarse; an
/// orbit that is cut by other events has to agree better.
constexpr double coarse = 1e-2, fine = level::five_digits;

/// As far as the monitors are known.
bool about_agree(const InterpolatedPoint& orbit, const std::vector<double>& monitors, double share) {
  const double size = orbit.numbers.tail(orbit.numbers.size() - 1).cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < monitors.size(); ++k) {
    const auto row = static_cast<Index>(k + 1);  // behind the period
    if (std::isfinite(monitors[k]) && std::abs(orbit.numbers(row) - monitors[k]) > share * size) return false;
  }
  return true;
}

}  // namespace

PrimitiveWord common_word(const HybridSystem& system, const Signature& signature) {
  Signature word;
  for (const std::size_t s : system.without_chatter(signature)) word.push_back(signature[s]);
  return primitive_word(word);
}

std::vector<CataloguedSection> catalogued_sections(const HybridSystem& system, const std::string& branch,
                                                   const PointFile& file, const std::vector<std::string>& monitors) {
  std::vector<CataloguedSection> result;
  int number = 0;
  for (const PointSection& section : file.sections) {
    ++number;
    const bool rests = !family_of(section.problem_type).facts().headings.has_period;
    const std::vector<std::string> names = rests ? state_columns(section) : monitors;
    std::vector<std::size_t> columns;
    if (const auto period = section.column("PERIOD"); period && !rests) columns.push_back(*period);
    for (const std::string& name : names)
      if (const auto column = section.column(name)) columns.push_back(*column);
    if (columns.size() != (rests ? 0 : 1) + names.size()) continue;
    CataloguedSection one;
    one.branch = branch;
    one.number = number;
    one.own_signature = section.signature;
    one.signature = common_word(system, section.signature);
    one.rests = rests;
    one.numbers.resize(std::ssize(columns), std::ssize(section.rows));
    for (std::size_t r = 0; r < section.rows.size(); ++r) {
      one.parameter.push_back(section.rows[r].values.front());
      one.labels.push_back(section.rows[r].label);
      for (std::size_t k = 0; k < columns.size(); ++k)
        one.numbers(static_cast<Index>(k), static_cast<Index>(r)) = section.rows[r].values[columns[k]];
      if (!rests) one.numbers(0, static_cast<Index>(r)) /= one.signature.repetitions;
    }
    result.push_back(std::move(one));
  }
  return result;
}

/// All orbits but one have to agree: a largest value may have a kink, which interpolation does not see. A run that
/// comes from values where the known branch is not is more than a part of it.
std::string OrbitCatalogue::branch_of(const CataloguedSection& section) const {
  std::vector<std::string> last;
  int missing = 0;
  for (const Index row : rows_compared(section)) {
    std::vector<std::string> branches =
        branches_at(section, section.parameter[static_cast<std::size_t>(row)], section.numbers.col(row));
    if (branches.empty() && ++missing > 1) return "";
    if (!branches.empty()) last = std::move(branches);
  }
  const auto found =
      std::find_if(last.begin(), last.end(), [&](const std::string& branch) { return has_beginning(branch, section); });
  return found == last.end() ? "" : *found;
}

bool OrbitCatalogue::has_beginning(const std::string& branch, const CataloguedSection& section) const {
  constexpr double share = 0.01;
  const auto [low, high] = std::minmax_element(section.parameter.begin(), section.parameter.end());
  const double slack = share * (*high - *low), first = section.parameter.front();
  return std::any_of(sections_.begin(), sections_.end(), [&](const CataloguedSection& known) {
    if (known.branch != branch) return false;
    const auto [least, most] = std::minmax_element(known.parameter.begin(), known.parameter.end());
    return *least - slack <= first && first <= *most + slack;
  });
}

std::vector<std::string> OrbitCatalogue::branches_near(const CataloguedSection& section) const {
  constexpr int enough = 3;
  std::vector<std::string> names, near;
  for (const CataloguedSection& known : sections_)
    if (std::find(names.begin(), names.end(), known.branch) == names.end()) names.push_back(known.branch);
  const std::vector<Index> rows = rows_compared(section);
  for (const std::string& name : names)
    if (std::count_if(rows.begin(), rows.end(), [&](Index row) { return !places_near(name, section, row).empty(); }) >=
        enough)
      near.push_back(name);
  return near;
}

std::vector<BranchPlace> OrbitCatalogue::places_near(const std::string& branch, const CataloguedSection& like,
                                                     Index row) const {
  std::vector<BranchPlace> places;
  const double parameter = like.parameter[static_cast<std::size_t>(row)];
  for (const CataloguedSection& known : sections_) {
    if (known.branch != branch || known.rests != like.rests) continue;
    for (Index i = 0; i + 1 < std::ssize(known.parameter); ++i) {
      if (!passes(known, i, parameter)) continue;
      const InterpolatedPoint orbit = interpolate(known.parameter, known.numbers, i, parameter);
      const VectorXd numbers = like.numbers.col(row);
      const bool has_other_impacts = known.has_chatter() && known.own_signature.size() != like.own_signature.size();
      if (are_near(orbit, like.rests ? numbers : with_period_of(orbit, numbers), has_other_impacts))
        places.push_back({&known, i});
    }
  }
  return places;
}

std::string OrbitCatalogue::branch_with_state(double parameter, const VectorXd& state, double size) const {
  for (const CataloguedSection& known : sections_) {
    if (!known.rests) continue;
    for (const InterpolatedPoint& one : orbits_at(known, parameter))
      if (agrees(one, state, size)) return known.branch;
  }
  return "";
}

std::vector<std::string> OrbitCatalogue::branches_at(const CataloguedSection& like, double parameter,
                                                     const VectorXd& numbers) const {
  std::vector<std::string> branches;
  for (const CataloguedSection& known : sections_) {
    if (known.rests != like.rests || known.signature.word != like.signature.word) continue;
    const std::vector<InterpolatedPoint> orbits = orbits_at(known, parameter);
    if (std::any_of(orbits.begin(), orbits.end(), [&](const InterpolatedPoint& orbit) {
          return agrees(orbit, like.rests ? numbers : with_period_of(orbit, numbers));
        }))
      branches.push_back(known.branch);
  }
  return branches;
}

std::vector<std::string> OrbitCatalogue::branches_with(const PrimitiveWord& signature, double parameter, double period,
                                                       const std::vector<double>& monitors) const {
  std::vector<std::string> branches;
  for (const CataloguedSection& known : sections_) {
    if (known.rests) continue;
    const bool is_cut_alike = known.signature.word == signature.word;
    const std::vector<InterpolatedPoint> orbits = orbits_at(known, parameter);
    const bool has_one = std::any_of(orbits.begin(), orbits.end(), [&](const InterpolatedPoint& orbit) {
      const double time = orbit.numbers(0) * known.signature.repetitions;
      const double tolerance =
          2.0 * orbit.uncertainty(0) * known.signature.repetitions + level::five_digits * std::abs(period);
      const double share = !is_cut_alike ? fine : known.has_chatter() ? by_summed_impacts : coarse;
      return std::abs(time - period) <= tolerance && about_agree(orbit, monitors, share);
    });
    if (has_one && std::find(branches.begin(), branches.end(), known.branch) == branches.end())
      branches.push_back(known.branch);
  }
  return branches;
}

namespace {

/// What the polynomial through the points first..last has at `at`, between points i and i + 1. The points are
/// parametrised by their distance, in which a branch is smooth at folds too.
VectorXd polynomial_value(const std::vector<double>& coordinate, const Eigen::MatrixXd& numbers, Index first,
                          Index last, Index i, double at) {
  const auto p = [&](Index k) { return coordinate[static_cast<std::size_t>(k)]; };
  const Index rows = numbers.rows();
  VectorXd distance(last - first + 1);
  distance(0) = 0.0;
  for (Index k = first; k < last; ++k) {
    const double size = numbers.cwiseAbs().maxCoeff() + std::abs(p(k));
    const double step = std::hypot((numbers.col(k + 1) - numbers.col(k)).norm(), p(k + 1) - p(k));
    distance(k + 1 - first) = distance(k - first) + std::max(step, level::rounding * size);
  }
  const auto value = [&](double s) {
    VectorXd result = VectorXd::Zero(rows + 1);
    for (Index k = first; k <= last; ++k) {
      double weight = 1.0;
      for (Index l = first; l <= last; ++l)
        if (l != k) weight *= (s - distance(l - first)) / (distance(k - first) - distance(l - first));
      result(0) += weight * p(k);
      result.tail(rows) += weight * numbers.col(k);
    }
    return result;
  };
  double low = distance(i - first), high = distance(i + 1 - first);
  const bool rises = p(i + 1) >= p(i);
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    ((value(middle)(0) < at) == rises ? low : high) = middle;
  }
  return value(0.5 * (low + high)).tail(rows);
}

/// Of the largest number: runs leave errors far below this, and different orbits differ by far more.
constexpr double least_uncertainty = level::same;

}  // namespace

InterpolatedPoint interpolate(const std::vector<double>& coordinate, const Eigen::MatrixXd& numbers, Index i,
                              double at) {
  const auto count = static_cast<Index>(coordinate.size());
  const Index first = std::max<Index>(0, i - 1);
  const Index last = std::min<Index>(count - 1, i + 2);
  const VectorXd best = polynomial_value(coordinate, numbers, first, last, i, at);
  const bool drops_first = last - i > i - first || last == count - 1;
  const Index nearer = last - first < 2 ? first : drops_first ? first + (first < i ? 1 : 0) : first;
  const Index farther = last - first < 2 ? last : nearer > first ? last : std::max(i + 1, last - 1);
  const VectorXd other = polynomial_value(coordinate, numbers, nearer, farther, i, at);
  return {best, (best - other).cwiseAbs()};
}

bool agrees(const InterpolatedPoint& point, const VectorXd& numbers, double size) {
  size = std::max(size, numbers.cwiseAbs().maxCoeff());
  for (Index k = 0; k < numbers.size(); ++k)
    if (!(std::abs(point.numbers(k) - numbers(k)) <= 2.0 * point.uncertainty(k) + least_uncertainty * size))
      return false;
  return true;
}

}  // namespace tchat
