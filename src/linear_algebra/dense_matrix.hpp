/// What is asked of small dense matrices outside the Newton loop. Eigen's decompositions take long to compile: here
/// once.
#pragma once

#include <Eigen/Core>

namespace tchat {

/// Of a square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// x of matrix x = right, columns of `right` side by side; not finite where the matrix is singular.
Eigen::MatrixXd solve(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// The same with complete pivoting: finite, where the matrix is singular too.
Eigen::MatrixXd solve_with_complete_pivoting(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// Length of the shortest d with rows (x + d) = 0: of the part of x in the space of the rows, which are independent and
/// fewer than the columns. It does not depend on how large each row is.
double distance_to_null_space(const Eigen::MatrixXd& rows, const Eigen::VectorXd& x);

double least_singular_value(const Eigen::MatrixXcd& matrix);

}  // namespace tchat
