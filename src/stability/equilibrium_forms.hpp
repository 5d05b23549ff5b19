/// The derivatives of a field at an equilibrium, of the states that its mode has.
#pragma once

#include <Eigen/Core>
#include <array>

#include "orbit/defining_system.hpp"

namespace tchat {

class EquilibriumForms {
 public:
  /// Both outlive this object.
  EquilibriumForms(const DefiningSystem& system, const Orbit& x);

  int states() const { return states_; }
  const HybridSystem& system() const { return system_.system(); }
  Eigen::VectorXd field() const { return field_; }
  Eigen::MatrixXd jacobian() const { return by_state_; }  ///< f_x
  /// f_p of the first free parameter.
  Eigen::VectorXd by_parameter() const { return by_parameter_; }

  /// f_xx u v and f_xxx u v w.
  Eigen::VectorXd second(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const { return part({&u, &v, nullptr}); }
  Eigen::VectorXd third(const Eigen::VectorXd& u, const Eigen::VectorXd& v, const Eigen::VectorXd& w) const {
    return part({&u, &v, &w});
  }
  /// The second derivative in two directions by the states and the first free parameter, which is their last entry.
  Eigen::VectorXd second_with_parameter(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const;

 private:
  Eigen::VectorXd part(const std::array<const Eigen::VectorXd*, 3>& directions) const;
  int field_index() const { return system_.signature().front().field; }

  const DefiningSystem& system_;
  const Orbit& x_;
  int states_;
  Eigen::VectorXd field_, by_parameter_;
  Eigen::MatrixXd by_state_;
};

}  // namespace tchat
