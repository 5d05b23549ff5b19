#include "resegment/new_orbit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "model/events.hpp"
#include "orbit/admissibility.hpp"
#include "resegment/contact_point.hpp"
#include "resegment/signature_match.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

int checked_jump(const HybridSystem& system, int jump, const char* what) {
  const int count = system.count(FunctionKind::jump);
  if (jump >= 1 && jump <= count) return jump;
  if (count == 0)
    throw UserError(fmt::format(
        "problem {} has no jump functions, so contact changes nothing: give it the jump that contact brings, or the "
        "field that holds beyond the surface",
        system.name()));
  throw UserError(fmt::format("{} is jump {}, but problem {} has {} jumps; allowed: 1..{}", what, jump, system.name(),
                              count, count));
}

int identity_jump(const HybridSystem& system, int field) {
  if (const int k = first_identity_jump(system, field); k != no_function) return k;
  throw UserError(fmt::format(
      "problem {} has no identity jump, which the cut at a grazing contact needs: add one (g = x) to the plugin, or "
      "choose the jump with --jump",
      system.name()));
}

/// Jumps for a contact with this field on segment s (from 0) that brings `own`: the identity, and others that leave
/// every state of the segment as it is. Where a state is constant (a velocity in stick) the identity may leave it
/// undetermined, and a jump that sets it does the same to the orbit and determines it.
std::vector<int> jumps_without_effect(const HybridSystem& system, const LabelledOrbit& source, int s, int field,
                                      int own) {
  const Orbit& x = source.start.orbit;
  const Eigen::VectorXd sizes = source.sizes(system);
  std::vector<int> jumps{identity_jump(system, field)};
  Eigen::VectorXd after(x.shape.dimension);
  const auto moves = [&](int jump) {
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      const Eigen::Map<const Eigen::VectorXd> state(x.node(s, k), x.shape.dimension);
      system.value(FunctionKind::jump, jump, state.data(), x.par.data(), after.data());
      if (!(length_in_sizes(after - state, sizes) <= level::located)) return true;
    }
    return false;
  };
  for (int k = 1; k <= system.count(FunctionKind::jump); ++k)
    if (k != own && k != jumps.front() && !moves(k)) jumps.push_back(k);
  return jumps;
}

/// The segments of the cut take the index vectors given by the user; the segments of no duration among them come after
/// the contacts, as many after each.
CutList with_signature(CutList cut, const Signature& signature, bool may_add) {
  const std::size_t pieces = cut.segments.size();
  const std::size_t added = signature.size() - std::min(signature.size(), pieces);
  if (signature.size() < pieces || (added > 0 && !may_add) || added % cut.contacts.size() != 0)
    throw UserError(
        fmt::format("--signature has {} index vectors, but the orbit cut at {} has {} segments{}", signature.size(),
                    cut.contacts.size() == 1 ? "the contact" : fmt::format("its {} contacts", cut.contacts.size()),
                    pieces, may_add ? "; further ones are segments of zero duration, as many after each contact" : ""));
  const std::size_t contacts = cut.contacts.size();
  for (std::size_t k = 0; k < contacts; ++k)
    cut = with_empty_segments(std::move(cut), k, static_cast<int>(added / contacts));
  for (std::size_t s = 0; s < signature.size(); ++s) {
    NewSegment& segment = cut.segments[s];
    if (!segment.piece.empty() && segment.index.field != signature[s].field)
      throw UserError(
          fmt::format("--signature: index vector {} has field {}, but that part of the orbit was computed "
                      "with field {}",
                      s + 1, signature[s].field, segment.index.field));
    const bool is_contact = std::find(cut.contacts.begin(), cut.contacts.end(), s) != cut.contacts.end();
    if (is_contact && segment.index.event != signature[s].event)
      throw UserError(
          fmt::format("--signature: index vector {} ends in event {}, but that segment ends in the contact "
                      "with event {}",
                      s + 1, signature[s].event, segment.index.event));
    segment.index = signature[s];
  }
  return cut;
}

std::string place_of(const ContactPoint& contact, const HybridSystem& system) {
  return fmt::format(
      "event {} ({}) {} segment {}", contact.event, system.function_name(FunctionKind::event, contact.event),
      contact.where == ContactPoint::inside ? fmt::format("at tau = {:.6g} of", contact.tau) : "at the end of",
      contact.segment + 1);
}

