#include "maps/invariant_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <functional>
#include <limits>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "linear/dense_matrix.hpp"
#include "model/scales.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// (i 2 pi l)^order e^(2 pi i l phi) as real and imaginary parts: of a_l the real part, of b_l the imaginary one.
VectorXd basis_at(double phi, int harmonics, int order) {
  VectorXd basis(2 * harmonics + 1);
  basis(0) = order == 0 ? 1.0 : 0.0;
  const double angle = full_turn * (phi - std::floor(phi));
  const std::complex<double> turn(std::cos(angle), std::sin(angle));
  std::complex<double> value = 1.0;
  for (int l = 1; l <= harmonics; ++l) {
    value *= turn;
    std::complex<double> derived = value;
    for (int k = 0; k < order; ++k) derived *= std::complex<double>(0.0, full_turn * l);
    basis(2 * l - 1) = derived.real();
    basis(2 * l) = derived.imag();
  }
  return basis;
}

}  // namespace

VectorXd TrigonometricSeries::derivative(double phi, int order) const {
  return coefficients_ * basis_at(phi, harmonics(), order);
}

TrigonometricSeries TrigonometricSeries::fitted(const MatrixXd& values, const VectorXd& phases, int harmonics) {
  MatrixXd basis(phases.size(), 2 * harmonics + 1);
  for (Index k = 0; k < phases.size(); ++k) basis.row(k) = basis_at(phases(k), harmonics, 0).transpose();
  const MatrixXd normal = basis.transpose() * basis;
  return TrigonometricSeries(solve(normal, basis.transpose() * values.transpose()).transpose());
}

TrigonometricSeries TrigonometricSeries::through(const MatrixXd& values) {
  const Index count = values.cols();
  const auto harmonics = static_cast<int>((count - 1) / 2);
  MatrixXd coefficients = MatrixXd::Zero(values.rows(), 2 * harmonics + 1);
  for (Index k = 0; k < count; ++k)
    coefficients +=
        values.col(k) * basis_at(static_cast<double>(k) / static_cast<double>(count), harmonics, 0).transpose();
  coefficients *= 2.0 / static_cast<double>(count);
  coefficients.col(0) *= 0.5;
  return TrigonometricSeries(coefficients);
}

