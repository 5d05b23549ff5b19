#include "support/random_matrices.hpp"

#include <algorithm>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "support/decompositions.hpp"

template class Eigen::PartialPivLU<Eigen::MatrixXd>;
template class Eigen::FullPivLU<Eigen::MatrixXd>;
template class Eigen::HouseholderQR<Eigen::MatrixXd>;
template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
template class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

// LAPACK: generalised eigenvalues (alpha_r + i alpha_i) / beta of the pair (a, b), which are overwritten.
extern "C" void dggev_(const char* left, const char* right, const int* n, double* a, const int* lda, double* b,
                       const int* ldb, double* alpha_r, double* alpha_i, double* beta, double* vl, const int* ldvl,
                       double* vr, const int* ldvr, double* work, const int* length, int* info);

// LAPACK: eigenvalues real + i imaginary of `a`, which is overwritten.
extern "C" void dgeev_(const char* left, const char* right, const int* n, double* a, const int* lda, double* real,
                       double* imaginary, double* vl, const int* ldvl, double* vr, const int* ldvr, double* work,
                       const int* length, int* info);

// LAPACK: singular values of `a`, which is overwritten.
extern "C" void dgesvd_(const char* job_u, const char* job_vt, const int* rows, const int* columns, double* a,
                        const int* lda, double* values, double* u, const int* ldu, double* vt, const int* ldvt,
                        double* work, const int* length, int* info);

namespace tchat::test {

Eigen::MatrixXd random_matrix(std::mt19937& generator, int rows, int columns) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(generator); });
}

Eigen::MatrixXd random_orthogonal(std::mt19937& generator, int n) {
  return random_matrix(generator, n, n).householderQr().householderQ();
}

std::pair<int, double> sign_and_log2_of_determinant(const Eigen::MatrixXd& matrix) {
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(matrix);
  auto sign = static_cast<int>(lu.permutationP().determinant() * lu.permutationQ().determinant());
  double log2_size = 0.0;
  for (const double pivot : lu.matrixLU().diagonal()) {
    if (pivot < 0.0) sign = -sign;
    log2_size += std::log2(std::abs(pivot));
  }
  return {sign, log2_size};
}

double determinant(const Eigen::MatrixXd& matrix) { return matrix.determinant(); }

Eigen::VectorXd solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) { return a.partialPivLu().solve(b); }

Eigen::VectorXcd complex_solution(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::VectorXd closest_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd exponential(const Eigen::MatrixXd& a) { return a.exp(); }

Eigen::VectorXcd lapack_eigenvalues(Eigen::MatrixXd a) {
  const int n = static_cast<int>(a.rows()), length = 8 * n, one = 1;
  Eigen::VectorXd real(n), imaginary(n), work(length);
  int info = 0;
  double none = 0.0;
  dgeev_("N", "N", &n, a.data(), &n, real.data(), imaginary.data(), &none, &one, &none, &one, work.data(), &length,
         &info);
  if (info != 0) throw std::runtime_error("dgeev found no eigenvalues");
  Eigen::VectorXcd values(n);
  values.real() = real;
  values.imag() = imaginary;
  return values;
}

double condition_number(const Eigen::MatrixXd& matrix) {
  const int rows = static_cast<int>(matrix.rows()), columns = static_cast<int>(matrix.cols()), one = 1;
  const int length = 8 * (rows + columns);
  Eigen::MatrixXd a = matrix;
  Eigen::VectorXd values(std::min(rows, columns)), work(length);
  int info = 0;
  double none = 0.0;
  dgesvd_("N", "N", &rows, &columns, a.data(), &rows, values.data(), &none, &one, &none, &one, work.data(), &length,
          &info);
  if (info != 0) throw std::runtime_error("dgesvd found no singular values");
  return values(0) / values(values.size() - 1);
}

std::vector<std::complex<double>> finite_eigenvalues(Eigen::MatrixXd a, Eigen::MatrixXd e) {
  const int n = static_cast<int>(a.rows()), length = 16 * n, one = 1;
  Eigen::VectorXd real(n), imaginary(n), beta(n), work(length);
  int info = 0;
  double none = 0.0;
  dggev_("N", "N", &n, a.data(), &n, e.data(), &n, real.data(), imaginary.data(), beta.data(), &none, &one, &none, &one,
         work.data(), &length, &info);
  if (info != 0) throw std::runtime_error("dggev found no eigenvalues");
  std::vector<std::complex<double>> values;
  for (int k = 0; k < n; ++k) {
    const std::complex<double> alpha(real(k), imaginary(k));
    if (std::abs(beta(k)) > 1e-10 * std::abs(alpha)) values.push_back(alpha / beta(k));
  }
  return values;
}

}  // namespace tchat::test