std::string list_of(const std::vector<ContactPoint>& contacts, const HybridSystem& system) {
  std::string list;
  for (const ContactPoint& contact : contacts) list += (list.empty() ? "" : ", ") + place_of(contact, system);
  return list;
}

/// Segment s (from 0) of the orbit no longer ends in `event` but in a section there, so that it may touch or not.
void end_in_section(NewSegment& segment, const LabelledOrbit& source, const HybridSystem& system) {
  const int event = segment.index.event;
  const auto section = section_at_end(source.start.orbit, source.sizes(system), system, segment.piece.segment,
                                      segment.index.field, event);
  if (!section)
    throw UserError(fmt::format(
        "event {} ({}) may be missed there once the impact is born elsewhere, so segment {} has to end in a section, "
        "but problem {} has no event function that falls through zero at the contact, as a velocity does; add one (the "
        "time derivative of that event function), or give --signature, or start from a GR label of an orbit that is "
        "cut elsewhere",
        event, system.function_name(FunctionKind::event, event), segment.piece.segment + 1, system.name()));
  segment.index.event = *section;
  segment.grazes = false;
  watch(segment, event);
}

std::vector<int> empty_segments(const SegmentList& segments) {
  std::vector<int> list;
  for (std::size_t s = 0; s < segments.size(); ++s)
    if (segments[s].piece.empty()) list.push_back(static_cast<int>(s));
  return list;
}

/// Watched events that come just where another one ends the segment.
std::vector<Birth::EndEvent> events_at_ends(const SegmentList& segments, const LabelledOrbit& source,
                                            const HybridSystem& system) {
  const Orbit& x = source.start.orbit;
  const Eigen::VectorXd sizes = source.sizes(system);
  std::vector<Birth::EndEvent> list;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const NewSegment& segment = segments[s];
    const Eigen::VectorXd end = end_of(segment.piece, x);
    if (segment.piece.empty()) continue;  // its own growth tells
    for (const WatchedEvent& watched : segment.watched) {
      if (watched.event == segment.index.event) continue;
      if (relative_event(system, watched.event, end, x.par.data(), sizes) <= level::same)
        list.push_back({static_cast<int>(s), watched.event});
    }
  }
  return list;
}

/// Segments of zero duration watch what the index jump function says; where it says nothing, what an old segment of
/// the same field watches, or what they have.
void watch_after_events(SegmentList& segments, const LabelledOrbit& source, const HybridSystem& system) {
  const Orbit& x = source.start.orbit;
  const Eigen::VectorXd sizes = source.sizes(system);
  for (const int empty : empty_segments(segments)) {
    const auto s = static_cast<std::size_t>(empty);
    NewSegment& segment = segments[s];
    const NewSegment& before = segments[(s + segments.size() - 1) % segments.size()];
    const int next_field = segments[(s + 1) % segments.size()].index.field;
    const std::vector<int> events =
        watched_after(system, before.index, end_of(before.piece, x), x.par, sizes, segment.index, next_field);
    if (!events.empty()) {
      segment.watched.clear();
      for (const int event : events) segment.watched.push_back({event, true});
    }
    if (!segment.watched.empty()) continue;
    for (const NewSegment& old : segments_of(source.settings))
      if (old.index.field == segment.index.field && segment.watched.empty()) segment.watched = old.watched;
  }
}

/// Impacts whose velocities vanish together with that of contact `own`: without them, and what follows them at once,
/// these segments end in sections.
CutList without_other_impacts(CutList cut, const std::vector<ContactPoint>& contacts, const ContactPoint& own,
                              const LabelledOrbit& source, const HybridSystem& system) {
  const Orbit& x = source.start.orbit;
  for (const ContactPoint& other : contacts) {
    if (other.segment == own.segment) continue;
    const auto at = std::find_if(cut.segments.begin(), cut.segments.end(),
                                 [&](const NewSegment& segment) { return segment.piece.segment == other.segment; });
    CutList alone{cut.segments, {static_cast<std::size_t>(at - cut.segments.begin()), cut.contacts.front()}};
    NewSegment& end = alone.segments[alone.contacts[0]];
    end_in_section(end, source, system);
    end.index.jump = identity_jump(system, end.index.field);
    alone = without_empty_segments(std::move(alone), 0, x);
    cut = {alone.segments, {alone.contacts[1]}};
  }
  return cut;
}

