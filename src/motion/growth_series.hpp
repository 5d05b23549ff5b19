/// Mean rates of growth of the directions of a frame, with error bars, from the growth seen in one piece of a motion
/// after the other.
///
/// The rate is sum(logarithm) / sum(duration) over all pieces but the first sixteenth, where the frame has still to
/// turn to where the growth is. Its error bar comes from averages over blocks of pieces, whose length is doubled until
/// there are 16: the largest bar of the last two lengths. Neighbouring short blocks of weakly chaotic motion are
/// correlated, and a plain standard error is too small by a factor of several; growth that the next piece takes back
/// makes it too large.
///
/// On a periodic or quasi-periodic motion a plain mean converges as 1 / (number of pieces) only. There the mean with
/// the weight exp(-1 / (s (1 - s))), s in (0, 1) along the motion, converges faster than any power (Das, Saiki, Sander
/// and Yorke, Nonlinearity 30, 2017), if a piece is the same everywhere on the motion (one event, or one length of
/// time); it also forgets how the frame began. Its bar comes from weighted means of 8 blocks. It is taken where its bar
/// is less than a fifth of the other one, which does not happen by chance on chaotic motion.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

namespace tchat {

struct LyapunovSpectrum {
  Eigen::VectorXd exponents;  ///< descending; minus infinity for directions that are lost altogether
  Eigen::VectorXd errors;     ///< standard errors; infinite while there are too few pieces; 0 of minus infinity
  double time = 0.0;          ///< of the motion averaged over
  long events = 0;            ///< in that time
  /// Positions of exponents that are zero whatever the motion does: along the flow, of states that nothing depends on.
  std::vector<Eigen::Index> structural;
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

  /// exponents and errors, time. Those of the first `structural` directions are marked.
  LyapunovSpectrum spectrum(Eigen::Index structural = 0) const;

 private:
  void join_pairs();

  long pieces_ = 0;
  /// Each column: sums of logarithms and, last, of durations, over `width_` pieces; the last column perhaps over fewer.
  Eigen::MatrixXd bins_;
  Eigen::Index used_ = 0;  // columns
  long width_ = 1;
  long in_last_ = 0;  // pieces
};

}  // namespace tchat
