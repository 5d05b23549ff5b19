#include "motion/sparse_solver.hpp"

#include <nvector/nvector_serial.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <Eigen/SparseLU>

namespace tchat {

namespace {

using Factors = Eigen::SparseLU<Eigen::SparseMatrix<double>>;

Factors& factors_of(SUNLinearSolver solver) { return *static_cast<Factors*>(solver->content); }

int set_up(SUNLinearSolver solver, SUNMatrix matrix) {
  const Eigen::Index n = SUNDenseMatrix_Rows(matrix);
  const Eigen::Map<const Eigen::MatrixXd> dense(SUNDenseMatrix_Data(matrix), n, n);
  Eigen::SparseMatrix<double> sparse = dense.sparseView();
  sparse.makeCompressed();
  Factors& factors = factors_of(solver);
  factors.compute(sparse);
  return factors.info() == Eigen::Success ? SUNLS_SUCCESS : SUNLS_LUFACT_FAIL;  // singular: with a smaller step
}

int solve(SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, realtype) {
  const Eigen::Index n = N_VGetLength_Serial(b);
  const Eigen::Map<const Eigen::VectorXd> right(N_VGetArrayPointer(b), n);
  Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(x), n) = factors_of(solver).solve(right);
  return SUNLS_SUCCESS;
}

int release(SUNLinearSolver solver) {
  delete &factors_of(solver);
  solver->content = nullptr;
  SUNLinSolFreeEmpty(solver);
  return SUNLS_SUCCESS;
}

}  // namespace

SUNLinearSolver new_sparse_solver(SUNContext context) {
  SUNLinearSolver solver = SUNLinSolNewEmpty(context);
  solver->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
  solver->ops->initialize = [](SUNLinearSolver) { return static_cast<int>(SUNLS_SUCCESS); };
  solver->ops->setup = &set_up;
  solver->ops->solve = &solve;
  solver->ops->free = &release;
  solver->content = new Factors;
  return solver;
}

}  // namespace tchat
