#include "orbit/surface_rate.hpp"

#include "model/mode_dimensions.hpp"

namespace tchat {

SurfaceRate::SurfaceRate(int dimension, int free_count)
    : hx(dimension),
      hp(free_count),
      rate_x(dimension),
      rate_p(free_count),
      f_(dimension),
      direction_(Eigen::VectorXd::Zero(dimension + free_count)),
      fx_(dimension, dimension),
      fp_(dimension, free_count) {}

void SurfaceRate::evaluate(const HybridSystem& system, const IndexVector& v, const double* x, const double* par,
                           const std::vector<int>& free_parameters) {
  system.first(FunctionKind::field, v.field, x, par, free_parameters, f_.data(), fx_.data(), fp_.data());
  system.first(FunctionKind::event, v.event, x, par, free_parameters, &h, hx.data(), hp.data());
  // d (h_x f) = h_xx f + h_x f_x: the first part is the second derivative in the direction (f, 0).
  direction_.head(f_.size()) = f_;
  system.second(FunctionKind::event, v.event, x, par, free_parameters, direction_.data(), &rate, rate_x.data(),
                rate_p.data());
  for (Eigen::Index b = 0; b < hx.size(); ++b) rate_x(b) += fx_.col(b).dot(hx);
  for (Eigen::Index k = 0; k < hp.size(); ++k) rate_p(k) += fp_.col(k).dot(hx);
  clear_absent(system, v.field, hx);
  clear_absent(system, v.field, rate_x);
}

}  // namespace tchat