namespace {

using Eigen::RowVectorXd;

constexpr Index fewest_points = 200;

/// The window exp(-1 / (t (1 - t))): means of a quasi-periodic sequence with it converge faster than any power.
VectorXd bump(Index count) {
  VectorXd w(count);
  for (Index k = 0; k < count; ++k) {
    const double t = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    w(k) = std::exp(-1.0 / (t * (1.0 - t)));
  }
  return w / w.sum();
}

/// Angles in turns of the points about the centre of their range, in the two states of largest extent, standardised.
VectorXd turning_angles(const MatrixXd& points, const VectorXd& size) {
  const VectorXd low = points.rowwise().minCoeff();
  const VectorXd high = points.rowwise().maxCoeff();
  const VectorXd extent = high - low;
  const VectorXd centre = 0.5 * (low + high);
  // The pair of states whose covariance matrix, each by its extent, is farthest from singular.
  Index best_a = 0, best_b = 1;
  double best = -1.0;
  const MatrixXd scaled =
      extent.cwiseMax(std::numeric_limits<double>::min()).cwiseInverse().asDiagonal() * (points.colwise() - centre);
  const MatrixXd covariance = scaled * scaled.transpose() / static_cast<double>(points.cols());
  for (Index a = 0; a < points.rows(); ++a)
    for (Index b = a + 1; b < points.rows(); ++b) {
      if (!(extent(a) > level::orbit * size(a) && extent(b) > level::orbit * size(b))) continue;
      const double determinant = covariance(a, a) * covariance(b, b) - covariance(a, b) * covariance(a, b);
      if (determinant <= best) continue;
      best = determinant;
      best_a = a;
      best_b = b;
    }
  const double ma = scaled.row(best_a).mean(), mb = scaled.row(best_b).mean();
  VectorXd angles(points.cols());
  for (Index k = 0; k < points.cols(); ++k)
    angles(k) = std::atan2(scaled(best_b, k) - mb, scaled(best_a, k) - ma) / full_turn;
  return angles;
}

/// Steps of a circle's homeomorphism, angles in turns, each with the same lift: steps of a homeomorphism differ by less
/// than a turn, so that they leave a gap on the circle, where it is cut.
VectorXd lifted_steps(const VectorXd& angles) {
  VectorXd steps(angles.size() - 1);
  for (Index k = 0; k < steps.size(); ++k) steps(k) = phase_fraction(angles(k + 1) - angles(k));
  VectorXd sorted = steps;
  std::sort(sorted.begin(), sorted.end());
  double cut = sorted(0);
  double widest = sorted(0) + 1.0 - sorted(sorted.size() - 1);
  for (Index k = 1; k < sorted.size(); ++k)
    if (sorted(k) - sorted(k - 1) > widest) {
      widest = sorted(k) - sorted(k - 1);
      cut = sorted(k);
    }
  for (double& step : steps)
    if (step < cut) step += 1.0;
  return steps;
}

/// Points that come back after so many: largest distances at the beginning of the sequence and at its end, each state
/// by its size.
struct Return {
  Index after = 0;
  double first = 0.0, last = 0.0;
};

/// The first number of points after which a motion has come back, or nearly, and settles; 0 for none.
Return repetition(const MatrixXd& points, const std::vector<Index>& angles, const VectorXd& size) {
  constexpr Index most = 64;
  // Simulations are known to so much; a torus comes back so close after so few points in a resonance alone.
  constexpr double rounding = level::tolerance, near = level::visible, settling = 1e-3;
  const Index quarter = points.cols() / 4;
  for (Index q = 1; q <= std::min(most, quarter); ++q) {
    const auto largest = [&](Index begin, Index end) {
      double distance = 0.0;
      for (Index k = begin; k < end; ++k) {
        VectorXd d = points.col(k + q) - points.col(k);
        for (const Index i : angles) d(i) = full_turn * nearest_phase(d(i) / full_turn);
        distance = std::max(distance, length_in_sizes(d, size));
      }
      return distance;
    };
    const Return found{q, largest(0, quarter), largest(points.cols() - q - quarter, points.cols() - q)};
    if (found.last < rounding || (found.last < near && found.last < settling * found.first)) return found;
  }
  return {};
}

double widest_gap(VectorXd phases) {
  std::sort(phases.begin(), phases.end());
  double gap = phases(0) + 1.0 - phases(phases.size() - 1);
  for (Index k = 1; k < phases.size(); ++k) gap = std::max(gap, phases(k) - phases(k - 1));
  return gap;
}

/// Points whose angles, if any, go on from one to the next as the phase does.
class PointSequence {
 public:
  PointSequence(const MatrixXd& points, const std::vector<Index>& angles)
      : points_(points), winding_(VectorXd::Zero(points.rows())), angles_(angles) {}

  /// Where the angle states lie in terms of the phase: x = w phi + something periodic.
  void wind(const VectorXd& phases) {
    for (const Index i : angles_) {
      // Which whole number of turns (0, 1 or -1) leaves the smallest spread.
      double least = INFINITY;
      for (const double turns : {1.0, -1.0, 0.0}) {
        double sine = 0.0, cosine = 0.0;
        for (Index k = 0; k < phases.size(); ++k) {
          const double rest = points_(i, k) - full_turn * turns * phases(k);
          sine += std::sin(rest), cosine += std::cos(rest);
        }
        const double spread = -std::hypot(sine, cosine);
        if (spread >= least) continue;
        least = spread;
        winding_(i) = full_turn * turns;
        centre_ = std::atan2(sine, cosine);
      }
      centres_.push_back(centre_);
    }
  }

  const VectorXd& winding() const { return winding_; }

  /// x - w phi, n x K.
  MatrixXd periodic(const VectorXd& phases) const {
    MatrixXd out = points_;
    for (std::size_t a = 0; a < angles_.size(); ++a)
      for (Index k = 0; k < phases.size(); ++k) {
        double& entry = out(angles_[a], k);
        entry = centres_[a] +
                full_turn * nearest_phase((entry - winding_(angles_[a]) * phases(k) - centres_[a]) / full_turn);
      }
    return out;
  }

