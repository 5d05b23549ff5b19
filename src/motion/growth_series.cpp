#include "motion/growth_series.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/levels.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index most_bins = 8192;
constexpr Index least_blocks = 16;
constexpr Index most_blocks = 4 * least_blocks;
constexpr Index least_for_alignment = 64;
constexpr Index weighted_blocks = 8;
constexpr Index least_weighted = 16;  // bins in each of those
// 97.7 % of Student's distribution with 7 degrees of freedom, as a share of the two deviations of a normal one.
constexpr double student = 1.21;
constexpr double clearly_better = 0.2;
constexpr double significant = 2.0;  // bars

struct Mean {
  Index direction = 0;
  double value = 0.0;
  double error = std::numeric_limits<double>::infinity();
};

/// One direction's logarithms and durations.
struct Rates {
  Eigen::RowVectorXd logarithms, durations;

  Index size() const { return logarithms.size(); }
};

/// Of the mean from blocks of so many bins: the deviations of the blocks from it, added in squares.
double block_error(const Rates& rates, double mean, Index length) {
  const Index blocks = rates.size() / length;
  double squares = 0.0;
  for (Index b = 0; b < blocks; ++b) {
    const double deviation =
        rates.logarithms.segment(b * length, length).sum() - mean * rates.durations.segment(b * length, length).sum();
    squares += deviation * deviation;
  }
  const auto count = static_cast<double>(blocks);
  return std::sqrt(squares * count / (count - 1.0)) / rates.durations.head(blocks * length).sum();
}

/// Without the first ones, in which the frame has still to turn to where the growth is.
Rates after_alignment(const Rates& rates) {
  const Index kept = rates.size() >= least_for_alignment ? rates.size() - rates.size() / 16 : rates.size();
  return {rates.logarithms.tail(kept), rates.durations.tail(kept)};
}

/// What the mean is off if the rate still changes along the motion: half the difference of its halves, or a quarter of
/// that of its outer quarters.
double drift_error(const Rates& rates) {
  const auto rate = [&](Index begin, Index length) {
    return rates.logarithms.segment(begin, length).sum() / rates.durations.segment(begin, length).sum();
  };
  const Index half = rates.size() / 2, quarter = rates.size() / 4;
  const double halves = 0.5 * std::abs(rate(0, half) - rate(rates.size() - half, half));
  const double quarters = 0.25 * std::abs(rate(0, quarter) - rate(rates.size() - quarter, quarter));
  return std::max(halves, quarters);
}

Mean plain_mean(const Rates& all) {
  const Rates rates = after_alignment(all);
  Mean mean;
  mean.value = rates.logarithms.sum() / rates.durations.sum();
  if (rates.size() < least_blocks) return mean;
  mean.error = 0.0;
  Index length = 1;
  while (rates.size() / length >= most_blocks) length *= 2;
  for (; rates.size() / length >= least_blocks; length *= 2)
    mean.error = std::max(mean.error, block_error(rates, mean.value, length));
  if (const double drift = drift_error(rates); drift > significant * mean.error) mean.error = drift;
  return mean;
}

double weighted_value(const Rates& rates, Index begin, Index length) {
  double growth = 0.0, duration = 0.0;
  for (Index i = 0; i < length; ++i) {
    const double s = (static_cast<double>(i) + 0.5) / static_cast<double>(length);
    const double weight = std::exp(-1.0 / (s * (1.0 - s)));
    growth += weight * rates.logarithms(begin + i);
    duration += weight * rates.durations(begin + i);
  }
  return growth / duration;
}

Mean weighted_mean(const Rates& rates) {
  Mean mean;
  const Index length = rates.size() / weighted_blocks;
  if (length < least_weighted) return mean;
  mean.value = weighted_value(rates, 0, rates.size());
  VectorXd blocks(weighted_blocks);
  for (Index b = 0; b < weighted_blocks; ++b) blocks(b) = weighted_value(rates, b * length, length);
  const auto count = static_cast<double>(weighted_blocks);
  mean.error = student * std::sqrt((blocks.array() - blocks.mean()).square().sum() / (count - 1.0) / count);
  mean.error = std::max(mean.error, std::abs(blocks.mean() - mean.value));
  // Blocks that are alike, as where two directions turn by nearly a share of a turn, are off alike.
  const Index half = rates.size() / 2;
  for (const Index begin : {Index(0), rates.size() - half})
    mean.error = std::max(mean.error, std::abs(weighted_value(rates, begin, half) - mean.value));
  return mean;
}

