/// The exact discontinuity map beside its expansion, at penetrations over several decades, and the orders of the error.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "maps/discontinuity_map.hpp"

namespace tchat {

inline constexpr std::array<MapOrder, 3> expanded_orders{MapOrder::half, MapOrder::one, MapOrder::three_halves};

struct ComparedPenetration {
  double penetration = 0.0;
  double change = 0.0;             ///< |g(x0) - x*|, exact; NaN where the exact map has no value
  std::array<double, 3> errors{};  ///< |exact - expansion|, of the orders above
};

/// error ~ y^power, by least squares over the smallest penetrations at which rounding does not show.
struct ErrorOrder {
  double power = 0.0;
  double from = 0.0, to = 0.0;  ///< penetrations of the fit
};

struct MapComparison {
  std::vector<ComparedPenetration> rows;            ///< penetrations falling by tens
  std::array<std::optional<ErrorOrder>, 3> orders;  ///< nothing: the expansion is exact but for rounding
};

/// On the section of the map, straight into D from x*: the shortest tangent of the section along which h_D falls.
MapComparison compare_with_expansion(const DiscontinuityMap& map, double largest, int decades);

}  // namespace tchat
