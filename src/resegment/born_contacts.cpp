#include "resegment/born_contacts.hpp"

#include <fmt/format.h>

#include "base/user_error.hpp"
#include "model/contact_segment.hpp"
#include "model/event_at.hpp"
#include "model/identity_jump.hpp"
#include "orbit/admissibility.hpp"
#include "resegment/new_orbit.hpp"

namespace tchat {

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
  if (met.rate() > tangent_contact * met.sizes())
    refuse(
        fmt::format("beyond the surface {} leads back to it at once (h_x f = {:.4g}, not 0), so that orbits slide "
                    "along it: the signature with a sliding mode, --to signature",
                    field_text(system, field), met.rate()));
  if (met.rate() < -tangent_contact * met.sizes())
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
