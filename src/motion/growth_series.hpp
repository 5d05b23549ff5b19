/// Mean rates of growth with error bars, their computation from a sequence of matrices, and the kind of attractor by
/// their signs.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "linear/dense_matrix.hpp"

namespace tchat {

// Mean rates of growth of the directions of a frame, with error bars, from the growth seen in one piece of a motion
// after the other.
//
// The rate is sum(logarithm) / sum(duration) over all pieces but the first sixteenth, where the frame has still to
// turn to where the growth is. Its error bar comes from averages over blocks of pieces, whose length is doubled until
// there are 16: the largest bar of the last two lengths. Neighbouring short blocks of weakly chaotic motion are
// correlated, and a plain standard error is too small by a factor of several; growth that the next piece takes back
// makes it too large.
//
// On a periodic or quasi-periodic motion a plain mean converges as 1 / (number of pieces) only. There the mean with
// the weight exp(-1 / (s (1 - s))), s in (0, 1) along the motion, converges faster than any power (Das, Saiki, Sander
// and Yorke, Nonlinearity 30, 2017), if a piece is the same everywhere on the motion (one event, or one length of
// time); it also forgets how the frame began. Its bar comes from weighted means of 8 blocks. It is taken where its bar
// is less than a fifth of the other one, which does not happen by chance on chaotic motion.
//
// A motion that decays like a power of time has the rate r + c / t, whose mean differs from r by about c / t.

struct LyapunovSpectrum {
  Eigen::VectorXd exponents;  ///< descending; minus infinity for directions that are lost altogether
  Eigen::VectorXd errors;     ///< standard errors; infinite while there are too few pieces; 0 of minus infinity
  double time = 0.0;          ///< of the motion averaged over
  long events = 0;            ///< in that time
  /// Positions of exponents that are zero whatever the motion does: along the flow, of states that nothing depends on.
  std::vector<Eigen::Index> structural;
  double all = 0.0;     ///< plain mean over the whole motion of the sum of all that were measured, none left out
  long tangential = 0;  ///< events met so slowly, |h_x f-| < 1e-7 |h_x| |f-|, that S loses its digits
  std::string fault;    ///< why nothing can be said, exponents are nan; "" when all went well

  bool is_structural(Eigen::Index j) const {
    return std::find(structural.begin(), structural.end(), j) != structural.end();
  }
  /// Largest of the errors.
  double accuracy() const { return errors.size() == 0 ? 0.0 : errors.maxCoeff(); }
};

class GrowthSeries {
 public:
  explicit GrowthSeries(Eigen::Index directions);

  /// What one piece of the motion did: logarithms of the growth of each direction, and how long it took.
  void add(const Eigen::VectorXd& logarithms, double duration);
  /// From now on pieces are twice as long; those so far are joined in pairs. Only when pieces() is even.
  void double_pieces();
  long pieces() const { return pieces_; }

  /// exponents and errors, time. Those of the first `structural` directions are marked. `elapsed`: how long the motion
  /// had lasted before the first piece, in the unit of durations.
  LyapunovSpectrum spectrum(Eigen::Index structural = 0, double elapsed = 0.0) const;

 private:
  void join_pairs();

