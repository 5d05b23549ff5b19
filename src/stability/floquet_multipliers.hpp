/// Multipliers of hybrid return maps, saltation included: of periodic orbits and of invariant tori.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "orbit/condensed_system.hpp"
#include "orbit/torus_system.hpp"
#include "stability/periodic_qz.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// The derivative of one segment's map from its start to the start of the next one, as a matrix (2.26):
//
//     w = Phi v,   sigma = -h_x w / (h_x f),   v_next = g_x (w + sigma f).
//
// It divides by h_x f, so it is for orbits that cross their sections: those of a torus, and the orbit that a torus is
// born from. Multipliers of periodic orbits, near grazing too, are the business of FloquetSolver.

struct SegmentMap {
  Eigen::MatrixXd to_end;          ///< v to the change of x_s(1), n x n: Phi + f sigma
  Eigen::RowVectorXd to_duration;  ///< v to sigma = change of T_s, n
  Eigen::MatrixXd to_next;         ///< v to the change of the next start: g_x to_end
};

/// Of segment s, from the linearisation at x. Not finite where h_x f = 0.
SegmentMap segment_map(const CondensedSystem& condensed, const Orbit& x, int s);

/// The derivative of the map over the segments first..last-1, n x n.
Eigen::MatrixXd return_matrix(const CondensedSystem& condensed, const Orbit& x, int first, int last);

// Floquet multipliers of the hybrid return map, saltation included, without dividing by the transversality.
//
// A perturbation v of x_s(0) leaves segment s as w = Phi_s v + sigma_s f with h_x w = 0 (sigma_s is the change of the
// duration) and enters the next segment as g_x w; eliminating sigma_s gives (2.26). Here Phi_s stays in the condensed
// form A_s v + C_s (Phi_s v) = 0, so the step from segment to segment is
//
//     C_s w_s - sigma_s C_s f = -A_s g_{s-1,x} w_{s-1},     h_x w_s = 0.
//
// With w_s = Z_s c_s (the columns of Z_s span the kernel of h_x) and the rows projected by F_s orthogonal to C_s f,
//
//     E_s c_s = A'_s c_{s-1},   E_s = F_s^T C_s Z_s,   A'_s = -F_s^T A_s g_{s-1,x} Z_{s-1}      ((n-1) x (n-1))
//
// and the n - 1 nontrivial multipliers are the eigenvalues of the product of E_s^-1 A'_s (periodic QZ). E_s is
// singular exactly at grazing, h_x f = 0, where one multiplier is infinite and the others remain what they are. But
// where A'_{s+1} annihilates the same vector (in the plane; at a section that the orbit touches; where a curve of
// folds or period doublings ends at grazing) the pencil is singular, and a multiplier has a finite limit that cannot
// be read off it any more: it is 0/0. Such a one is known by what an error of the orbit's size makes of it.
//
// A contact segment (model/events.hpp) that has shrunk to nothing begins and ends at grazing. Where the
// field is continuous there, perturbations pass as if it were not there, and h_x f = 0 takes the place of h = 0 as the
// section on both sides of it: all multipliers are known.
//
// The functions of the multipliers that vanish where one is +1 or -1 are determinants of the same pencils,
//
//     det(1 - t E_m^-1 A'_m ... E_1^-1 A'_1) a_1 ... a_m,     t = 1 or -1,     a_s = h_x f / (|h_x| |f|),
//
// the product of 1 - t mu over the nontrivial multipliers and of the a_s. Each det E_s is a_s times what never
// vanishes, so that nothing is divided by a_s, and nothing has a pole or a gap where one is zero.
//
// The projection removes the structural zero multiplier. What is printed in its place is its size as the
// discretisation sees it: the least relative change of f(x_s(0)) and f(x_s(1)) with which Phi_s takes one to the
// other, on the worst segment. It is 0 for the exact flow, and an error figure of the mesh.
//
// F_s is known from C_s f(x_s(1)), and as well from -A_s f(x_s(0)), the same vector. Where an orbit passes a saddle
// both are tiny: what an error of the orbit, which grows on the way, makes of their direction may be all of it, and the
// multipliers are noise while the structural one is small. The two directions tell it: multipliers that differ where
// F_s is taken from the other one are not known.
//
// An orbit without a section is cut by the plane across the flow. What is printed then in place of the zero is its
// trivial multiplier as the discretisation has it: of all t the one that comes nearest to A f(x(0)) + t C f(x(1)) = 0,
// 1 for the exact flow.

/// Workspace for one defining system and shape; compute() may be called at every point.
class FloquetSolver {
 public:
  explicit FloquetSolver(const OrbitShape& shape);

