/// The range of an axis and its tics.
#pragma once

#include <string>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

struct AxisScale {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;
  double tic_step = 0.2;       ///< of linear axes
  std::string format = "%g";   ///< printf format of the tics' numbers
  double widest_number = 1.0;  ///< of the tics, in units of the font's size

  /// Where a value stands, 0 at the low end and 1 at the high end; NaN for what a logarithmic axis cannot show.
  double fraction(double value) const;
};

/// A range that holds all `values` with a margin, the ends that the user chose kept, and tics at round numbers, at most
/// `most_steps` apart. Values that are not finite, beyond 1e90 in size, or not positive on a logarithmic axis
/// are left out of account. Throws UserError when a logarithmic axis has nothing positive to show.
AxisScale choose_scale(const AxisSettings& settings, const std::vector<double>& values, int most_steps);

/// Can this value be shown at all? Larger ones stand for infinity in p-files.
bool can_be_shown(double value);

}  // namespace tchat
