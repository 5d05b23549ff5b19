#include "motion/orbit_identity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/levels.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double unlike = std::numeric_limits<double>::infinity();
constexpr Index points_compared = 400, least_points = 4;  // two orbits may differ in one passage of many
constexpr Index nodes_beside = 2;                         // on each side of the nearest one
constexpr int halvings = 40;

bool repeats_after(const Signature& word, std::size_t length) {
  for (std::size_t i = length; i < word.size(); ++i)
    if (word[i] != word[i - length]) return false;
  return true;
}

/// 0 of states that are left out.
VectorXd weights(const VectorXd& sizes) { return sizes.cwiseMax(std::numeric_limits<double>::min()).cwiseInverse(); }

VectorXd weights(const ComparedOrbit& a, const ComparedOrbit& b) { return weights(a.sizes.cwiseMax(b.sizes)); }

double distance(const VectorXd& a, const VectorXd& b, const VectorXd& weight) {
  return (a - b).cwiseProduct(weight).cwiseAbs().maxCoeff();
}

bool is_smooth(const Signature& word) { return word.size() == 1 && word.front().event == no_function; }

/// The nodes of one segment, and where they are on it.
struct Piece {
  const MatrixXd& nodes;  ///< n x as many as `tau`
  const std::vector<double>& tau;
};

/// Those segments that last.
std::vector<Piece> pieces_of(const ComparedOrbit& orbit) {
  std::vector<Piece> pieces;
  for (const MatrixXd& nodes : orbit.segments) {
    const MatrixXd moved = weights(orbit.sizes).asDiagonal() * (nodes.colwise() - nodes.col(0));
    if (moved.cwiseAbs().maxCoeff() > level::orbit) pieces.push_back({nodes, orbit.tau});
  }
  return pieces;
}

/// Two events at one point leave a segment between them that takes no time; which two that is says nothing.
bool has_instants(const ComparedOrbit& orbit) { return pieces_of(orbit).size() < orbit.segments.size(); }

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

/// From the piece beside one of its nodes.
double distance_beside(const VectorXd& state, const Piece& piece, Index node, const VectorXd& weight) {
  const Index nodes = piece.nodes.cols();
  const Index first = std::max<Index>(0, node - nodes_beside);
  const Index last = std::min<Index>(nodes - 1, node + nodes_beside);
  const auto value = [&](double tau) {
    return (state - state_at(piece, first, last, tau)).cwiseProduct(weight).squaredNorm();
  };
  double low = piece.tau[static_cast<std::size_t>(std::max<Index>(0, node - 1))];
  double high = piece.tau[static_cast<std::size_t>(std::min<Index>(nodes - 1, node + 1))];
  for (int k = 0; k < halvings; ++k) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (value(a) < value(b) ? high : low) = value(a) < value(b) ? b : a;
  }
  return distance(state, state_at(piece, first, last, 0.5 * (low + high)), weight);
}

/// Where an orbit passes several times, its nodes may be nearer on another passage: each passage is looked at.
double distance_from_piece(const VectorXd& state, const Piece& piece, const VectorXd& weight) {
  const Index nodes = piece.nodes.cols();
  const MatrixXd scaled = weight.asDiagonal() * (piece.nodes.colwise() - state);
  const VectorXd away = scaled.colwise().norm();
  const auto reach = [&](Index k) {
    return std::max(k > 0 ? (scaled.col(k) - scaled.col(k - 1)).norm() : 0.0,
                    k + 1 < nodes ? (scaled.col(k + 1) - scaled.col(k)).norm() : 0.0);
  };
  double least = unlike;
  for (Index k = 0; k < nodes; ++k) {
    const bool falls = k == 0 || away(k) <= away(k - 1), rises = k + 1 == nodes || away(k) <= away(k + 1);
    if (falls && rises && away(k) - reach(k) <= least)
      least = std::min(least, distance_beside(state, piece, k, weight));
  }
  return least;
}

/// The largest distance of points of the one, which has been reflected, from the other.
double distance_beyond(const std::vector<Piece>& one, const VectorXd& signs, const std::vector<Piece>& other,
                       const VectorXd& weight) {
  if (one.empty() || other.empty()) return unlike;
  const Index wanted = std::max<Index>(least_points, points_compared / std::ssize(one));
  double largest = 0.0;
  for (const Piece& piece : one) {
    const Index points = std::min<Index>(wanted, piece.nodes.cols() - 1);
    for (Index k = 0; k < points && largest < unlike; ++k) {
      const VectorXd state = signs.cwiseProduct(piece.nodes.col(k * (piece.nodes.cols() - 1) / points));
      double least = unlike;
      for (const Piece& target : other) least = std::min(least, distance_from_piece(state, target, weight));
      largest = std::max(largest, least);
    }
  }
  return largest;
}

/// However they are cut.
double distance_of_curves(const ComparedOrbit& a, const VectorXd& signs, const ComparedOrbit& b) {
  const VectorXd weight = weights(a, b);
  const std::vector<Piece> of_a = pieces_of(a), of_b = pieces_of(b);
  return std::max(distance_beyond(of_a, signs, of_b, weight), distance_beyond(of_b, signs, of_a, weight));
}

