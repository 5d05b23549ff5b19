#include "stability/multilinear.hpp"

namespace tchat {

namespace {

constexpr double rounding_of_sums = 1e-13;  // of sums over all nodes, and of the vectors that solve sparse systems

}  // namespace

Product product(const Eigen::VectorXcd& w, const Eigen::VectorXcd& rows) {
  return {(w.transpose() * rows)(0), w.cwiseAbs().dot(rows.cwiseAbs())};
}

double error_of_sums(const HybridSystem& system) {
  if (system.has_third()) return rounding_of_sums;
  constexpr double of_second = 1e-6, of_third = 1e-7;
  return system.table().derivative_order < 2 ? of_second : of_third;
}

}  // namespace tchat
