/// Where contact segments have shrunk to nothing, or impacts have velocity zero: the segments before and after each of
/// them are one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "resegment/new_orbit.hpp"

namespace tchat {

struct OrbitWithoutContacts {
  LabelledOrbit orbit;  ///< with settings of its own; the direction is lost
  Signature signature;  ///< of the new orbit, as far as segments were joined
  /// Where the surfaces are touched, in segments of `orbit`, which are to leave them.
  std::vector<Birth::InnerContact> contacts;
};

/// The labelled orbit without its contact segments of no duration (model/events.hpp), and, if the label is of
/// an impact of velocity zero, without such impacts and the segments of no duration after them. Nothing when it has
/// none, or when `wanted`, the signature that the user gave, has as many segments as last some time. Where nothing but
/// the contact cut the orbit, it is cut where event function `wanted` falls through zero, without `wanted` at the
/// contact itself, where a velocity does; throws UserError when there is no such place.
std::optional<OrbitWithoutContacts> without_lost_contacts(const LabelledOrbit& source,
                                                          const std::optional<Signature>& wanted,
                                                          const HybridSystem& system);

}  // namespace tchat