/// May they be periods of one orbit, run round more or less often?
bool are_multiples(double a, double b) {
  if (!(a > 0.0) || !(b > 0.0)) return true;
  const double ratio = std::max(a, b) / std::min(a, b);
  return std::abs(ratio - std::round(ratio)) <= level::same * ratio;
}

struct Extremes {
  VectorXd low, high;
};

Extremes extremes_of(const ComparedOrbit& orbit) {
  Extremes of{orbit.segments.front().rowwise().minCoeff(), orbit.segments.front().rowwise().maxCoeff()};
  for (const MatrixXd& nodes : orbit.segments) {
    of.low = of.low.cwiseMin(nodes.rowwise().minCoeff());
    of.high = of.high.cwiseMax(nodes.rowwise().maxCoeff());
  }
  return of;
}

}  // namespace

PrimitiveWord primitive_word(const Signature& signature) {
  std::size_t length = 1;
  while (length < signature.size() && (signature.size() % length != 0 || !repeats_after(signature, length))) ++length;
  Signature word(signature.begin(),
                 signature.begin() + static_cast<std::ptrdiff_t>(std::min(length, signature.size())));
  Signature least = word;
  for (std::size_t shift = 1; shift < word.size(); ++shift) {
    std::rotate(word.begin(), word.begin() + 1, word.end());
    least = std::min(least, word);
  }
  return {least, signature.empty() ? 1 : static_cast<int>(signature.size() / least.size())};
}

CutComparison compare_cuts(const ComparedOrbit& a, const ComparedOrbit& b) {
  CutComparison nearest;
  const Index of_a = a.ends.cols(), of_b = b.ends.cols();
  if (of_a != std::ssize(a.signature) || of_b != std::ssize(b.signature) || of_a == 0 || of_b == 0) return nearest;
  const VectorXd weight = weights(a, b);
  const Index both = std::lcm(of_a, of_b);
  for (Index shift = 0; shift < of_b; ++shift) {
    double largest = 0.0;
    for (Index k = 0; k < both && largest < nearest.distance; ++k) {
      const Index i = k % of_a, j = (k + shift) % of_b;
      const bool is_like = a.signature[static_cast<std::size_t>(i)] == b.signature[static_cast<std::size_t>(j)];
      largest = is_like ? std::max(largest, distance(a.ends.col(i), b.ends.col(j), weight)) : unlike;
    }
    if (largest < nearest.distance) nearest = {largest, shift};
  }
  return nearest;
}

double orbit_distance(const ComparedOrbit& a, const ComparedOrbit& b) {
  if (a.sizes.size() != b.sizes.size()) return unlike;
  const bool are_cut_alike = primitive_word(a.signature).word == primitive_word(b.signature).word;
  if (are_cut_alike && !is_smooth(a.signature) && !has_instants(a) && !has_instants(b))
    return compare_cuts(a, b).distance;
  if (!are_multiples(a.period, b.period)) return unlike;
  return distance_of_curves(a, VectorXd::Ones(a.sizes.size()), b);
}

/// A state whose range is that of the other orbit keeps its sign, one whose range is the other's with the sign changed
/// changes it; where both hold, either is tried.
std::optional<std::vector<bool>> reflection(const ComparedOrbit& a, const ComparedOrbit& b, double tolerance) {
  if (a.segments.empty() || b.segments.empty() || a.sizes.size() != b.sizes.size()) return std::nullopt;
  constexpr double coarse = 0.02;  // nodes lie elsewhere
  const VectorXd weight = weights(a, b);
  const Extremes of_a = extremes_of(a), of_b = extremes_of(b);
  std::vector<Index> open;
  VectorXd signs = VectorXd::Ones(weight.size());
  for (Index k = 0; k < weight.size(); ++k) {
    const double low = of_a.low(k), high = of_a.high(k);
    const bool keeps = std::max(std::abs(low - of_b.low(k)), std::abs(high - of_b.high(k))) * weight(k) <= coarse;
    const bool changes = std::max(std::abs(low + of_b.high(k)), std::abs(high + of_b.low(k))) * weight(k) <= coarse;
    if (!keeps && !changes) return std::nullopt;
    if (!keeps) signs(k) = -1.0;
    if (keeps && changes && weight(k) > 0.0) open.push_back(k);
  }
  constexpr std::size_t most_open = 8;
  if (open.size() > most_open) return std::nullopt;
  for (unsigned choice = 0; choice < (1U << open.size()); ++choice) {
    for (std::size_t k = 0; k < open.size(); ++k) signs(open[k]) = (choice >> k) & 1U ? -1.0 : 1.0;
    if (signs.minCoeff() > 0.0 || distance_of_curves(a, signs, b) > tolerance) continue;
    std::vector<bool> result;
    for (const double sign : signs) result.push_back(sign < 0.0);
    return result;
  }
  return std::nullopt;
}

}  // namespace tchat
