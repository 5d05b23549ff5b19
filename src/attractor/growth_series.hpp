/// Mean rates of growth of the directions of a frame, with error bars, from the growth seen in one piece of a motion
/// after the other.
///
/// The rate is sum(logarithm) / sum(duration) over all pieces. Its error bar comes from averages over blocks of pieces,
/// whose length is doubled until the bar no longer grows, with at least 16 blocks: neighbouring blocks of weakly
/// chaotic motion are correlated, and a plain standard error is too small by a factor of several.
///
/// On a periodic or quasi-periodic motion a plain mean converges as 1 / (number of pieces) only. There the mean with
/// the weight exp(-1 / (s (1 - s))), s in (0, 1) along the motion, converges faster than any power (Das, Saiki, Sander
/// and Yorke 2017), if what is one piece is the same everywhere on the motion (one event, or one length of time); it
/// also forgets how the frame began. Its bar comes from weighted means of blocks likewise. Of both the one with the
/// smaller bar is told: on chaotic motion that is the plain mean.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tchat {

struct LyapunovSpectrum {
  Eigen::VectorXd exponents;  ///< descending; minus infinity for directions that are lost altogether
  Eigen::VectorXd errors;     ///< standard errors; infinite while there are too few pieces; 0 of minus infinity
  double time = 0.0;          ///< of the motion averaged over: exponents are per unit of this
  long events = 0;            ///< in that time
  long pieces = 0;            ///< that the means are made of
  long tangential = 0;        ///< events met with no velocity at all, where the tangent map does not exist: left out
};

class GrowthSeries {
 public:
  explicit GrowthSeries(Eigen::Index directions);

  /// What one piece of the motion did: logarithms of the growth of each direction, and how long it took.
  void add(const Eigen::VectorXd& logarithms, double duration);
  long pieces() const { return pieces_; }
  double duration() const { return duration_; }
  /// exponents, errors, time and pieces.
  LyapunovSpectrum spectrum() const;

 private:
  friend class GrowthStatistics;
  void halve();

  long pieces_ = 0;
  double duration_ = 0.0;
  /// Sums over `width_` pieces each, the last one perhaps over fewer: a row of logarithms and duration. Pairs are
  /// joined when there are too many.
  std::vector<Eigen::VectorXd> bins_;
  long width_ = 1;
  long in_last_ = 0;
  Eigen::VectorXd row_;
};

}  // namespace tchat
