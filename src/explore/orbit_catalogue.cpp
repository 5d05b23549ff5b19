#include "explore/orbit_catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "base/levels.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

bool repeats_after(const SignatureWord& word, std::size_t length) {
  for (std::size_t i = length; i < word.size(); ++i)
    if (word[i] != word[i - length]) return false;
  return true;
}

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

bool are_near(const InterpolatedPoint& orbit, const VectorXd& numbers) {
  constexpr double errors = 5.0, share = level::five_digits;
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

PrimitiveWord primitive_word(const SignatureWord& signature) {
  std::size_t length = 1;
  while (length < signature.size() && (signature.size() % length != 0 || !repeats_after(signature, length))) ++length;
  SignatureWord word(signature.begin(),
                     signature.begin() + static_cast<std::ptrdiff_t>(std::min(length, signature.size())));
  SignatureWord least = word;
  for (std::size_t shift = 1; shift < word.size(); ++shift) {
    std::rotate(word.begin(), word.begin() + 1, word.end());
    least = std::min(least, word);
  }
  return {least, signature.empty() ? 1 : static_cast<int>(signature.size() / least.size())};
}

std::vector<CataloguedSection> catalogued_sections(const std::string& branch, const PointFile& file,
                                                   const std::vector<std::string>& monitors) {
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
    one.signature = primitive_word(section.signature);
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
      if (are_near(orbit, like.rests ? numbers : with_period_of(orbit, numbers))) places.push_back({&known, i});
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

std::vector<std::string> OrbitCatalogue::branches_with(const SignatureWord& signature, double parameter, double period,
                                                       const std::vector<double>& monitors) const {
  const PrimitiveWord wanted = primitive_word(signature);
  std::vector<std::string> branches;
  for (const CataloguedSection& known : sections_) {
    if (known.rests) continue;
    const bool is_cut_alike = known.signature.word == wanted.word;
    const std::vector<InterpolatedPoint> orbits = orbits_at(known, parameter);
    const bool has_one = std::any_of(orbits.begin(), orbits.end(), [&](const InterpolatedPoint& orbit) {
      const double time = orbit.numbers(0) * known.signature.repetitions;
      const double tolerance =
          2.0 * orbit.uncertainty(0) * known.signature.repetitions + level::five_digits * std::abs(period);
      return std::abs(time - period) <= tolerance && about_agree(orbit, monitors, is_cut_alike ? coarse : fine);
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

namespace {

using Eigen::MatrixXd;

constexpr double unknown = std::numeric_limits<double>::infinity();
constexpr double least_size = 1e-3;  // of a state, as a share of the largest
constexpr Index points_compared = 12, points_of_piece = 4;
constexpr Index nodes_beside = 2;  // on each side of the nearest one
constexpr int halvings = 40;

bool is_smooth(const SignatureWord& word) { return word.size() == 1 && word.front()[1] == 0; }

/// n x m
MatrixXd ends_of_segments(const LabelledSolution& solution) {
  const Index n = solution.dimension;
  return Eigen::Map<const MatrixXd>(solution.states.rightCols(1).data(), n, solution.states.rows() / n);
}

/// n x all nodes of all segments
MatrixXd states_of(const LabelledSolution& solution) {
  return Eigen::Map<const MatrixXd>(solution.states.data(), solution.dimension,
                                    solution.states.size() / solution.dimension);
}

/// 1 / size of each state, 0 of those left out.
VectorXd weights(const MatrixXd& states, const std::vector<Index>& drifting) {
  VectorXd sizes = states.cwiseAbs().rowwise().maxCoeff();
  for (const Index k : drifting) sizes(k) = 0.0;
  const double least = least_size * sizes.maxCoeff();
  VectorXd result = sizes.cwiseMax(least).cwiseInverse();
  for (const Index k : drifting) result(k) = 0.0;
  return result.allFinite() ? result : VectorXd::Zero(result.size());
}

double distance(const VectorXd& a, const VectorXd& b, const VectorXd& weight) {
  return (a - b).cwiseProduct(weight).cwiseAbs().maxCoeff();
}

double distance_of_ends(const ComparedOrbit& a, const ComparedOrbit& b, const std::vector<Index>& drifting) {
  const MatrixXd x = ends_of_segments(*a.solution), y = ends_of_segments(*b.solution);
  if (x.cols() != std::ssize(a.signature) || y.cols() != std::ssize(b.signature)) return unknown;
  const VectorXd weight = weights(states_of(*a.solution), drifting);
  const Index both = std::lcm(x.cols(), y.cols());
  double least = unknown;
  for (Index shift = 0; shift < y.cols(); ++shift) {
    double largest = 0.0;
    for (Index k = 0; k < both && largest < least; ++k) {
      const Index i = k % x.cols(), j = (k + shift) % y.cols();
      const bool is_like = a.signature[static_cast<std::size_t>(i)] == b.signature[static_cast<std::size_t>(j)];
      largest = is_like ? std::max(largest, distance(x.col(i), y.col(j), weight)) : unknown;
    }
    least = std::min(least, largest);
  }
  return least;
}

/// The nodes of one segment, and where they are on it.
struct Piece {
  MatrixXd nodes;  ///< n x as many as `tau`
  const std::vector<double>& tau;
};

/// Those segments that last.
std::vector<Piece> pieces_of(const LabelledSolution& orbit) {
  std::vector<Piece> pieces;
  const Index n = orbit.dimension;
  const VectorXd weight = weights(states_of(orbit), {});
  for (Index row = 0; row < orbit.states.rows(); row += n) {
    const MatrixXd nodes = orbit.states.middleRows(row, n);
    const MatrixXd moved = weight.asDiagonal() * (nodes.colwise() - nodes.col(0));
    if (moved.cwiseAbs().maxCoeff() > level::orbit) pieces.push_back({nodes, orbit.tau});
  }
  return pieces;
}

/// Two events at one point leave a segment between them that takes no time; which two that is says nothing.
bool has_instants(const LabelledSolution& orbit) {
  return std::ssize(pieces_of(orbit)) * orbit.dimension < orbit.states.rows();
}

/// The state at tau of the polynomial through some nodes.
VectorXd state_at(const Piece& piece, Index first, Index last, double tau) {
  VectorXd state = VectorXd::Zero(piece.nodes.rows());
  const auto at = [&](Index k) { return piece.tau[static_cast<std::size_t>(k)]; };
  for (Index k = first; k <= last; ++k) {
    double weight = 1.0;
    for (Index l = first; l <= last; ++l)
      if (l != k) weight *= (tau - at(l)) / (at(k) - at(l));
    state += weight * piece.nodes.col(k);
  }
  return state;
}

double distance_from_piece(const VectorXd& state, const Piece& piece, const VectorXd& weight) {
  const Index nodes = piece.nodes.cols();
  Index nearest = 0;
  const auto size = [&](const VectorXd& other) { return (state - other).cwiseProduct(weight).squaredNorm(); };
  for (Index k = 1; k < nodes; ++k)
    if (size(piece.nodes.col(k)) < size(piece.nodes.col(nearest))) nearest = k;
  const Index first = std::max<Index>(0, nearest - nodes_beside);
  const Index last = std::min<Index>(nodes - 1, nearest + nodes_beside);
  const auto value = [&](double tau) { return size(state_at(piece, first, last, tau)); };
  double low = piece.tau[static_cast<std::size_t>(std::max<Index>(0, nearest - 1))];
  double high = piece.tau[static_cast<std::size_t>(std::min<Index>(nodes - 1, nearest + 1))];
  for (int k = 0; k < halvings; ++k) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (value(a) < value(b) ? high : low) = value(a) < value(b) ? b : a;
  }
  return distance(state, state_at(piece, first, last, 0.5 * (low + high)), weight);
}

/// The largest distance of points of the one, which has been reflected, from the other.
double distance_beyond(const std::vector<Piece>& one, const VectorXd& signs, const std::vector<Piece>& other,
                       const VectorXd& weight) {
  if (one.empty() || other.empty()) return unknown;
  const Index points = std::max<Index>(points_of_piece, points_compared / std::ssize(one));
  double largest = 0.0;
  for (const Piece& piece : one)
    for (Index k = 0; k < points && largest < unknown; ++k) {
      const VectorXd state = signs.cwiseProduct(piece.nodes.col(k * (piece.nodes.cols() - 1) / points));
      double least = unknown;
      for (const Piece& target : other) least = std::min(least, distance_from_piece(state, target, weight));
      largest = std::max(largest, least);
    }
  return largest;
}

/// However they are cut.
double distance_of_curves(const LabelledSolution& a, const VectorXd& signs, const LabelledSolution& b,
                          const std::vector<Index>& drifting) {
  if (std::ssize(a.tau) != a.states.cols() || std::ssize(b.tau) != b.states.cols()) return unknown;
  const VectorXd weight = weights(states_of(a), drifting);
  const std::vector<Piece> of_a = pieces_of(a), of_b = pieces_of(b);
  return std::max(distance_beyond(of_a, signs, of_b, weight), distance_beyond(of_b, signs, of_a, weight));
}

}  // namespace

namespace {

/// Why two solutions cannot be compared as periodic orbits: false.
bool are_orbits(const LabelledSolution& x, const LabelledSolution& y) {
  const int n = x.dimension;
  if (x.problem_type != y.problem_type || n != y.dimension || n < 1) return false;
  if (x.states.size() == 0 || y.states.size() == 0 || x.states.rows() % n != 0 || y.states.rows() % n != 0)
    return false;
  const FamilyFacts& facts = family_of(x.problem_type).facts();
  return !facts.headings.has_period ||
         (!keeps_contact(x.problem_type) && facts.has_return_map && !facts.has_several_returns);
}

}  // namespace

double orbit_distance(const ComparedOrbit& a, const ComparedOrbit& b, const std::vector<Index>& drifting) {
  const LabelledSolution &x = *a.solution, &y = *b.solution;
  if (!are_orbits(x, y)) return unknown;
  if (!family_of(x.problem_type).facts().headings.has_period)
    return distance(x.states.col(0), y.states.col(0), weights(x.states.leftCols(1), drifting));
  const bool are_cut_alike = primitive_word(a.signature).word == primitive_word(b.signature).word;
  const bool are_instant = has_instants(x) || has_instants(y);
  if (are_cut_alike && !is_smooth(a.signature) && !are_instant) return distance_of_ends(a, b, drifting);
  return distance_of_curves(x, VectorXd::Ones(x.dimension), y, drifting);
}

/// A state whose range is that of the other orbit keeps its sign, one whose range is the other's with the sign changed
/// changes it; where both hold, either is tried.
std::optional<std::vector<bool>> reflection(const LabelledSolution& a, const LabelledSolution& b,
                                            const std::vector<Index>& drifting, double tolerance) {
  if (!are_orbits(a, b) || !family_of(a.problem_type).facts().headings.has_period) return std::nullopt;
  const MatrixXd x = states_of(a), y = states_of(b);
  const VectorXd weight = weights(x, drifting);
  constexpr double coarse = 0.02;  // nodes lie elsewhere
  std::vector<Index> open;
  VectorXd signs = VectorXd::Ones(a.dimension);
  for (Index k = 0; k < a.dimension; ++k) {
    const double low = x.row(k).minCoeff(), high = x.row(k).maxCoeff();
    const double of_low = y.row(k).minCoeff(), of_high = y.row(k).maxCoeff();
    const bool keeps = std::max(std::abs(low - of_low), std::abs(high - of_high)) * weight(k) <= coarse;
    const bool changes = std::max(std::abs(low + of_high), std::abs(high + of_low)) * weight(k) <= coarse;
    if (!keeps && !changes) return std::nullopt;
    if (!keeps) signs(k) = -1.0;
    if (keeps && changes && weight(k) > 0.0) open.push_back(k);
  }
  constexpr std::size_t most_open = 8;
  if (open.size() > most_open) return std::nullopt;
  for (unsigned choice = 0; choice < (1U << open.size()); ++choice) {
    for (std::size_t k = 0; k < open.size(); ++k) signs(open[k]) = (choice >> k) & 1U ? -1.0 : 1.0;
    if (signs.minCoeff() > 0.0 || distance_of_curves(a, signs, b, drifting) > tolerance) continue;
    std::vector<bool> result;
    for (const double sign : signs) result.push_back(sign < 0.0);
    return result;
  }
  return std::nullopt;
}

}  // namespace tchat
