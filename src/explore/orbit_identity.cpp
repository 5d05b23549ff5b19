#include "explore/orbit_identity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "settings/problem_type.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double unknown = std::numeric_limits<double>::infinity();
constexpr double least_size = 1e-3;  // of a state, as a share of the largest
constexpr Index points_compared = 12;
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

/// The state at tau of the polynomial through some nodes of the orbit.
VectorXd state_at(const LabelledSolution& orbit, Index first, Index last, double tau) {
  VectorXd state = VectorXd::Zero(orbit.states.rows());
  const auto at = [&](Index k) { return orbit.tau[static_cast<std::size_t>(k)]; };
  for (Index k = first; k <= last; ++k) {
    double weight = 1.0;
    for (Index l = first; l <= last; ++l)
      if (l != k) weight *= (tau - at(l)) / (at(k) - at(l));
    state += weight * orbit.states.col(k);
  }
  return state;
}

double distance_from_curve(const VectorXd& state, const LabelledSolution& orbit, const VectorXd& weight) {
  const Index nodes = orbit.states.cols();
  Index nearest = 0;
  const auto size = [&](const VectorXd& other) { return (state - other).cwiseProduct(weight).squaredNorm(); };
  for (Index k = 1; k < nodes; ++k)
    if (size(orbit.states.col(k)) < size(orbit.states.col(nearest))) nearest = k;
  const Index first = std::max<Index>(0, nearest - nodes_beside);
  const Index last = std::min<Index>(nodes - 1, nearest + nodes_beside);
  double low = orbit.tau[static_cast<std::size_t>(std::max<Index>(0, nearest - 1))];
  double high = orbit.tau[static_cast<std::size_t>(std::min<Index>(nodes - 1, nearest + 1))];
  for (int k = 0; k < halvings; ++k) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (size(state_at(orbit, first, last, a)) < size(state_at(orbit, first, last, b)) ? high : low) =
        size(state_at(orbit, first, last, a)) < size(state_at(orbit, first, last, b)) ? b : a;
  }
  return distance(state, state_at(orbit, first, last, 0.5 * (low + high)), weight);
}

double distance_of_curves(const LabelledSolution& a, const LabelledSolution& b, const std::vector<Index>& drifting) {
  if (std::ssize(b.tau) != b.states.cols()) return unknown;
  const VectorXd weight = weights(a.states, drifting);
  double largest = 0.0;
  for (Index k = 0; k < points_compared; ++k)
    largest =
        std::max(largest, distance_from_curve(a.states.col(k * (a.states.cols() - 1) / points_compared), b, weight));
  return largest;
}

}  // namespace

double orbit_distance(const ComparedOrbit& a, const ComparedOrbit& b, const std::vector<Index>& drifting) {
  const LabelledSolution &x = *a.solution, &y = *b.solution;
  const int n = x.dimension;
  if (x.problem_type != y.problem_type || n != y.dimension || n < 1) return unknown;
  if (x.states.size() == 0 || y.states.size() == 0 || x.states.rows() % n != 0 || y.states.rows() % n != 0)
    return unknown;
  if (x.problem_type == equilibrium.number)
    return distance(x.states.col(0), y.states.col(0), weights(x.states.leftCols(1), drifting));
  if (x.problem_type != periodic_orbit.number) return unknown;
  if (!is_smooth(a.signature)) return distance_of_ends(a, b, drifting);
  return is_smooth(b.signature) ? distance_of_curves(x, y, drifting) : unknown;
}

}  // namespace tchat