/// What the mean is off where the rate falls like c / t from the motion's start: c at the middle of the time, by the
/// slope of the means of 8 blocks, which has to be certain. `elapsed`: before these pieces.
double trend_error(const Rates& all, double elapsed) {
  constexpr Index blocks = 8;
  constexpr double certain = 10.0;  // deviations
  const Rates rates = after_alignment(all);
  const Index length = rates.size() / blocks;
  if (length == 0) return 0.0;
  VectorXd place = VectorXd::LinSpaced(blocks, -0.5 + 0.5 / blocks, 0.5 - 0.5 / blocks), value(blocks);
  for (Index b = 0; b < blocks; ++b)
    value(b) = rates.logarithms.segment(b * length, length).sum() / rates.durations.segment(b * length, length).sum();
  const double slope = place.dot(value) / place.squaredNorm();
  const double left = (value.array() - value.mean() - slope * place.array()).matrix().norm();
  if (!(std::abs(slope) > certain * left / std::sqrt((blocks - 2) * place.squaredNorm()))) return 0.0;
  return std::abs(slope) * (0.5 + elapsed / rates.durations.sum());
}

Mean mean_of(const Rates& rates, double elapsed) {
  if (!rates.logarithms.allFinite()) return {0, rates.logarithms.sum(), 0.0};
  const Mean plain = plain_mean(rates);
  const Mean weighted = weighted_mean(rates);
  Mean mean = weighted.error < clearly_better * plain.error ? weighted : plain;
  mean.error = std::max(mean.error, trend_error(rates, elapsed));
  return mean;
}

}  // namespace

GrowthSeries::GrowthSeries(Index directions) : bins_(directions + 1, most_bins) {}

void GrowthSeries::add(const VectorXd& logarithms, double duration) {
  if (in_last_ == 0 || in_last_ == width_) {
    if (used_ == most_bins) join_pairs();
    bins_.col(used_++).setZero();
    in_last_ = 0;
  }
  bins_.col(used_ - 1).head(logarithms.size()) += logarithms;
  bins_(logarithms.size(), used_ - 1) += duration;
  ++in_last_;
  ++pieces_;
}

void GrowthSeries::join_pairs() {
  for (Index i = 0; i < used_ / 2; ++i) bins_.col(i) = bins_.col(2 * i) + bins_.col(2 * i + 1);
  used_ /= 2;
  width_ *= 2;
  in_last_ = width_;
}

void GrowthSeries::double_pieces() {
  // Sums over `width_` pieces are sums over half as many of the longer ones.
  if (width_ == 1) join_pairs();
  width_ /= 2;
  in_last_ = std::max(1L, in_last_ / 2);
  pieces_ /= 2;
  if (pieces_ == 0) in_last_ = 0;
}

LyapunovSpectrum GrowthSeries::spectrum(Index structural, double elapsed) const {
  const Index directions = bins_.rows() - 1;
  LyapunovSpectrum spectrum;
  spectrum.exponents = VectorXd::Constant(directions, std::nan(""));
  spectrum.errors = VectorXd::Constant(directions, std::numeric_limits<double>::infinity());
  if (used_ == 0) return spectrum;
  spectrum.time = bins_.row(directions).head(used_).sum();
  spectrum.all = bins_.topLeftCorner(directions, used_).sum() / spectrum.time;
  // Where there are many, a last one that is not complete would disturb what makes all of them alike.
  const Index complete = in_last_ == width_ || used_ <= least_blocks ? used_ : used_ - 1;
  std::vector<Mean> means;
  for (Index j = 0; j < directions; ++j) {
    means.push_back(mean_of({bins_.row(j).head(complete), bins_.row(directions).head(complete)}, elapsed));
    means.back().direction = j;
  }
  std::stable_sort(means.begin(), means.end(), [](const Mean& a, const Mean& b) { return a.value > b.value; });
  for (Index j = 0; j < directions; ++j) {
    const Mean& mean = means[static_cast<std::size_t>(j)];
    spectrum.exponents(j) = mean.value;
    spectrum.errors(j) = mean.error;
    if (mean.direction < structural) spectrum.structural.push_back(j);
  }
  return spectrum;
}

namespace {

constexpr std::array<std::pair<AttractorKind, const char*>, 8> kind_words = {{
    {AttractorKind::none, "none"},
    {AttractorKind::periodic, "periodic"},
    {AttractorKind::neutral, "neutral"},
    {AttractorKind::quasi_periodic, "quasi-periodic"},
    {AttractorKind::chaotic, "chaotic"},
    {AttractorKind::rest, "rest"},
    {AttractorKind::chattering, "chattering"},
    {AttractorKind::escape, "escape"},
}};

}  // namespace

