/// One `tchat sweep --map`: what the command line says of the map.
#pragma once

#include <optional>
#include <string>

namespace tchat {

struct MapRequest {
  std::string source;                   ///< q.NAME:LABEL, or a file of section points of a torus
  std::string order = "3/2";            ///< of the discontinuity map: 1/2, 1, 3/2 or exact
  int smooth_order = 1;                 ///< of the smooth return map: 1 or 2
  std::optional<std::string> reduced;   ///< "map" or "ellipse": the phase of a torus alone
  std::optional<std::string> phase;     ///< a state that is an angle, or two states "y1,y2" that go round
  std::optional<std::string> wall;      ///< event function of the contact, by number or name
  std::optional<double> neighbourhood;  ///< of x*, in extents of the torus, in which contact is accounted for
};

}  // namespace tchat
