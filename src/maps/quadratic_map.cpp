#include "maps/quadratic_map.hpp"

namespace tchat {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd QuadraticMap::operator()(const VectorXd& z) const {
  const VectorXd u = z - at;
  VectorXd image = value + first * u;
  for (std::size_t i = 0; i < second.size(); ++i) image(static_cast<Eigen::Index>(i)) += 0.5 * u.dot(second[i] * u);
  return image;
}

MatrixXd QuadraticMap::derivative(const VectorXd& z) const {
  MatrixXd jacobian = first;
  const VectorXd u = z - at;
  for (std::size_t i = 0; i < second.size(); ++i)
    jacobian.row(static_cast<Eigen::Index>(i)) += (second[i] * u).transpose();
  return jacobian;
}

}  // namespace tchat
