/// Invariant tori as closed curves of a return map: trigonometric interpolation, angles modulo 2 pi, and the defining
/// systems.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "orbit/orbit.hpp"
#include "orbit/periodic_orbit_system.hpp"

namespace tchat {

// Closed curves by their values at N = 2 Q + 1 equal phases, and the trigonometric polynomial through them.
//
//     u(phi) = sum_l K(phi - l / N) u_l,     K(t) = (1 + 2 sum_{k=1..Q} cos 2 pi k t) / N
//
// K and its derivatives are all there is: shifted by rho the curve has the values sum_l K(rho + (i - l) / N) u_l, a
// circulant matrix; its derivative by phi likewise with K'.

/// Weights of u_0 .. u_{N-1} in u(phi), or in its derivative of an order from 0 by phi; N odd.
Eigen::RowVectorXd interpolation_weights(int count, double phi, int derivative = 0);

/// The same into a vector of N entries: allocates nothing.
void set_interpolation_weights(double phi, int derivative, Eigen::RowVectorXd& weights);

/// The curve whose values are the columns of `values`, by `count` values (odd): harmonics that are new are zero, those
/// that are too many are left out.
Eigen::MatrixXd resampled_curve(const Eigen::MatrixXd& values, int count);

/// Sizes of the harmonics k = 0..Q, the largest over the rows: |a_k - i b_k| of a_k cos 2 pi k phi + b_k sin 2 pi k
/// phi, each row divided by its entry of `scale`.
Eigen::VectorXd harmonic_sizes(const Eigen::MatrixXd& values, const Eigen::VectorXd& scale);

// States of a torus that are angles, counted modulo 2 pi.
//
// A state is an angle for a return where 2 pi more of it changes nothing: neither the fields nor the event functions,
// and of the jumps nothing but the same 2 pi; unless that is rounding of a state so large. Along a torus it may go
// round: then the curve u(phi) of a section does not close, and a return may end whole turns further,
//
//     u(phi + 1) = u(phi) + w,     P(u(phi)) = u(phi + rho) + c,     w and c whole multiples of 2 pi.

struct TorusWinding {
  Eigen::VectorXd curve;    ///< w, n
  Eigen::VectorXd returns;  ///< c, n
};

TorusWinding no_winding(int dimension);

/// The angles among the states, from 0: what is said above, seen at the columns of `samples` (n x K).
std::vector<Eigen::Index> angle_states(const HybridSystem& system, const Signature& one_return,
                                       const Eigen::MatrixXd& samples, const Eigen::VectorXd& par);

/// Of an angle at N equal phases: that multiple of 2 pi with which the last harmonics of u - w phi are least.
double likely_winding(const Eigen::VectorXd& values);

/// Of N orbits of one return each.
TorusWinding torus_winding(const HybridSystem& system, const Signature& one_return, const Orbit& x);

// Problem types 182 and 152: invariant tori of hybrid systems, as closed curves of a return map.
//
// The signature I_1..I_m is one return to a section. A torus meets it in a closed curve u(phi), phi of period 1, which
// the return map P takes to itself as a rotation, P(u(phi)) = u(phi + rho) (dissertation, 2.4: the map on the
// intersection of torus and section). N = 2 Q + 1 orbits of one return each start at u_i = u(i / N), i = 0..N-1, and u
// is the trigonometric polynomial through them (interpolation_weights()):
//
//     x'_{i,s} = T_{i,s} f(x_{i,s}),   h_{j_s}(x_{i,s}(1)) = 0,   x_{i,s+1}(0) = g_{k_s}(x_{i,s}(1))   (s < m),
//     sum_l R_il(rho) x_{l,1}(0) = g_{k_m}(x_{i,m}(1)),     R_il(rho) = K(rho + (i - l) / N),
//     sum_i (u_i - r_i) . r'_i = 0        (phase: r is the curve that the step goes from, r' its derivative by phi).
//
// Count. Unknowns: n m N functions, m N durations, two of the parameters, rho among them or not. Conditions: n m N + m
// N coupling rows, one phase condition, pseudo-arclength. So rho fixed and two parameters of the problem free, or rho
// and one. Any phi + const is the same torus: the phase condition takes that out, and nothing else is left free, for
// the events keep the time.
//
// Segments of the orbit are those of the N returns one after the other: segment i m + s. Each is condensed for itself,
// in time linear in N; R couples the starts of the N returns, a block of n N rows that is dense in the starts,
// component by component. A return is reduced to its start and, through the columns of these rows, to nothing else
// (linear/frontal_lu.hpp); what is left is a dense matrix of n N columns (linear/large_lu.hpp): 2/3 n^3 N^3 operations
// in blocks, where no state stands alone, 16 n^2 N^2 bytes.
//
// A state that is an angle counted modulo 2 pi may wind (TorusWinding): u(phi + 1) = u(phi) + w, and a return may
// end whole turns further, P(u(phi)) = u(phi + rho) + c. What is interpolated then is u(phi) - w phi, and the target
// is
//
//     sum_l R_il(rho) (x_{l,1}(0) - w l / N) + w (i / N + rho) + c.
//
// rho is PAR(ParameterLayout::rotation()). What the torus is in terms of frequencies: one return lasts T = mean over
// phi of the return time on the average, omega_1 = 2 pi / T, omega_2 = rho omega_1.

class TorusSystem final : public PeriodicOrbitSystem {
 public:
  /// `one_return`: the signature of one return, each segment with an event. `orbits` = N, odd, at least 3.
  TorusSystem(const HybridSystem& system, const Signature& one_return, int orbits, std::vector<int> free_parameters);
  TorusSystem(const HybridSystem& system, const Signature& one_return, int orbits, std::vector<int> free_parameters,
              TorusWinding winding);