 private:
  const MatrixXd& points_;
  VectorXd winding_;
  std::vector<Index> angles_;
  std::vector<double> centres_;
  double centre_ = 0.0;
};

VectorXd phases_of(double rotation, Index count) {
  VectorXd phases(count);
  for (Index k = 0; k < count; ++k) phases(k) = phase_fraction(rotation * static_cast<double>(k));
  return phases;
}

/// A curve with so many harmonics through points, its rotation number refined with the coefficients.
class CurveFit {
 public:
  CurveFit(const MatrixXd& points, const PointSequence& sequence, const VectorXd& scale, double rotation, int harmonics)
      : rotation(rotation) {
    for (int step = 0; step < refinements; ++step) improve(points, sequence, scale, harmonics, step + 1 < refinements);
  }

  InvariantCurve curve(const PointSequence& sequence, const VectorXd& scale) const {
    return {rotation, sequence.winding(), series, scale};
  }

  double rotation;
  TrigonometricSeries series;
  double largest = 0.0, total = 0.0;  // of the misfit, relative to the extents
  double rotation_error = 0.0;

 private:
  static constexpr int refinements = 3;

  /// A change of rho moves the phase of point k by k: one Gauss-Newton step, the mean phase left to the coefficients.
  void improve(const MatrixXd& points, const PointSequence& sequence, const VectorXd& scale, int harmonics,
               bool moves) {
    const Index count = points.cols();
    const VectorXd phases = phases_of(rotation, count);
    series = TrigonometricSeries::fitted(sequence.periodic(phases), phases, harmonics);
    const InvariantCurve now = curve(sequence, scale);
    double along = 0.0, norm = 0.0;
    largest = total = 0.0;
    for (Index k = 0; k < count; ++k) {
      const VectorXd misfit = now.difference(points.col(k), now.at(phases(k))).cwiseQuotient(scale);
      const VectorXd tangent = now.derivative(phases(k)).cwiseQuotient(scale);
      const double lever = static_cast<double>(k) - 0.5 * static_cast<double>(count - 1);
      along += lever * tangent.dot(misfit);
      norm += lever * lever * tangent.squaredNorm();
      largest = std::max(largest, misfit.cwiseAbs().maxCoeff());
      total += misfit.squaredNorm();
    }
    rotation_error = std::sqrt(total / norm);
    if (moves) rotation = phase_fraction(rotation + along / norm);
  }
};

/// Twice as many harmonics as long as that halves the misfit: then what is left is the error of the points.
CurveFit best_fit(const MatrixXd& points, const PointSequence& sequence, const VectorXd& scale, double rotation,
                  int most) {
  CurveFit best(points, sequence, scale, rotation, std::min(4, most));
  for (int harmonics = 8; harmonics <= most; harmonics *= 2) {
    const CurveFit more(points, sequence, scale, best.rotation, harmonics);
    if (!(more.total < best.total)) break;
    const bool is_worth_it = more.total < 0.25 * best.total || more.largest > level::visible;
    best = more;
    if (!is_worth_it) break;
  }
  return best;
}

VectorXd extents(const MatrixXd& points, const std::vector<Index>& angles, const VectorXd& sizes) {
  VectorXd extent = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  for (const Index i : angles) extent(i) = full_turn;
  return sizes_from_ranges(extent, sizes);
}

}  // namespace

InvariantCurve::InvariantCurve(double rotation, VectorXd winding, TrigonometricSeries periodic, const VectorXd& sizes)
    : rotation_(rotation), winding_(std::move(winding)), periodic_(std::move(periodic)) {
  const Index samples = std::max<Index>(64, 8 * periodic_.harmonics());
  VectorXd low = at(0.0), high = low;
  for (Index k = 1; k < samples; ++k) {
    const VectorXd x = at(static_cast<double>(k) / static_cast<double>(samples));
    low = low.cwiseMin(x), high = high.cwiseMax(x);
  }
  extent_ = sizes_from_ranges(high - low, sizes);
  for (Index i = 0; i < dimension(); ++i)
    if (is_angle(i)) extent_(i) = full_turn;
}

VectorXd InvariantCurve::derivative(double phi, int order) const {
  VectorXd x = periodic_.derivative(phi, order);
  if (order == 0) x += winding_ * phi;
  if (order == 1) x += winding_;
  return x;
}

