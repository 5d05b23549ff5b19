/// Floquet multipliers in the complex plane, with the unit circle.
#pragma once

#include <string>
#include <vector>

#include "files/diagnostics_file.hpp"
#include "plot/figure.hpp"

namespace tchat {

/// The points of one branch, or those of them that were asked for.
struct MultiplierSeries {
  std::string name;  ///< for the key
  std::vector<DiagnosticPoint> points;
};

struct MultiplierFigureOptions {
  bool labelled_points = false;     ///< single labels were asked for: open circles where a multiplier is outside
  std::vector<std::string> legend;  ///< a text for each series
};

/// Filled circles where stable, open ones where not, black at the start of a lone branch and grey at its end, as the
/// key says. Multipliers far outside (|mu| > 2.5, unless the user's ranges
/// say otherwise) are counted in a note. Throws UserError when there are no multipliers at all.
Figure multiplier_figure(const std::vector<MultiplierSeries>& series, const MultiplierFigureOptions& options);

}  // namespace tchat