NewOrbit to_grazing_curve(const ResegmentRequest& request, const LabelledOrbit& source, const HybridSystem& system) {
  const Orbit& x = source.start.orbit;
  const ContactPoint contact = contact_point(source.solution, x, system, source.settings, source.name);
  const auto at = static_cast<std::size_t>(contact.segment);
  if (contact.where == ContactPoint::grazing_curve)
    throw UserError(
        fmt::format("{} lies on a grazing curve already; `tchat run` goes on along it, and where two events change "
                    "places with the signature of --to signature --signature '...'",
                    source.name));
  const IndexVector& index = source.settings.segments[at].index;
  const int own = index.jump;
  const int jump = request.jump                             ? *request.jump
                   : contact.where == ContactPoint::section ? own
                                                            : identity_jump(system, index.field);
  const std::vector<ContactPoint> contacts = simultaneous_contacts(contact, x, system, source.settings);
  const bool keeps_identity = !request.jump && jump == no_function;
  CutList cut = cut_at({segments_of(source.settings), {}}, contact,
                       keeps_identity ? no_function : checked_jump(system, jump, "--jump"));
  if (contact.where == ContactPoint::impact) {
    cut = without_empty_segments(std::move(cut), 0, x);
    cut = without_other_impacts(std::move(cut), contacts, contact, source, system);
  }
  if (request.signature) cut = with_signature(std::move(cut), parse_signature(*request.signature), false);
  cut.segments[cut.contacts.front()].grazes = true;
  const int contact_jump =
      contact.where == ContactPoint::impact ? own : jump_at_contact(system, source.settings, x, contact);
  NewOrbit target{cut.segments, {150, 1, contact_jump}};
  target.contact = cut.contacts.front();
  if (!request.jump && !request.signature && contact.where != ContactPoint::section)
    target.contact_jumps = jumps_without_effect(system, source, contact.segment, index.field, contact_jump);
  if (contacts.size() > 1)
    target.remarks.push_back(fmt::format("The orbit has {} contacts at once ({}); the curve keeps that of its label.",
                                         contacts.size(), list_of(contacts, system)));
  return target;
}

/// The orbit once more, without impacts: what is in contact on a grazing curve need not be where the impact is missing.
SegmentList turn_without_contact(const LabelledOrbit& source, const std::vector<ContactPoint>& contacts, bool is_given,
                                 const HybridSystem& system) {
  SegmentList segments = segments_of(source.settings);
  for (const ContactPoint& contact : contacts) {
    NewSegment& segment = segments[static_cast<std::size_t>(contact.segment)];
    watch(segment, contact.event);
    if (contact.where == ContactPoint::grazing_curve && !is_given) end_in_section(segment, source, system);
  }
  return segments;
}

/// The jump that a contact brings: the one given, else what the problem says, else the identity where another field is
/// given for what is beyond the surface, else GRJUMP.
int impact_jump(const ResegmentRequest& request, const LabelledOrbit& source, const ContactPoint& contact,
                const HybridSystem& system) {
  if (request.jump) return checked_jump(system, *request.jump, "--jump");
  const IndexVector& index = source.settings.segments[static_cast<std::size_t>(contact.segment)].index;
  if (request.contact && !system.has_successors()) return identity_jump(system, index.field);
  return checked_jump(system, jump_at_contact(system, source.settings, source.start.orbit, contact),
                      "GRJUMP, the jump that contact brings,");
}

/// Segments of no duration after each contact, as they follow from the problem or --contact.
CutList with_following_segments(const ResegmentRequest& request, CutList cut, const LabelledOrbit& source,
                                const HybridSystem& system) {
  const Orbit& orbit = source.start.orbit;
  for (std::size_t k = 0; k < cut.contacts.size(); ++k) {
    const NewSegment& impact = cut.segments[cut.contacts[k]];
    const NewSegment& next = cut.segments[(cut.contacts[k] + 1) % cut.segments.size()];
    const Signature between = request.contact ? Signature{given_contact(*request.contact, system)}
                                              : segments_after_impact(system, impact.index, end_of(impact.piece, orbit),
                                                                      orbit.par, next.index.field);
    cut = with_empty_segments(std::move(cut), k, static_cast<int>(between.size()));
    for (std::size_t i = 0; i < between.size(); ++i) cut.segments[cut.contacts[k] + 1 + i].index = between[i];
    if (!request.jump) require_change(cut, k, source, system);
  }
  return cut;
}