VectorXd InvariantCurve::difference(const VectorXd& x, const VectorXd& y) const {
  VectorXd d = x - y;
  for (Index i = 0; i < d.size(); ++i)
    if (is_angle(i)) d(i) = full_turn * nearest_phase(d(i) / full_turn);
  return d;
}

FittedCurve fit_invariant_curve(const MatrixXd& points, const CurveSettings& settings, const std::string& source) {
  if (points.cols() < fewest_points)
    throw UserError(
        fmt::format("{}: {} points of a section are too few for an invariant curve; simulate until there are "
                    "{} at least (1000 and more are better)",
                    source, points.cols(), fewest_points));
  VectorXd sizes = settings.sizes;
  if (sizes.size() == 0) sizes.setConstant(points.rows(), points.cwiseAbs().maxCoeff());
  if (const Return back = repetition(points, settings.angles, sizes); back.after > 0)
    throw UserError(
        fmt::format("{}: the motion {} periodic orbit: every {} repeats, to {:.1e} at the end; there is no torus here: "
                    "follow that orbit (`tchat simulate --dat`), or choose parameters or a start where the motion does "
                    "not repeat itself",
                    source, back.last < 1e-3 * back.first ? "settles on a" : "is a",
                    back.after == 1 ? std::string("point") : fmt::format("{} points it", back.after), back.last));
  const VectorXd scale = extents(points, settings.angles, sizes);
  const VectorXd angles = settings.angles.empty() ? turning_angles(points, sizes)
                                                  : VectorXd(points.row(settings.angles.front()) / full_turn);
  const VectorXd steps = lifted_steps(angles);
  const double turned = phase_fraction(bump(steps.size()).dot(steps));
  // Without an angle the curve has two directions: the one in which a return is less than half a turn.
  const double rotation = settings.angles.empty() ? std::min(turned, 1.0 - turned) : turned;
  const Index count = points.cols();
  const auto refuse = [&](const std::string& why) { return UserError(fmt::format("{}: {}", source, why)); };
  if (widest_gap(phases_of(rotation, count)) > 0.05)
    throw refuse(
        fmt::format("the {} points repeat themselves (rotation number {:.6g}) and do not fill a closed curve: "
                    "the motion is periodic, choose its parameters off the resonance",
                    count, rotation));

  const int most = std::clamp(static_cast<int>(count / 8), 1, settings.max_harmonics);
  PointSequence sequence(points, settings.angles);
  sequence.wind(phases_of(rotation, count));
  const CurveFit fit = best_fit(points, sequence, scale, rotation, most);
  if (!(fit.largest <= settings.tolerance))
    throw refuse(fmt::format(
        "the {} points lie on no smooth closed curve: they are up to {:.2e} of its extent off the "
        "nearest one with {} harmonics (rotation number {:.8g}); drop a longer transient, simulate "
        "more points or with a smaller tolerance, or take another section: on a torus every "
        "trajectory must cross it at an angle; or the motion is chaotic (`tchat simulate --lyapunov` tells)",
        count, fit.largest, fit.series.harmonics(), fit.rotation));
  return {fit.curve(sequence, scale), fit.largest, fit.rotation_error};
}

CurveProjection::CurveProjection(const InvariantCurve& curve) : curve_(curve), kind_(Kind::nearest) {
  weights_ = curve_.extent().cwiseAbs2().cwiseInverse();
  const Index count = std::max<Index>(128, 8 * curve_.harmonics());
  samples_.resize(curve_.dimension(), count);
  for (Index k = 0; k < count; ++k) samples_.col(k) = curve_.at(static_cast<double>(k) / static_cast<double>(count));
}

CurveProjection::CurveProjection(const InvariantCurve& curve, Index first, Index second) : CurveProjection(curve) {
  kind_ = Kind::angle;
  first_ = first;
  second_ = second;
  const Index count = samples_.cols();
  double least = INFINITY, most = -INFINITY;
  for (Index k = 0; k < count; ++k) {
    const double phi = static_cast<double>(k) / static_cast<double>(count);
    const double rate = slope(samples_.col(k), phi);
    least = std::min(least, rate), most = std::max(most, rate);
    const double turns = angle(samples_.col(k)) / full_turn;
    angles_.push_back(k == 0 ? turns : angles_.back() + nearest_phase(turns - angles_.back()));
  }
  angles_.push_back(angles_.front() + (angles_.back() > angles_.front() ? 1.0 : -1.0));
  if (least * most <= 0.0)
    throw UserError(
        "the invariant curve is no graph over that phase, it goes back and forth in it; leave --phase out: "
        "the nearest point of the curve is taken then");
}