  std::unique_ptr<BranchAnalysis> make_analysis(const OrbitShape& shape) const override;
  int orbits() const override { return orbits_; }
  int segments_per_return() const { return segments() / orbits_; }
  static double rotation(const Orbit& x) { return x.par.rotation(); }
  const TorusWinding& winding() const { return winding_; }

  int integral_conditions() const override { return 1; }
  void integral_values(const Orbit& x, const Orbit& reference, const CollocationRule& rule,
                       double* values) const override;
  void integral_gradients(const Orbit& x, const Orbit& reference, const CollocationRule& rule, double* values,
                          std::span<OrbitVector> rows) const override;
  std::string integral_name(int r) const override;

 protected:
  void target_pattern(int s, int row, CouplingPattern& pattern) const override;
  void target_value(int s, const Orbit& x, double* target) const override;
  double* target_derivatives(int s, const Orbit& x, double* entries) const override;
  std::string target_name(int s) const override;

 private:
  bool ends_return(int s) const { return (s + 1) % segments_per_return() == 0; }
  /// K or K' of rho + (orbit - l) / N.
  double weight(int orbit, int l, const Eigen::RowVectorXd& kernel) const {
    return kernel((l - orbit + orbits_) % orbits_);
  }
  void set_kernels(double rho) const;
  void find_phase_row(const Orbit& reference) const;
  /// u - w phi of orbit l, state a.
  double periodic(const Orbit& x, int l, int a) const {
    return x.start(l * segments_per_return())[a] - winding_.curve(a) * l / orbits_;
  }

  int orbits_;
  TorusWinding winding_;
  int rotation_global_;  // place of rho among the free parameters, -1: fixed
  // of the last rotation number and the last reference, kept because Newton's loop is not to allocate
  mutable double rho_ = 0.0;
  mutable bool has_kernels_ = false;
  mutable Eigen::RowVectorXd kernel_, kernel_slope_;
  Eigen::RowVectorXd slope_at_zero_;   // K' of -l / N
  mutable Eigen::MatrixXd phase_row_;  // n x N, r' divided by its length
};

/// Values of the closed curve of segment start s (from 0, of the first return) at the N phases, n x N.
Eigen::MatrixXd section_curve(const TorusSystem& system, const Orbit& x, int s = 0);
/// Those of u - w phi, which the trigonometric polynomial goes through.
Eigen::MatrixXd periodic_section_curve(const TorusSystem& system, const Orbit& x, int s = 0);

/// Mean duration of a return over the torus.
double mean_return_time(const TorusSystem& system, const Orbit& x);

/// Sizes of the harmonics k = 0..Q of all nodes of the orbits as functions of phi, each state in its size of
/// differences (sizes_of_differences()), the largest over nodes and states; those of the durations, in units of the
/// mean return time, among them. The last ones are what the trigonometric polynomial leaves out.
Eigen::VectorXd torus_harmonics(const TorusSystem& system, const Orbit& x);

/// The larger of the last two harmonics but the mean: the error figure of a torus.
double last_harmonics(const TorusSystem& system, const Orbit& x);

/// The same torus on another number of orbits (odd), phase by phase; `winding`: w, none where it is empty.
Orbit resampled_torus(const Orbit& x, int orbits, int new_orbits, const Eigen::VectorXd& winding = {});
OrbitVector resampled_torus(const OrbitVector& v, const OrbitShape& shape, int orbits, int new_orbits);

/// The orbit of one return that starts at the phase phi, interpolated node by node, or the derivative of its states and
/// durations by phi.
Orbit return_at(const TorusSystem& system, const Orbit& x, double phi, int derivative = 0);
/// The same into an orbit that has the shape of one return already, with the weights of the N orbits: allocates
/// nothing.
void set_return_at(const TorusSystem& system, const Orbit& x, double phi, int derivative,
                   const Eigen::RowVectorXd& weights, Orbit& result);
/// One return, its states still to be set.
Orbit empty_return(const TorusSystem& system, const Orbit& x);

/// Where tau lies on the mesh, and the weights of the nodes of that interval in the state there.
struct NodeWeights {
  int interval;
  Eigen::VectorXd weights;  ///< NCOL + 1
};
NodeWeights node_weights(const Orbit& x, const CollocationRule& rule, double tau);

}  // namespace tchat
