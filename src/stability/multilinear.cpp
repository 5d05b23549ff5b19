#include "stability/multilinear.hpp"

namespace tchat {

namespace {

constexpr double rounding_of_sums = 1e-13;  // of sums over all nodes, and of the vectors that solve sparse systems
constexpr double differences_of_values = 1e-6;
constexpr double differences_of_second = 1e-7;

}  // namespace

Product product(const Eigen::VectorXcd& w, const Eigen::VectorXcd& rows) {
  return {(w.transpose() * rows)(0), w.cwiseAbs().dot(rows.cwiseAbs())};
}

double error_of_second(const HybridSystem& system) {
  return system.table().derivative_order < 2 ? differences_of_values : rounding_of_sums;
}

double error_of_third(const HybridSystem& system) {
  if (system.has_third()) return rounding_of_sums;
  return system.table().derivative_order < 2 ? differences_of_values : differences_of_second;
}

}  // namespace tchat
