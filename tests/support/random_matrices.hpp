/// Random matrices, and what is compared with on them: dense linear algebra of other hands, compiled once for all
/// tests.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <random>
#include <utility>
#include <vector>

namespace tchat::test {

/// Entries are normally distributed.
Eigen::MatrixXd random_matrix(std::mt19937& generator, int rows, int columns);

Eigen::MatrixXd random_orthogonal(std::mt19937& generator, int n);

double determinant(const Eigen::MatrixXd& matrix);
/// Its sign and the logarithm to base 2 of its magnitude, by Eigen's LU decomposition with complete pivoting.
std::pair<int, double> sign_and_log2_of_determinant(const Eigen::MatrixXd& matrix);

/// x with A x = b, by Eigen's LU decomposition with partial pivoting.
Eigen::VectorXd solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::VectorXcd complex_solution(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b);

/// x with the least |A x - b|, by Eigen's QR decomposition with pivoting.
Eigen::VectorXd closest_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// e^A, by Eigen.
Eigen::MatrixXd exponential(const Eigen::MatrixXd& a);

/// All eigenvalues, by LAPACK's dgeev: Eigen's solvers are compiled in seconds for each kind of matrix.
Eigen::VectorXcd lapack_eigenvalues(Eigen::MatrixXd a);

/// Quotient of the largest and the least singular value.
double condition_number(const Eigen::MatrixXd& matrix);

/// mu with det(A - mu E) = 0, by LAPACK's dggev; values beyond 1e10 (E singular) are left out.
std::vector<std::complex<double>> finite_eigenvalues(Eigen::MatrixXd a, Eigen::MatrixXd e);

}  // namespace tchat::test
