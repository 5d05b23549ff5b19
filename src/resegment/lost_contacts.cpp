#include "resegment/lost_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "model/events.hpp"
#include "orbit/orbit.hpp"
#include "resegment/contact_point.hpp"

namespace tchat {

namespace {

/// Old segments (from 0) that become one, in their order.
using Group = std::vector<int>;

class LostContacts {
 public:
  LostContacts(const LabelledOrbit& source, const HybridSystem& system)
      : source_(source),
        system_(system),
        signature_(source.settings.signature()),
        x_(source.start.orbit),
        sizes_(state_sizes(system, signature_, x_)) {
    is_open_.assign(signature_.size(), false);
    for (int s = 0; s < count(); ++s) lost_.push_back(is_lost(s));
    for (int s = 0; s < count(); ++s)
      if (is_lost_at(s)) is_open_[static_cast<std::size_t>(before(s))] = true;
    find_lost_impacts();
  }

  bool any() const { return std::find(is_open_.begin(), is_open_.end(), true) != is_open_.end(); }

  /// Segments that last some time.
  std::size_t lasting() const {
    std::size_t number = 0;
    for (int s = 0; s < count(); ++s) number += lasts_no_time(x_, s) || is_lost_at(s) ? 0 : 1;
    return number;
  }

  OrbitWithoutContacts remove(const std::optional<Signature>& wanted) {
    find_groups();
    OrbitWithoutContacts result{source_, {}, {}};
    SegmentList list;
    std::vector<std::vector<OrbitPiece>> pieces;
    for (const Group& group : groups_) {
      list.push_back(one_of(group));
      pieces.emplace_back();
      for (const int s : group) pieces.back().push_back({s, 0.0, 1.0});
      add_contacts(group, static_cast<int>(list.size()) - 1, result.contacts);
    }
    LabelledOrbit& orbit = result.orbit;
    orbit.start = {joined_orbit(x_, pieces), std::nullopt};
    if (is_closed_) cut_again(wanted, list, result);
    orbit = with_segments(source_, std::move(orbit.start.orbit), list, system_);
    result.signature = orbit.settings.signature();
    return result;
  }

 private:
  int count() const { return x_.shape.segments; }
  int after(int s) const { return (s + 1) % count(); }
  int before(int s) const { return (s + count() - 1) % count(); }
  const IndexVector& index(int s) const { return signature_[static_cast<std::size_t>(s)]; }
  bool is_lost_at(int s) const { return lost_[static_cast<std::size_t>(s)]; }
  bool is_open(int s) const { return is_open_[static_cast<std::size_t>(s)]; }

  /// A contact between two segments of one field, which end in its jump as if it were none.
  bool is_lost(int s) const {
    if (!is_contact_segment(system_, signature_, s) || !contact_lasts_no_time(x_, s)) return false;
    return index(before(s)).field == index(after(s)).field && !is_lost_before(s);
  }
  /// Of two neighbours that both last no time the first is the contact.
  bool is_lost_before(int s) const { return s > 0 && lost_[static_cast<std::size_t>(s - 1)]; }

  /// Impacts of velocity zero, where the label is of one: their jumps change nothing, and the segments of no duration
  /// after them are lost too.
  void find_lost_impacts() {
    if (source_.solution.kind.kind != UserPointKind::impact_velocity) return;
    const ContactPoint own = contact_point(source_.solution, x_, system_, source_.settings, source_.name);
    if (own.where != ContactPoint::impact) return;
    for (const ContactPoint& impact : simultaneous_contacts(own, x_, system_, source_.settings)) {
      if (!leaves_state(impact.segment)) continue;
      std::vector<int> empty;
      int next = after(impact.segment);
      for (; next != impact.segment && lasts_no_time(x_, next); next = after(next)) empty.push_back(next);
      if (index(next).field != index(impact.segment).field) continue;
      for (const int s : empty) lost_[static_cast<std::size_t>(s)] = true;
      is_open_[static_cast<std::size_t>(impact.segment)] = true;
    }
  }

  bool leaves_state(int s) const {
    const Eigen::Map<const Eigen::VectorXd> end(x_.end(s), x_.shape.dimension);
    Eigen::VectorXd image(end.size());
    system_.value(FunctionKind::jump, index(s).jump, end.data(), x_.par.data(), image.data());
    return length_in_sizes(image - end, sizes_) <= level::located;
  }

  /// Groups end where the end of a segment remains; when none does, the orbit is closed at the first one that a section
  /// meets, else at the last one.
  void find_groups() {
    int last = -1;
    for (int s = 0; s < count(); ++s)
      if (!is_lost_at(s) && !is_open(s)) last = s;
    is_closed_ = last < 0;
    for (int s = 0; is_closed_ && s < count(); ++s) {
      if (is_lost_at(s)) continue;
      last = s;
      if (section_at_end(x_, sizes_, system_, s, index(s).field, index(s).event)) break;
    }
    groups_.assign(1, {});
    for (int k = 1; k <= count(); ++k) {
      const int s = (last + k) % count();
      if (is_lost_at(s)) continue;
      groups_.back().push_back(s);
      if (!is_open(s) && s != last) groups_.emplace_back();
    }
  }

  /// Index vector of the last one; what any of them watches, and the surfaces that are touched.
  NewSegment one_of(const Group& group) const {
    const SegmentList old = segments_of(source_.settings);
    const int number = static_cast<int>(&group - groups_.data());
    NewSegment joined{{number, 0.0, 1.0}, index(group.back()), false, {}};
    for (const int s : group) {
      for (const WatchedEvent& watched : old[static_cast<std::size_t>(s)].watched) watch(joined, watched.event);
      if (s != group.back() || is_closed_) watch(joined, index(s).event);
    }
    return joined;
  }

