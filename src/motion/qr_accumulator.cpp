#include "motion/qr_accumulator.hpp"

#include <cmath>
#include <limits>

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double vanishing = 32 * std::numeric_limits<double>::epsilon();

}  // namespace

OrthonormalFrame::OrthonormalFrame(Index n, Index columns)
    : v_(n, columns),
      qr_(n, columns),
      growth_(VectorXd::Zero(columns)),
      taken_(VectorXd::Zero(columns)),
      workspace_(n) {
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < n; ++i)
      v_(i, j) =
          (i == j ? 1.0 : 0.0) + 0.5 * std::sin(1.0 + 3.7 * static_cast<double>(i) + 5.3 * static_cast<double>(j));
  orthonormalise();
  growth_.setZero();
}

void OrthonormalFrame::orthonormalise(bool may_vanish) {
  const double size = v_.cwiseAbs().maxCoeff();
  qr_.compute(v_);
  for (Index j = 0; j < v_.cols(); ++j) {
    const double r = std::abs(qr_.matrixQR()(j, j));
    const bool vanishes = r <= vanishing * size;
    if (vanishes && may_vanish)
      growth_(j) = -std::numeric_limits<double>::infinity();
    else
      growth_(j) += std::log(vanishes ? vanishing * size : r);
  }
  v_.setIdentity();
  qr_.householderQ().applyThisOnTheLeft(v_, workspace_);
}

const VectorXd& OrthonormalFrame::take_growth() {
  taken_ = growth_;
  growth_.setZero();
  return taken_;
}

void QrAccumulator::pass(const MatrixXd& matrix, double duration) {
  if (!matrix.allFinite()) {
    ++left_out_;
    return;
  }
  frame_.vectors() = matrix * frame_.vectors();
  frame_.orthonormalise();
  series_.add(frame_.take_growth(), duration);
}

LyapunovSpectrum QrAccumulator::spectrum() const {
  LyapunovSpectrum spectrum = series_.spectrum();
  spectrum.events = series_.pieces();
  spectrum.tangential = left_out_;
  return spectrum;
}

}  // namespace tchat