/// The angle in radians.
double CurveProjection::angle(const VectorXd& x) const {
  return second_ < 0 ? x(first_) : std::atan2(x(first_), x(second_));
}

RowVectorXd CurveProjection::angle_gradient(const VectorXd& x) const {
  RowVectorXd gradient = RowVectorXd::Zero(x.size());
  if (second_ < 0) {
    gradient(first_) = 1.0;
    return gradient;
  }
  const double square = x(first_) * x(first_) + x(second_) * x(second_);
  gradient(first_) = x(second_) / square;
  gradient(second_) = -x(first_) / square;
  return gradient;
}

/// What is zero where phi is the projection of x.
double CurveProjection::residual(const VectorXd& x, double phi) const {
  if (kind_ == Kind::angle) return full_turn * nearest_phase((angle(curve_.at(phi)) - angle(x)) / full_turn);
  return -curve_.derivative(phi).dot(weights_.cwiseProduct(curve_.difference(x, curve_.at(phi))));
}

double CurveProjection::slope(const VectorXd& x, double phi) const {
  const VectorXd tangent = curve_.derivative(phi);
  if (kind_ == Kind::angle) return angle_gradient(curve_.at(phi)).dot(tangent);
  return tangent.dot(weights_.cwiseProduct(tangent)) -
         curve_.derivative(phi, 2).dot(weights_.cwiseProduct(curve_.difference(x, curve_.at(phi))));
}

double CurveProjection::nearest_sample(const VectorXd& x) const {
  Index best = 0;
  double least = INFINITY;
  for (Index k = 0; k < samples_.cols(); ++k) {
    double distance = 0.0;
    for (Index i = 0; i < x.size(); ++i) {
      double d = x(i) - samples_(i, k);
      if (curve_.is_angle(i)) d = full_turn * nearest_phase(d / full_turn);
      distance += weights_(i) * d * d;
    }
    if (distance < least) least = distance, best = k;
  }
  return static_cast<double>(best) / static_cast<double>(samples_.cols());
}

/// Between the two samples that have the angle between them.
double CurveProjection::sample_of_angle(double angle) const {
  const bool rises = angles_.back() > angles_.front();
  double turns = angle / full_turn;
  turns -= rises ? std::floor(turns - angles_.front()) : std::ceil(turns - angles_.front());
  const auto after = rises ? std::upper_bound(angles_.begin(), angles_.end(), turns)
                           : std::upper_bound(angles_.begin(), angles_.end(), turns, std::greater<>());
  const auto k =
      std::clamp<std::ptrdiff_t>(after - angles_.begin(), 1, static_cast<std::ptrdiff_t>(angles_.size()) - 1);
  const double left = angles_[static_cast<std::size_t>(k - 1)], right = angles_[static_cast<std::size_t>(k)];
  return (static_cast<double>(k - 1) + (turns - left) / (right - left)) / static_cast<double>(samples_.cols());
}

double CurveProjection::phase(const VectorXd& x) const {
  double phi = kind_ == Kind::angle ? sample_of_angle(angle(x)) : nearest_sample(x);
  const double reach = 2.0 / static_cast<double>(samples_.cols());
  for (int iteration = 0; iteration < 30; ++iteration) {
    const double step = std::clamp(-residual(x, phi) / slope(x, phi), -reach, reach);
    if (!std::isfinite(step)) break;
    phi += step;
    if (std::abs(step) < level::rounding_of_sums) break;
  }
  return phase_fraction(phi);
}

RowVectorXd CurveProjection::gradient(const VectorXd& x, double phi) const {
  if (kind_ == Kind::angle) return angle_gradient(x) / slope(x, phi);
  return curve_.derivative(phi).cwiseProduct(weights_).transpose() / slope(x, phi);
}

}  // namespace tchat