  void add_contacts(const Group& group, int number, std::vector<Birth::InnerContact>& contacts) const {
    double total = 0.0;
    for (const int s : group) total += x_.duration(s);
    double time = 0.0;
    for (const int s : group) {
      time += x_.duration(s);
      if (s != group.back() || is_closed_) contacts.push_back({number, index(s).event, time / total});
    }
  }

  /// What the problem lets follow the section; an identity jump where it does not say.
  int jump_of_section(int field, int section) const {
    const int last = before(groups_.front().front());
    const auto watched = system_.successors(index(last), x_.end(last), x_.par.data());
    if (watched)
      for (const IndexVector& v : *watched)
        if (v.field == field && v.event == section) return v.jump;
    return identity(field);
  }

  int identity(int field) const {
    if (const int k = first_identity_jump(system_, field); k != no_function) return k;
    throw UserError(fmt::format("problem {} has no identity jump, which a cut without contact needs: add one (g = x)",
                                system_.name()));
  }

  /// The one segment of a closed orbit ends at a contact that is lost: another section is wanted.
  void cut_again(const std::optional<Signature>& wanted, SegmentList& list, OrbitWithoutContacts& result) const {
    NewSegment& only = list.front();
    if (!wanted) {
      const auto section =
          section_at_end(result.orbit.start.orbit, sizes_, system_, 0, only.index.field, only.index.event);
      if (!section)
        throw UserError(fmt::format(
            "{}: without its contact nothing cuts the orbit, and problem {} has no event function that falls through "
            "zero at the contact, as a velocity does; name a section with --signature \"{},EVENT,JUMP\"",
            source_.name, system_.name(), only.index.field));
      only.index = {only.index.field, *section, jump_of_section(only.index.field, *section)};
      return;
    }
    if (wanted->size() != 1)
      throw UserError(
          fmt::format("{}: without its contact nothing cuts the orbit: --signature has to be one index vector, whose "
                      "event is a section, not {}",
                      source_.name, wanted->size()));
    only.index = wanted->front();
    require_function(FunctionKind::event, only.index.event);
    require_function(FunctionKind::jump, only.index.jump);
    Orbit& x = result.orbit.start.orbit;
    const double at = place_of_section(x, only.index);
    if (at == 1.0) return;
    x = joined_orbit(x, {{{0, at, 1.0}, {0, 0.0, at}}});
    for (Birth::InnerContact& contact : result.contacts) {
      contact.tau -= at;
      if (contact.tau < 0.0) contact.tau += 1.0;
    }
  }

  void require_function(FunctionKind kind, int number) const {
    if (number >= 1 && number <= system_.count(kind)) return;
    throw UserError(fmt::format("--signature: problem {} has {} {}, there is no {}", system_.name(),
                                system_.count(kind), kind == FunctionKind::event ? "event functions" : "jumps",
                                number));
  }

  template <class Value>
  static double zero_between(const Value& value, double from, double to, double high, double low) {
    std::uintmax_t iterations = 60;
    const auto bracket = boost::math::tools::toms748_solve(value, from, to, high, low,
                                                           boost::math::tools::eps_tolerance<double>(48), iterations);
    return 0.5 * (bracket.first + bracket.second);
  }

  /// The end, where the section is met there; else the first place where it is met from above.
  double place_of_section(const Orbit& x, const IndexVector& section) const {
    constexpr double on_it = level::located;
    const CollocationRule rule(x.shape.collocation);
    // A contact touches its surface; which way it goes through there is rounding.
    const auto falls = [&](const EventAt& event) { return event.rate() < -on_it * event.rate_scale(sizes_); };
    const auto value = [&](double tau) {
      return system_.event(section.event, state_at(x, rule, 0, tau).data(), x.par.data());
    };
    const EventAt end = event_at(system_, section.event, section.field, x.end(0), x.par.data());
    if (std::abs(end.h) <= on_it * end.scale(x.end(0), sizes_) && falls(end)) return 1.0;
    for (int k = 1; k < x.shape.nodes_of(0); ++k) {
      const double from = x.tau(0, k - 1);
      const double to = x.tau(0, k);
      const double high = value(from);
      const double low = value(to);
      if (!(high > 0.0 && low <= 0.0)) continue;
      const double at = low == 0.0 ? to : zero_between(value, from, to, high, low);
      const Eigen::VectorXd there = state_at(x, rule, 0, at);
      if (falls(event_at(system_, section.event, section.field, there.data(), x.par.data()))) return at;
    }
    throw UserError(
        fmt::format("--signature: event {} ({}) does not fall through zero along the orbit of {}, so it cannot cut it",
                    section.event, system_.function_name(FunctionKind::event, section.event), source_.name));
  }

  const LabelledOrbit& source_;
  const HybridSystem& system_;
  Signature signature_;
  const Orbit& x_;
  Eigen::VectorXd sizes_;      // of states
  std::vector<bool> lost_;     // of each segment
  std::vector<bool> is_open_;  // its end is no longer one
  std::vector<Group> groups_;
  bool is_closed_ = false;
};

}  // namespace

std::optional<OrbitWithoutContacts> without_lost_contacts(const LabelledOrbit& source,
                                                          const std::optional<Signature>& wanted,
                                                          const HybridSystem& system) {
  LostContacts lost(source, system);
  if (!lost.any()) return std::nullopt;
  const std::size_t lasting = lost.lasting();
  const bool is_cut_again = lasting == 1;
  if (wanted && wanted->size() >= lasting && !(is_cut_again && wanted->size() == 1)) return std::nullopt;
  return lost.remove(wanted);
}

}  // namespace tchat