  long pieces_ = 0;
  /// Each column: sums of logarithms and, last, of durations, over `width_` pieces; the last column perhaps over fewer.
  Eigen::MatrixXd bins_;
  Eigen::Index used_ = 0;  // columns
  long width_ = 1;
  long in_last_ = 0;  // pieces
};

// What a motion settles on.

enum class AttractorKind {
  none,            ///< not told: the motion has not settled, or its integration failed
  periodic,        ///< repeats itself: a signature and a period
  neutral,         ///< repeats itself, and motions beside it neither approach nor leave: no attractor
  quasi_periodic,  ///< does not repeat itself, and no exponent is positive
  chaotic,         ///< an exponent is positive
  rest,            ///< the motion dies out
  chattering,      ///< events accumulate, or the contact lasts and the problem has no mode for it
  escape,          ///< no event any more: the motion leaves
};

/// A signature and a period belong to it.
inline bool repeats(AttractorKind kind) { return kind == AttractorKind::periodic || kind == AttractorKind::neutral; }

/// The word for people and files: "quasi-periodic".
std::string to_string(AttractorKind kind);
/// The kind of a word; nothing when it is none.
std::optional<AttractorKind> attractor_kind(const std::string& word);

// What the signs of Lyapunov exponents say of a motion.

/// How many exponents of a flow are positive, zero, negative, as far as their bars tell. Those that are zero whatever
/// the motion does are not counted.
struct ExponentSigns {
  int positive = 0;  ///< by more than three bars
  int zero = 0;      ///< within three bars, which are small against the other exponents or the frequency of events
  int negative = 0;
  int unclear = 0;
};
ExponentSigns signs_of(const LyapunovSpectrum& spectrum);

/// Of all exponents of a system with so many states: volumes neither grow nor shrink, to 1e-6 of the frequency of
/// events or of the largest exponent. Then nothing attracts. In coordinates in which they do both by turns this is not
/// seen.
bool keeps_volumes(const LyapunovSpectrum& spectrum, int dimension);

/// chaotic (one is positive), quasi_periodic (one is zero, none positive), periodic (all negative, beside the one along
/// the flow), rest (all negative and none along the flow); none where bars are too large to tell. This does not tell a
/// slow transient from a motion that stays: motion/attractor_search.hpp comes first.
AttractorKind kind_by_exponents(const LyapunovSpectrum& spectrum);

/// "0.01234 (bar 2e-05), -0.1 (bar 1e-05)": the two largest that are not zero whatever the motion does.
std::string largest_exponents_text(const LyapunovSpectrum& spectrum);

// Lyapunov exponents of a sequence of matrices, by Householder QR: an orthonormal frame Q is multiplied by each matrix
// and made orthonormal again, A Q = Q' R; the exponents are the means of ln |R_jj|.

/// n x K, carried along; orthonormal after each orthonormalise(). Allocates nothing after construction.
class OrthonormalFrame {
 public:
  /// 1 <= columns <= n. The first frame is a fixed one in general position.
  OrthonormalFrame(Eigen::Index n, Eigen::Index columns);

  /// Columns to be multiplied by what transports them.
  Eigen::MatrixXd& vectors() { return v_; }
  const Eigen::MatrixXd& vectors() const { return v_; }
  /// V = Q R; V <- Q, and ln |R_jj| is added to the growth. A direction that vanishes to rounding against the others
  /// has lost all: minus infinity; unless `may_vanish` is false, where that is rounding of large numbers.
  void orthonormalise(bool may_vanish = true);
  /// ln |R_jj| added since the last call.
  const Eigen::VectorXd& take_growth();
  /// Of states, n: from now on the frame is orthonormal in these, where components differ by many powers of ten. What
  /// has grown so far is counted, the change itself is not.
  void use_units(const Eigen::VectorXd& units);

 private:
  Eigen::MatrixXd v_;
  Orthonormalisation qr_;
  Eigen::VectorXd growth_, taken_;
  Eigen::VectorXd units_;  // none: 1
};

/// For maps: one matrix after the other, each one piece of the motion.
class QrAccumulator {
 public:
  /// 1 <= columns <= n: how many exponents.
  QrAccumulator(Eigen::Index n, Eigen::Index columns) : frame_(n, columns), series_(columns) {}

  /// n x n, and how long it took (1 for exponents per iterate). A matrix that is not finite is left out, and
  /// counted in `tangential`.
  void pass(const Eigen::MatrixXd& matrix, double duration = 1.0);
  /// `events` are matrices.
  LyapunovSpectrum spectrum() const;
  /// The direction that has grown fastest, behind the last matrix: n, of unit length.
  Eigen::VectorXd growing_direction() const { return frame_.vectors().col(0); }

 private:
  OrthonormalFrame frame_;
  GrowthSeries series_;
  long left_out_ = 0;
};

}  // namespace tchat