/// Beyond the surface the event function that led there is negative: watched is the one that ends the contact.
void watch_contact(SegmentList& segments, std::size_t before) {
  NewSegment& contact = segments[(before + 1) % segments.size()];
  if (contact.index.event == segments[before].index.event) return;
  std::erase_if(contact.watched, [&](const WatchedEvent& w) { return w.event == segments[before].index.event; });
  watch(contact, contact.index.event);
}

NewOrbit to_impacting(const ResegmentRequest& request, const LabelledOrbit& source, const HybridSystem& system) {
  const Orbit& orbit = source.start.orbit;
  const RunSettings& old = source.settings;
  const ContactPoint own = contact_point(source.solution, orbit, system, old, source.name);
  if (own.where == ContactPoint::impact)
    throw UserError(
        fmt::format("{} is where an impact of this signature has velocity zero: the impacting orbits are those of its "
                    "own branch; `tchat run` goes on along it",
                    source.name));
  const std::vector<ContactPoint> contacts = simultaneous_contacts(own, orbit, system, old);
  CutList cut{segments_of(old), {}};
  for (auto contact = contacts.rbegin(); contact != contacts.rend(); ++contact) {
    const int jump = impact_jump(request, source, *contact, system);
    cut = cut_at(std::move(cut), *contact, jump);
  }
  const SegmentList turn = turn_without_contact(source, contacts, request.repeats == 1 || request.signature, system);
  for (int k = 1; k < request.repeats; ++k) cut.segments = joined(std::move(cut.segments), turn);
  cut = request.signature ? with_signature(std::move(cut), parse_signature(*request.signature), true)
                          : with_following_segments(request, std::move(cut), source, system);
  watch_after_events(cut.segments, source, system);
  NewOrbit target{cut.segments, {periodic_orbit.number, periodic_orbit.branch_mode, old.grazing_jump}};
  target.birth = {{cut.contacts.begin(), cut.contacts.end()}, empty_segments(cut.segments), {}};
  if (contacts.size() > 1)
    target.remarks.push_back(fmt::format("The orbit has {} contacts at once and is cut at all of them: {}.",
                                         contacts.size(), list_of(contacts, system)));
  std::size_t contacts_born = 0;
  for (std::size_t k = 0; k < cut.contacts.size(); ++k) {
    if (!is_contact_born(cut, k, source, system)) continue;
    ++contacts_born;
    watch_contact(target.segments, cut.contacts[k]);
    target.remarks.push_back(
        fmt::format("Segment {} lasts no time here; along the branch its duration grows like the square root of the "
                    "parameter.",
                    (cut.contacts[k] + 1) % cut.segments.size() + 1));
  }
  if (contacts_born > 1)
    throw UserError(fmt::format(
        "{}: {} contacts begin here at once ({}), and how their durations grow is not determined by an "
        "orbit where none lasts any time. Begin beyond it with an orbit of a simulation (tchat simulate "
        "NAME --dat O) and come back to it; or follow half of a symmetric orbit, with the symmetry as a jump",
        source.name, contacts_born, list_of(contacts, system)));
  return target;
}

/// The segment that ends in the contact which the problem type keeps.
void mark_contact(const RunSettings& settings, SegmentList& segments) {
  if (const std::optional<int> s = contact_segment(settings)) segments[static_cast<std::size_t>(*s)].grazes = true;
}

