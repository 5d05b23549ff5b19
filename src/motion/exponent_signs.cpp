#include "motion/exponent_signs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

using Eigen::Index;

constexpr double bars_of_zero = 3.0;
// Against the largest exponent or the frequency of events: chaos may be weak, and means of regular motion converge
// fast.
constexpr double small_bar = 1e-4;

}  // namespace

ExponentSigns signs_of(const LyapunovSpectrum& spectrum) {
  ExponentSigns signs;
  double scale = spectrum.time > 0.0 ? static_cast<double>(spectrum.events) / spectrum.time : 0.0;
  for (const double exponent : spectrum.exponents)
    if (std::isfinite(exponent)) scale = std::max(scale, std::abs(exponent));
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

}  // namespace tchat
