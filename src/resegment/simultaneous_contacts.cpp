#include "resegment/simultaneous_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "model/event_at.hpp"
#include "model/identity_jump.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"
#include "orbit/periodic_orbit_system.hpp"

namespace tchat {

namespace {

/// Of the size of h on the segment: what the location of the label and its mesh leave of a contact.
constexpr double touching = 1e-6;
/// In tau: a contact nearer than this to a segment's end is on it, two contacts nearer than this are one.
constexpr double same_place = 1e-6;

struct Slope {
  double h = 0.0;
  double rate = 0.0;   ///< h_x f
  double scale = 0.0;  ///< |h_x| |f|

  bool is_tangent() const { return std::abs(rate) <= tangent_contact * scale; }
};

Slope slope_at(const HybridSystem& system, int field, int event, const double* x, const double* par) {
  const EventAt at = event_at(system, event, field, x, par);
  return {at.h, at.rate(), at.sizes()};
}

double largest_value(const HybridSystem& system, const Orbit& x, int s, int event) {
  double largest = 0.0;
  for (int k = 0; k < x.shape.nodes_of(s); ++k)
    largest = std::max(largest, std::abs(system.event(event, x.node(s, k), x.par.data())));
  return largest;
}

/// Is the end of segment s a Poincare section: the same state and field after it?
bool ends_in_section(const HybridSystem& system, const RunSettings& settings, int s) {
  const auto m = settings.segments.size();
  const IndexVector& own = settings.segments[static_cast<std::size_t>(s)].index;
  const IndexVector& next = settings.segments[(static_cast<std::size_t>(s) + 1) % m].index;
  return is_identity_jump(system, own) && next.field == own.field;
}

bool same(const ContactPoint& a, const ContactPoint& b) {
  return a.event == b.event && a.segment == b.segment && std::abs(a.tau - b.tau) < same_place;
}

class Search {
 public:
  Search(const ContactPoint& own, const Orbit& x, const HybridSystem& system, const RunSettings& settings)
      : x_(x), system_(system), settings_(settings), found_{own} {}

  std::vector<ContactPoint> run() {
    const ContactPoint own = found_.front();
    for (int s = 0; s < x_.shape.segments; ++s)
      if (own.where == ContactPoint::impact)
        add_vanishing_impact(s);
      else if (!lasts_no_time(x_, s))
        for (const int event : settings_.segments[static_cast<std::size_t>(s)].monitor) add_contacts(s, event);
    std::sort(found_.begin(), found_.end(), [](const ContactPoint& a, const ContactPoint& b) {
      return std::tie(a.segment, a.tau) < std::tie(b.segment, b.tau);
    });
    return found_;
  }

 private:
  const IndexVector& index(int s) const { return settings_.segments[static_cast<std::size_t>(s)].index; }

  void add(const ContactPoint& contact) {
    for (const ContactPoint& known : found_)
      if (same(known, contact)) return;
    found_.push_back(contact);
  }

  void add_vanishing_impact(int s) {
    if (is_identity_jump(system_, index(s))) return;
    if (slope_at(system_, index(s).field, index(s).event, x_.end(s), x_.par.data()).is_tangent())
      add({ContactPoint::impact, s, index(s).event, 1.0});
  }

  void add_contacts(int s, int event) {
    const PeriodicOrbitSystem orbit(system_, settings_.signature(), {});
    const CollocationRule rule(x_.shape.collocation);
    const double level = touching * largest_value(system_, x_, s, event);
    for (const EventMinimum& contact : least_candidates(orbit, rule, x_, s, event)) {
      if (!(std::abs(contact.value) <= level)) continue;
      if (contact.tau > same_place && contact.tau < 1.0 - same_place)
        add({ContactPoint::inside, s, event, contact.tau});
      else
        add_on_section(contact.tau > 0.5 ? s : (s + x_.shape.segments - 1) % x_.shape.segments, event);
    }
  }

  void add_on_section(int s, int event) {
    const bool touches = slope_at(system_, index(s).field, event, x_.end(s), x_.par.data()).is_tangent();
    if (touches && index(s).event != event && ends_in_section(system_, settings_, s))
      add({ContactPoint::section, s, event, 1.0});
  }

  const Orbit& x_;
  const HybridSystem& system_;
  const RunSettings& settings_;
  std::vector<ContactPoint> found_;
};

}  // namespace

std::vector<ContactPoint> simultaneous_contacts(const ContactPoint& own, const Orbit& x, const HybridSystem& system,
                                                const RunSettings& settings) {
  return Search(own, x, system, settings).run();
}

std::optional<int> section_at_end(const Orbit& x, const HybridSystem& system, int s, int field, int event) {
  const Eigen::Map<const Eigen::VectorXd> end(x.end(s), x.shape.dimension);
  for (int j = 1; j <= system.count(FunctionKind::event); ++j) {
    if (j == event) continue;
    const Slope slope = slope_at(system, field, j, end.data(), x.par.data());
    if (std::abs(slope.h) <= touching * (1.0 + end.lpNorm<Eigen::Infinity>()) && slope.rate < 0.0 &&
        !slope.is_tangent())
      return j;
  }
  return std::nullopt;
}

}  // namespace tchat