/// Two events at once change places, a segment of no duration vanishes or appears.
NewOrbit to_signature(const ResegmentRequest& request, const LabelledOrbit& source, const HybridSystem& system) {
  if (!request.signature)
    throw UserError("--to signature needs the new signature, for example --signature \"1,1,1;2,2,2\"");
  const RunSettings& old = source.settings;
  SegmentList before = segments_of(old);
  mark_contact(old, before);
  SegmentList segments = matched(system, before, source.start.orbit, parse_signature(*request.signature));
  if (keeps_contact(old.problem_type) &&
      std::none_of(segments.begin(), segments.end(), [](const auto& s) { return s.grazes; }))
    throw UserError(
        fmt::format("--signature {}: {} lies on a grazing curve, and no segment of this signature ends in "
                    "its contact",
                    *request.signature, source.name));
  watch_after_events(segments, source, system);
  NewOrbit target{segments, {old.problem_type, old.branch_mode, old.grazing_jump}, source.solution.type};
  target.birth = {{}, empty_segments(segments), events_at_ends(segments, source, system)};
  return target;
}

NewOrbit to_rotated(const ResegmentRequest& request, const LabelledOrbit& source) {
  const RunSettings& old = source.settings;
  const int m = static_cast<int>(old.segments.size());
  SegmentList segments = segments_of(old);
  mark_contact(old, segments);
  NewOrbit target{rotated(segments, request.rotation),
                  {old.problem_type, old.branch_mode, old.grazing_jump},
                  source.solution.type,
                  source.solution.kind,
                  source.solution.further};
  const auto rotate = [&](UserPointKind& kind) {
    if (kind.segment > 0) kind.segment = (((kind.segment - 1 - request.rotation) % m) + m) % m + 1;
  };
  rotate(target.kind);
  for (UserPointKind& kind : target.further) rotate(kind);
  return target;
}

/// At a period doubling, or anywhere on a curve of them, the doubled problem has a branch point: ISW = -1 goes from
/// there to the doubled orbit.
NewOrbit to_repeated(const LabelledOrbit& source) {
  if (keeps_contact(source.settings.problem_type))
    throw UserError(fmt::format("{} lies on a grazing curve; an orbit of type IPS = 180 can be doubled", source.name));
  constexpr int period_doubling = static_cast<int>(PointType::period_doubling);
  const int type = source.solution.type;
  const bool doubling = basic_type(type) == period_doubling || curve_type(type) == period_doubling;
  NewOrbit target{repeated(segments_of(source.settings)),
                  {periodic_orbit.number, doubling ? branch_switch.branch_mode : periodic_orbit.branch_mode,
                   source.settings.grazing_jump}};
  target.type = static_cast<int>(doubling ? PointType::branch_point : PointType::end);
  return target;
}

}  // namespace

LabelledOrbit with_segments(LabelledOrbit labelled, Orbit x, const SegmentList& segments, const HybridSystem& system) {
  const RunSettings old = labelled.settings;
  labelled.settings = new_settings(old, segments, {old.problem_type, old.branch_mode, old.grazing_jump, false}, system);
  labelled.solution.type = static_cast<int>(PointType::end);
  labelled.solution.kind = {};
  labelled.solution.further.clear();
  labelled.start = {std::move(x), std::nullopt};
  return labelled;
}

NewOrbit new_orbit(const ResegmentRequest& request, const LabelledOrbit& source, const HybridSystem& system) {
  if (request.repeats != 1 && request.kind != ResegmentKind::impacting)
    throw UserError("--repeat goes with --to impacting; --to double repeats any orbit twice");
  if (request.contact && request.kind != ResegmentKind::impacting)
    throw UserError("--contact goes with --to impacting: it says what follows a contact that is born");
  if (request.contact && request.signature)
    throw UserError("--contact and --signature both say what follows the contact; give one of them");
  switch (request.kind) {
    case ResegmentKind::grazing_curve:
      return to_grazing_curve(request, source, system);
    case ResegmentKind::impacting:
      return to_impacting(request, source, system);
    case ResegmentKind::signature:
      return to_signature(request, source, system);
    case ResegmentKind::rotate:
      return to_rotated(request, source);
    default:
      return to_repeated(source);
  }
}

namespace {

const NewSegment& after_contact(const CutList& cut, std::size_t k) {
  return cut.segments[(cut.contacts[k] + 1) % cut.segments.size()];
}

std::string field_text(const HybridSystem& system, int field) {
  return fmt::format("field {} ({})", field, system.function_name(FunctionKind::field, field));
}

std::string event_name(const HybridSystem& system, int event) {
  return fmt::format("event {} ({})", event, system.function_name(FunctionKind::event, event));
}

void require_number(const HybridSystem& system, FunctionKind kind, int number, const char* what) {
  if (number <= system.count(kind)) return;
  throw UserError(
      fmt::format("--contact: there is no {} {}, problem {} has {}", what, number, system.name(), system.count(kind)));
}

}  // namespace

