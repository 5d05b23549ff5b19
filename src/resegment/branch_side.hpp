/// Which way a branch leads that begins where an event or a segment is born.
#pragma once

#include <vector>

#include "model/hybrid_system.hpp"
#include "run/orbit_start.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// What is born at the start of a branch; segments count from 0.
struct Birth {
  std::vector<int> impacts;         ///< segments whose ends are in grazing contact: h_x f is to fall there
  std::vector<int> empty_segments;  ///< of zero duration: it is to grow

  struct EndEvent {
    int segment, event;
  };
  std::vector<EndEvent> late_events;  ///< zero just at the end of a segment that another event ends: to come later

  struct InnerContact {
    int segment, event;
    double tau;
  };
  std::vector<InnerContact> lost_contacts = {};  ///< the surface is touched there: the orbit is to leave it

  bool is_any() const {
    return !impacts.empty() || !empty_segments.empty() || !late_events.empty() || !lost_contacts.empty();
  }
};

/// The sign of DS with which the run of `settings` from `start` leads to where all of these exist. 0 when they
/// disagree, when nothing changes along the tangent, and when the run's first point is not the start (or none is
/// found).
int side_of_birth(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start,
                  const Birth& birth);

}  // namespace tchat