  /// `condensed` holds the linearisation at x.
  FloquetMultipliers compute(const CondensedSystem& condensed, const Orbit& x);
  /// Into a result of another point: no allocation after the first.
  void compute(const CondensedSystem& condensed, const Orbit& x, FloquetMultipliers& result);

 private:
  /// What the end of one segment contributes. Z_s and F_s are all columns but the first of reflections, which take h_x
  /// and C_s f to multiples of the first unit vector.
  struct SegmentEnd {
    Eigen::VectorXd section;                // of the reflection with Z_s
    Eigen::VectorXd projection;             // of the reflection with F_s
    Eigen::MatrixXd jump;                   // g_x times the former: its columns but the first are g_x Z_s
    double transversality = 0.0;            // a_s = h_x f / (|h_x| |f|)
    ScaledReal determinant_share;           // det E_s / a_s
    double flow_defect = 0.0;               // part of the structural zero
    Eigen::VectorXd tilt;                   // what F_s is to be given of the direction C_s f to be orthogonal to A_s f
    Eigen::RowVectorXd e_across, a_across;  // that direction's row beside E_s, A'_s
    double trivial_multiplier = 0.0;        // of an end without a section
  };
  struct Blocks {
    std::vector<Eigen::MatrixXd> e, a;
  };
  void measure_end(const CondensedSystem& condensed, const Orbit& x, int s);
  void project_blocks(const CondensedSystem& condensed, int s);
  Blocks disturbed(double disturbance, int way) const;
  void tilt_blocks();
  bool is_tilted() const;
  void compare_with_tilted(bool touches, FloquetMultipliers& result);
  void find_eigenvalues(const Blocks& blocks, std::vector<std::complex<double>>& values);
  void leave_out_absent(const DefiningSystem& defining, std::vector<std::complex<double>>& values) const;
  void leave_out_undetermined(FloquetMultipliers& result);
  using Distance = double (*)(const std::complex<double>&, const std::complex<double>&);
  double keep_known(Distance distance, double most, FloquetMultipliers& result);
  void form_products(bool touches, FloquetMultipliers& result);

  OrbitShape shape_;
  std::vector<SegmentEnd> ends_;
  Blocks blocks_;                             // E_s, A'_s
  Blocks tilted_;                             // the same with the other direction
  std::vector<std::complex<double>> others_;  // multipliers to compare with
  std::vector<double> a_sizes_;               // of the blocks before their projection
  std::vector<double> e_sizes_;
  PeriodicQz qz_;
  CyclicDeterminant determinant_;
  // scratch of one segment
  Eigen::VectorXd f0_, f1_, image_;  // the field at both ends, C_s f
  Eigen::MatrixXd square_;           // n x n
  Eigen::MatrixXd flow_rows_;        // 2n x (n + 1), see flow_defect()
};

// Normal stability of an invariant torus: the mean growth of perturbations per return, along the rotation.
//
// Perturbations of the curve u(phi) of a return map go by v(phi + rho) = A(phi) v(phi), A the derivative of the return
// map at u(phi). Where that is reducible, v = C(phi) y with y -> B y, the multipliers of B say what becomes of
// perturbations, up to whole multiples of rho in their angles: their moduli are all there is. They are
//
//     |mu_k| = exp lambda_k,   lambda_k the Lyapunov exponents of the sequence A(phi_0 + j rho), j = 0, 1, ...
//
// found by orthogonalisation (QR) at each return, of a frame whose first vector is u'(phi): that direction goes to
// itself, and those across it are told from it also where they grow as little, near the birth of the torus. The mean
// of log R_kk is weighted by exp(-1 / (t (1 - t))) over the sequence, with which means of functions on a circle
// converge faster than any power of its length [Das, Saiki, Sander, Yorke, Nonlinearity 30 (2017) 4111]. A is
// interpolated between the N orbits. One of them is 1, along the curve; its distance from that is an error figure.
// Another is 0, along the flow.

class CondensedSystem;

/// exp lambda_k, that along the curve first, then the largest: `states` - 1 of them, of the mode with the fewest states
/// (at least 2), for the others are zero. Column i of `matrices` holds A at the phase i / N, n n
/// entries; `curve`: u(phi) - w phi at these phases, n x N; `w`: what a turn of phi adds to the states. Entries of
/// `matrices` that are not finite spoil the result.
Eigen::VectorXd moduli_along_rotation(const Eigen::MatrixXd& matrices, const Eigen::MatrixXd& curve,
                                      const Eigen::VectorXd& w, double rho, int states);

/// Moduli as FloquetMultipliers orders them: that along the curve first, as the trivial one, the structural zero last.
/// Not valid where a section is touched, h_x f = 0. `condensed` holds the linearisation of `system` at x.
FloquetMultipliers torus_multipliers(const TorusSystem& system, const CondensedSystem& condensed, const Orbit& x);

}  // namespace tchat