IndexVector given_contact(const std::string& text, const HybridSystem& system) {
  const Signature given = parse_signature(text, "--contact");
  if (given.size() != 1)
    throw UserError(
        fmt::format("--contact is one index vector, the field beyond the surface, the event that ends it and "
                    "its jump, as 2,2,1; {} were given: the whole orbit is for --signature",
                    given.size()));
  require_number(system, FunctionKind::field, given.front().field, "field");
  require_number(system, FunctionKind::event, given.front().event, "event function");
  require_number(system, FunctionKind::jump, given.front().jump, "jump");
  return given.front();
}

void require_change(const CutList& cut, std::size_t k, const LabelledOrbit& source, const HybridSystem& system) {
  const NewSegment& contact = cut.segments[cut.contacts[k]];
  const NewSegment& next = after_contact(cut, k);
  if (next.piece.empty() || next.index.field != contact.index.field || !is_identity_jump(system, contact.index)) return;
  throw UserError(fmt::format(
      "{}: contact with {} would change nothing: its jump {} ({}) leaves the state as it is, and {} {} after it. Where "
      "another field holds beyond the surface, say which, until which event and with which jump: --contact "
      "FIELD,EVENT,JUMP; where the contact is an impact, --jump",
      source.name, event_name(system, contact.index.event), contact.index.jump,
      system.function_name(FunctionKind::jump, contact.index.jump),
      system.has_successors()
          ? "the index jump function lets"
          : fmt::format("problem {} has no index jump function that says what follows:", system.name()),
      system.has_successors() ? field_text(system, contact.index.field) + " go on"
                              : field_text(system, contact.index.field) + " goes on"));
}

bool is_contact_born(const CutList& cut, std::size_t k, const LabelledOrbit& source, const HybridSystem& system) {
  const NewSegment& before = cut.segments[cut.contacts[k]];
  const NewSegment& beyond = after_contact(cut, k);
  if (!beyond.piece.empty() || !is_contact_segment(system, before.index, beyond.index)) return false;
  const Orbit& x = source.start.orbit;
  const Eigen::VectorXd at = end_of(before.piece, x);
  const int field = beyond.index.field;
  const EventAt met = event_at(system, before.index.event, field, at.data(), x.par.data());
  const auto refuse = [&](const std::string& why) {
    throw UserError(fmt::format("{}: no orbit with a short contact with {} begins here: {}", source.name,
                                event_name(system, before.index.event), why));
  };
  const double scale = met.rate_scale(state_sizes(system, source.settings.signature(), x));
  if (met.rate() > tangent_contact * scale)
    refuse(
        fmt::format("beyond the surface {} leads back to it at once (h_x f = {:.4g}, not 0), so that orbits slide "
                    "along it: the signature with a sliding mode, --to signature",
                    field_text(system, field), met.rate()));
  if (met.rate() < -tangent_contact * scale)
    refuse(
        fmt::format("beyond the surface {} leads away from it (h_x f = {:.4g}, not 0), so that the orbit does not "
                    "come back soon; a simulation shows where it goes (tchat simulate NAME --dat O)",
                    field_text(system, field), met.rate()));
  const double curvature = rate_gradient(system, met, before.index.event, field, at.data(), x.par.data()).dot(met.f);
  if (!(curvature > 0.0))
    refuse(
        fmt::format("beyond the surface {} curves away from it (h'' = {:.4g}, not > 0), so that the orbit does not "
                    "come back soon; a simulation shows where it goes (tchat simulate NAME --dat O)",
                    field_text(system, field), curvature));
  const EventAt left = event_at(system, beyond.index.event, field, at.data(), x.par.data());
  if (left.gradient.dot(met.gradient) > 0.0)
    throw UserError(
        fmt::format("{}: the contact cannot end in {}, which falls through zero where it begins and rises where it "
                    "ends: name an event function of the other sign, -h, that is positive beyond the surface",
                    source.name, event_name(system, beyond.index.event)));
  return true;
}

}  // namespace tchat
