/// Tangent vectors along a trajectory, and one turn of a simulation with its derivative.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "motion/growth_series.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/watched_flow.hpp"

namespace tchat {

// Tangent vectors carried along a known trajectory x(t) of a field: V' = A(t) V, A(t) = f_x(x(t), p).
//
// One step is V -> exp(Omega) V with Omega the Magnus series to sixth order from A at the three Gauss points (Blanes,
// Casas, Oteo and Ros, Physics Reports 470, 2009, section 5.4): with h the step, A_1, A_2, A_3 in order,
//
//     a1 = h A_2,   a2 = sqrt(15)/3 h (A_3 - A_1),   a3 = 10/3 h (A_3 - 2 A_2 + A_1),
//     C1 = [a1, a2],   C2 = -1/60 [a1, 2 a3 + C1],
//     Omega = a1 + a3 / 12 + 1/240 [-20 a1 - a3 + C1, a2 + C2].
//
// Exact, whatever the step, where A is constant. To fourth order the last term is -1/12 [a1, a2]; where the difference
// of both is too large, or A changes too much for its quadrature, or |h A| is so large that columns would become
// parallel, the step is halved. Of states that are known to 1e-9 or less fourth order does, from A at both ends of the
// step and its middle, of which the first is the last one of the step before:
//
//     a1 = h/6 (A_1 + 4 A_2 + A_3),   a2 = h (A_3 - A_1),   Omega = a1 - 1/12 [a1, a2],
//
// with an error of about |[a1, a2]| (|a1|^2 / 720 + |a2| / 240). All of that is judged in units of the sizes of states,
// where these are far from 1, and in units that balance A where it is too large for the step. Allocates nothing after
// construction, but of many states with few entries in f_x, where the matrices are sparse.

class TangentFlow {
 public:
  /// Views of `system` and `par`, which outlive this object. `tolerance`: of the steps of x(t), relative.
  TangentFlow(const HybridSystem& system, const Eigen::VectorXd& par, double tolerance);

  /// Carries `frame` from one time to the next, and makes it orthonormal where it may have lost some digits. False when
  /// f_x has no finite value on the way, or is so large that it takes too many steps; the frame is then as far as it
  /// came.
  bool carry(OrthonormalFrame& frame, int field, const DenseOutput& state, double from, double to);
  /// V -> Phi V for n x K vectors, Phi the Jacobian of the flow from one time to the next. False as above.
  bool carry(Eigen::MatrixXd& vectors, int field, const DenseOutput& state, double from, double to);
  /// Why the last carry() has failed.
  bool takes_too_many_steps() const { return takes_too_many_steps_; }
  /// Sizes of the states, n, as in model/scales.hpp; before the first call they count as 1.
  void use_sizes(const Eigen::VectorXd& sizes);
  /// The frame has been made orthonormal by others.
  void restart() { stretched_ = 0.0; }

 private:
  template <class Stretched>
  bool carry(Eigen::MatrixXd& vectors, int field, const DenseOutput& state, double from, double to,
             const Stretched& stretched);
  /// What Omega is made of, as above.
  template <class Matrix>
  struct Series {
    Matrix a1, a2, a3, c1, c2, b, omega;
  };
  template <class Matrix>
  void magnus(Series<Matrix>& series);
  template <class Matrix>
  void rough_magnus(Series<Matrix>& series);
  bool series(int field, const DenseOutput& state, double from, double step);
  bool rough_series(int field, const DenseOutput& state, double from, double step);
  void keep_last(double to);
  bool balance();
  bool evaluate(int field, const double* x, Eigen::MatrixXd& out);
  int terms(double enough) const;
  void apply_exponential(Eigen::MatrixXd& vectors);
  void to_units(Eigen::MatrixXd& vectors) const;
  void from_units(Eigen::MatrixXd& vectors) const;

  const HybridSystem& system_;
  const Eigen::VectorXd& par_;
  bool is_rough_;
  bool takes_too_many_steps_ = false;
  double stretched_ = 0.0;                 // sum of |Omega| since the frame was orthonormal
  double norm_ = 0.0, difference_ = 0.0;   // of Omega; from fourth order
  double changes_ = 0.0;                   // of A over the step, as a share of what is allowed
  Eigen::MatrixXd first_, middle_, last_;  // A
  double known_at_ = -1.0;                 // fourth order: the time of first_
  int known_field_ = 0;
  Series<Eigen::MatrixXd> dense_;
  Series<Eigen::SparseMatrix<double>> sparse_;
  bool has_few_entries_ = false;  // A, that are not zero: the sparse series is that of this step
  Eigen::MatrixXd term_, product_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows_, row_term_, row_product_;
  Eigen::VectorXd f_;
  Eigen::VectorXd units_;  // powers of two next to the sizes
  bool has_units_ = false;
};

// One turn of a simulation, from the state in which an event is met to that of a later one, with its derivative.
//
//     y -> R(y),   M = R_y = P_m Phi_m g_{k_{m-1},x} ... P_1 Phi_1 g_{k_m,x},   P_s = Id - f h_x / (h_x f)    (2.26)
//
// States are those before the jumps; Phi_s is the Jacobian of the flow over segment s, k_m the jump of the event that
// the simulation has just met. All events that the simulation watches are watched.

struct SimulatedTurn {
  std::vector<SimulatedSegment> segments;
  Eigen::MatrixXd derivative;  ///< M, n x n; empty when it was not wanted
  std::string fault;           ///< why there is no such turn; "" when there is
  bool is_smooth = true;       ///< false: the fault is that a derivative does not exist

  const Eigen::VectorXd& end() const { return segments.back().end; }  ///< R(y), n
};

/// From the last event of `at`, met in the state y, as long as segments end by `expected`. A segment that ends
/// otherwise, or tangentially where the derivative is wanted, is a fault.
SimulatedTurn simulate_turn(const HybridSimulation& at, const Eigen::VectorXd& y, const Signature& expected,
                            SimulationSettings settings, bool with_derivative);

}  // namespace tchat
