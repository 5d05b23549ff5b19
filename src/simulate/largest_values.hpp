/// max over t of each state x_k(t) along a flow, located where x_k' = f_k changes its sign from + to -.
///
/// A maximum and a minimum between two of the times that are looked at (a quarter of an integration step apart) are
/// missed; they differ by little there.
#pragma once

#include <Eigen/Core>

#include "model/hybrid_system.hpp"
#include "motion/event_watch.hpp"

namespace tchat {

class LargestValues {
 public:
  /// A view of `system` and `par`, which outlive this object.
  LargestValues(const HybridSystem& system, const Eigen::VectorXd& par);

  /// x(t) of the field from one time to another: the argument of SimulationSettings::on_piece.
  void add_piece(int field, const DenseOutput& state, double from, double to);

  /// One for each state, -infinity before any piece.
  const Eigen::VectorXd& values() const { return values_; }

 private:
  struct Look {
    double time = 0.0;
    Eigen::VectorXd state, rate;
  };
  Look look(int field, const DenseOutput& state, double time) const;
  void locate(int field, const DenseOutput& state, Eigen::Index k, double rising, double falling);

  const HybridSystem& system_;
  const Eigen::VectorXd& par_;
  Eigen::VectorXd values_;
};

}  // namespace tchat
