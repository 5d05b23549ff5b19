#include "kinds/return_pencil.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense_matrix.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// h_x f / (|h_x| |f|) below this: not divided by.
constexpr double contact_level = 1e-3;
constexpr double infinite = 1e99;
/// Beyond this a multiplier is compared by its reciprocal.
constexpr double huge = 1e6;
/// mu = shift + 1 / nu: a shift that no problem has for a multiplier.
constexpr double shift = 0.73194651;

MatrixXd with_column(const MatrixXd& matrix, const Eigen::VectorXd& column) {
  MatrixXd result(matrix.rows(), matrix.cols() + 1);
  result << matrix, column;
  return result;
}

void sort_by_modulus(std::vector<Complex>& values) {
  std::sort(values.begin(), values.end(), [](const Complex& a, const Complex& b) {
    const double difference = std::abs(a) - std::abs(b);
    return difference != 0.0 ? difference > 0.0 : a.imag() > b.imag();
  });
}

double difference(const Complex& a, const Complex& b) {
  if (std::max(std::abs(a), std::abs(b)) > huge && a != 0.0 && b != 0.0) return std::abs(1.0 / a - 1.0 / b);
  return std::abs(a - b) / std::max(1.0, std::abs(a));
}

}  // namespace

ReturnPencil::ReturnPencil(const std::vector<SegmentLink>& links) : dimension_(links.front().flow.rows()) {
  const Index n = dimension_;
  MatrixXd state = MatrixXd::Identity(n, n);  // [R Q]
  MatrixXd conditions(0, n);                  // [C D]
  for (const SegmentLink& link : links) {
    MatrixXd end = link.flow * state;
    const double velocity = link.hx.dot(link.f);
    const double size = link.hx.norm() * link.f.norm();
    if (std::abs(velocity) > contact_level * size) {
      end -= link.f * (link.hx * end) / velocity;
    } else {
      const double f_size = link.f.norm() > 0.0 ? link.f.norm() : 1.0;
      const double h_size = link.hx.norm() > 0.0 ? link.hx.norm() : 1.0;
      end = with_column(end, link.f / f_size);
      MatrixXd extended = MatrixXd::Zero(conditions.rows() + 1, end.cols());
      extended.topLeftCorner(conditions.rows(), conditions.cols()) = conditions;
      extended.bottomRows(1) = link.hx * end / h_size;
      conditions = extended;
    }
    state = link.gx * end;
  }
  a_.resize(n + conditions.rows(), state.cols());
  a_ << state, conditions;
}

std::vector<Complex> ReturnPencil::multipliers() const {
  const Index n = dimension_;
  std::vector<Complex> values;
  if (!a_.allFinite()) return values;
  if (a_.rows() == n) {
    const Eigen::VectorXcd mu = eigenvalues(a_);
    values.assign(mu.begin(), mu.end());
    sort_by_modulus(values);
    return values;
  }
  MatrixXd b = MatrixXd::Zero(a_.rows(), a_.cols());
  b.topLeftCorner(n, n).setIdentity();
  const MatrixXd inverted = solve_with_complete_pivoting(a_ - shift * b, b);
  const Eigen::VectorXcd nu = eigenvalues(inverted);
  std::vector<Complex> reciprocals(nu.begin(), nu.end());
  sort_by_modulus(reciprocals);
  reciprocals.resize(static_cast<std::size_t>(n));  // those dropped are the conditions' own, infinite
  for (const Complex& value : reciprocals)
    values.push_back(std::abs(value) > 1.0 / infinite ? shift + 1.0 / value : Complex(infinite));
  sort_by_modulus(values);
  return values;
}

bool ReturnPencil::determines_multipliers(double tolerance) const {
  const Complex elsewhere(-0.36871, 0.51932);
  return a_.rows() == dimension_ || backward_error(elsewhere) > tolerance || backward_error(shift) > tolerance;
}

double ReturnPencil::backward_error(Complex mu) const {
  MatrixXcd difference = a_.cast<Complex>();
  for (Index i = 0; i < dimension_; ++i) difference(i, i) -= mu;
  return least_singular_value(difference) / (a_.norm() + std::abs(mu));
}

double largest_difference(std::vector<Complex> stored, std::vector<Complex> computed) {
  sort_by_modulus(stored);
  double largest = 0.0;
  for (std::size_t k = 0; k + 1 < stored.size() && !computed.empty(); ++k) {
    const auto nearest = std::min_element(computed.begin(), computed.end(), [&](const Complex& a, const Complex& b) {
      return difference(stored[k], a) < difference(stored[k], b);
    });
    largest = std::max(largest, difference(stored[k], *nearest));
    computed.erase(nearest);
  }
  return largest;
}

}  // namespace tchat
