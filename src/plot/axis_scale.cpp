#include "plot/axis_scale.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/user_error.hpp"

namespace tchat {

namespace {

constexpr double infinity_in_files = 1e90;
constexpr double margin = 0.04;
/// Ends that differ by less than this part of their size are equal in a script.
constexpr double narrowest = 1e-8;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool is_empty() const { return !(low <= high); }
};

Range range_of(const std::vector<double>& values, bool positive) {
  Range range;
  for (const double value : values) {
    if (!can_be_shown(value) || (positive && value <= 0.0)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  return range;
}

/// Wider than the data; a constant, up to rounding, gets a range around it.
Range widened(Range range) {
  const double size = std::max(std::abs(range.low), std::abs(range.high));
  const double span = range.high - range.low;
  if (span <= narrowest * size || span == 0.0) {
    const double half = size > 0.0 ? 0.05 * size : 1.0;
    return {range.low - half, range.high + half};
  }
  return {range.low - margin * span, range.high + margin * span};
}

bool is_narrow(double low, double high) { return high - low <= narrowest * std::max(std::abs(low), std::abs(high)); }

/// Ranges that the user has given, of which gnuplot would make an error.
void refuse_range(const AxisSettings& settings) {
  for (const std::optional<double>& end : {settings.low, settings.high})
    if (end && !can_be_shown(*end))
      throw UserError(fmt::format("a range that ends at {:g} cannot be drawn; its ends are between {:g} and {:g}", *end,
                                  -infinity_in_files, infinity_in_files));
  if (settings.low && settings.high && is_narrow(*settings.low, *settings.high))
    throw UserError(
        fmt::format("the range {:.17g}:{:.17g} is too narrow to be drawn; its ends must differ by more than "
                    "{:g} of their size",
                    *settings.low, *settings.high, narrowest));
}

/// The smallest of 1, 2, 5 times a power of ten that goes into the range at most so many times.
double round_step(double span, int most) {
  const double power = std::pow(10.0, std::floor(std::log10(span / most)));
  for (const double leading : {1.0, 2.0, 5.0})
    if (span <= leading * power * most) return leading * power;
  return 10.0 * power;
}

void set_linear_tics(AxisScale& scale, int most) {
  const double largest = std::max(std::abs(scale.low), std::abs(scale.high));
  scale.tic_step = round_step(scale.high - scale.low, most);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(scale.tic_step) + 1e-9)));
  scale.format = largest >= 1e6 || largest < 1e-4 ? "%g" : fmt::format("%.{}f", decimals);
  scale.widest_number = 0.0;
  for (const double tic : {std::ceil(scale.low / scale.tic_step), std::floor(scale.high / scale.tic_step)})
    scale.widest_number =
        std::max(scale.widest_number, text_width(plain_text(fmt::sprintf(scale.format, tic * scale.tic_step))));
}

}  // namespace

bool can_be_shown(double value) { return std::isfinite(value) && std::abs(value) < infinity_in_files; }

double AxisScale::fraction(double value) const {
  if (!can_be_shown(value) || (logarithmic && value <= 0.0)) return std::numeric_limits<double>::quiet_NaN();
  if (logarithmic) return std::log(value / low) / std::log(high / low);
  return (value - low) / (high - low);
}

AxisScale choose_scale(const AxisSettings& settings, const std::vector<double>& values, int most_steps) {
  AxisScale scale;
  scale.logarithmic = settings.logarithmic;
  Range range = range_of(values, settings.logarithmic);
  if (settings.logarithmic) {
    if (range.is_empty() && !(settings.low && settings.high))
      throw UserError("a logarithmic axis can show positive values only, and there are none; leave --logx, --logy out");
    if (!range.is_empty()) {
      const double factor = range.high > range.low ? std::pow(range.high / range.low, margin) : 2.0;
      range = {range.low / factor, range.high * factor};
    }
    if ((settings.low && *settings.low <= 0.0) || (settings.high && *settings.high <= 0.0))
      throw UserError("the range of a logarithmic axis must be positive, as in --xrange 0.1:10");
  } else if (!range.is_empty()) {
    range = widened(range);
  } else {
    range = {0.0, 1.0};
  }
  refuse_range(settings);
  scale.low = settings.low.value_or(range.low);
  scale.high = settings.high.value_or(range.high);
  if (!settings.high && is_narrow(scale.low, scale.high)) scale.high = scale.low + std::max(1.0, std::abs(scale.low));
  if (!settings.low && is_narrow(scale.low, scale.high))
    scale.low = settings.logarithmic ? scale.high / 10.0 : scale.high - std::max(1.0, std::abs(scale.high));
  if (scale.logarithmic) {
    scale.format = "10^{%L}";
    scale.widest_number = 2.5;
  } else {
    set_linear_tics(scale, most_steps);
  }
  return scale;
}

}  // namespace tchat
