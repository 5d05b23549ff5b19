#include "stability/segment_map.hpp"

#include "linear/dense_matrix.hpp"
#include "model/event_at.hpp"

namespace tchat {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

SegmentMap segment_map(const CondensedSystem& condensed, const Orbit& x, int s) {
  const DefiningSystem& defining = condensed.system();
  const HybridSystem& system = defining.system();
  const int n = x.shape.dimension;
  const IndexVector& index = defining.signature()[static_cast<std::size_t>(s)];
  const Eigen::MatrixXd a = Eigen::Map<const RowMajor>(condensed.first_block(s), n, n);
  const Eigen::MatrixXd c = Eigen::Map<const RowMajor>(condensed.last_block(s), n, n);
  const Eigen::MatrixXd flow = solve(c, -a);

  Eigen::VectorXd f(n);
  Eigen::VectorXd section(n);
  system.value(FunctionKind::field, index.field, x.end(s), x.par.data(), f.data());
  defining.section_gradient(s, x.end(s), x.par.data(), section.data());

  SegmentMap map;
  map.to_duration = change_of_time(f, section, flow);
  map.to_end = flow + f * map.to_duration;
  map.to_next = jump_at(system, index.jump, x.end(s), x.par.data()).derivative * map.to_end;
  return map;
}

Eigen::MatrixXd return_matrix(const CondensedSystem& condensed, const Orbit& x, int first, int last) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(x.shape.dimension, x.shape.dimension);
  for (int s = first; s < last; ++s) matrix = segment_map(condensed, x, s).to_next * matrix;
  return matrix;
}

}  // namespace tchat
