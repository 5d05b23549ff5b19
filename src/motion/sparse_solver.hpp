/// A linear solver for CVODES of many states whose equations have few of them each.
#pragma once

#include <sundials/sundials_linearsolver.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace tchat {

/// From so many states on, and up to such a share of entries that are not zero, sparse algebra is quicker.
constexpr int least_sparse_dimension = 24;
constexpr double most_sparse_share = 0.15;

/// The entries of `dense` that are not zero, where there are many states and few of them.
inline bool is_sparse(const Eigen::MatrixXd& dense) {
  const auto entries = static_cast<double>((dense.array() != 0.0).count());
  return dense.rows() >= least_sparse_dimension && entries <= most_sparse_share * static_cast<double>(dense.size());
}

/// LU factors of a dense SUNMatrix, by its entries that are not zero. The caller frees it by SUNLinSolFree.
SUNLinearSolver new_sparse_solver(SUNContext context);

}  // namespace tchat