std::string to_string(AttractorKind kind) {
  for (const auto& [other, word] : kind_words)
    if (other == kind) return word;
  return "none";
}

std::optional<AttractorKind> attractor_kind(const std::string& word) {
  for (const auto& [kind, other] : kind_words)
    if (other == word) return kind;
  return std::nullopt;
}

namespace {

constexpr double bars_of_zero = 3.0;
// Against the largest exponent or the frequency of events: chaos may be weak, and means of regular motion converge
// fast.
constexpr double small_bar = level::visible;

}  // namespace

namespace {

/// The frequency of events, or the largest exponent.
double scale_of(const LyapunovSpectrum& spectrum) {
  double scale = spectrum.time > 0.0 ? static_cast<double>(spectrum.events) / spectrum.time : 0.0;
  for (const double exponent : spectrum.exponents)
    if (std::isfinite(exponent)) scale = std::max(scale, std::abs(exponent));
  return scale;
}

}  // namespace

bool keeps_volumes(const LyapunovSpectrum& spectrum, int dimension) {
  return spectrum.exponents.size() == dimension && std::abs(spectrum.all) <= level::located * scale_of(spectrum);
}

ExponentSigns signs_of(const LyapunovSpectrum& spectrum) {
  ExponentSigns signs;
  const double scale = scale_of(spectrum);
  for (Index j = 0; j < spectrum.exponents.size(); ++j) {
    if (spectrum.is_structural(j)) continue;
    const double exponent = spectrum.exponents(j);
    const double zero = bars_of_zero * spectrum.errors(j);
    if (exponent > zero)
      ++signs.positive;
    else if (exponent < -zero)
      ++signs.negative;
    else if (spectrum.errors(j) < small_bar * scale)
      ++signs.zero;
    else
      ++signs.unclear;
  }
  return signs;
}

AttractorKind kind_by_exponents(const LyapunovSpectrum& spectrum) {
  const ExponentSigns signs = signs_of(spectrum);
  if (signs.positive > 0) return AttractorKind::chaotic;
  if (signs.unclear > 0) return AttractorKind::none;
  if (signs.zero > 0) return AttractorKind::quasi_periodic;
  if (signs.negative == 0) return AttractorKind::none;
  return spectrum.structural.empty() ? AttractorKind::rest : AttractorKind::periodic;
}

std::string largest_exponents_text(const LyapunovSpectrum& spectrum) {
  std::string text;
  int told = 0;
  for (Index j = 0; j < spectrum.exponents.size() && told < 2; ++j) {
    if (spectrum.is_structural(j)) continue;
    text += fmt::format("{}{:.4g} (bar {:.1g})", told++ > 0 ? ", " : "", spectrum.exponents(j), spectrum.errors(j));
  }
  return text;
}

namespace {

constexpr double vanishing = 32 * std::numeric_limits<double>::epsilon();

}  // namespace

OrthonormalFrame::OrthonormalFrame(Index n, Index columns)
    : v_(n, columns), qr_(n, columns), growth_(VectorXd::Zero(columns)), taken_(VectorXd::Zero(columns)) {
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < n; ++i)
      v_(i, j) =
          (i == j ? 1.0 : 0.0) + 0.5 * std::sin(1.0 + 3.7 * static_cast<double>(i) + 5.3 * static_cast<double>(j));
  orthonormalise();
  growth_.setZero();
}

void OrthonormalFrame::orthonormalise(bool may_vanish) {
  const bool has_units = units_.size() > 0;
  if (has_units) v_ = units_.cwiseInverse().asDiagonal() * v_;
  const double size = v_.cwiseAbs().maxCoeff();
  qr_.apply(v_);
  if (has_units) v_ = units_.asDiagonal() * v_;
  for (Index j = 0; j < v_.cols(); ++j) {
    const double r = qr_.lengths()(j);
    const bool vanishes = r <= vanishing * size;
    if (vanishes && may_vanish)
      growth_(j) = -std::numeric_limits<double>::infinity();
    else
      growth_(j) += std::log(vanishes ? vanishing * size : r);
  }
}

void OrthonormalFrame::use_units(const VectorXd& units) {
  if (units.size() == units_.size() && units == units_) return;
  orthonormalise(false);
  const VectorXd growth = growth_;
  units_ = units;
  orthonormalise(false);
  growth_ = growth;
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
