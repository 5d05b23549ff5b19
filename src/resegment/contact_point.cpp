#include "resegment/contact_point.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/user_error.hpp"
#include "files/solution_file.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

/// A contact nearer to a segment's end than this share of it lies on the end.
constexpr double at_the_end = 1e-6;
/// The jump of a section moves the point of contact by no more than this.
constexpr double section_moves_at_most = 1e-6;

int checked(int number, int count, const char* what, const std::string& source) {
  if (number >= 1 && number <= count) return number;
  throw UserError(
      fmt::format("{}: the label names {} {}, but there are {}: constants or problem are not those of the "
                  "run that wrote it; give them with -c and -p",
                  source, what, number, count));
}

void require_section(const ContactPoint& contact, const Orbit& x, const HybridSystem& system,
                     const RunSettings& settings, const std::string& source) {
  const int s = contact.segment;
  const int next = (s + 1) % x.shape.segments;
  const IndexVector& index = settings.segments[static_cast<std::size_t>(s)].index;
  const Eigen::Map<const Eigen::VectorXd> end(x.end(s), x.shape.dimension);
  Eigen::VectorXd after(x.shape.dimension);
  system.value(FunctionKind::jump, index.jump, end.data(), x.par.data(), after.data());
  const bool same_field = settings.segments[static_cast<std::size_t>(next)].index.field == index.field;
  if (same_field &&
      (after - end).lpNorm<Eigen::Infinity>() <= section_moves_at_most * (1.0 + end.lpNorm<Eigen::Infinity>()))
    return;
  throw UserError(fmt::format(
      "{}: the contact with event {} ({}) coincides with the end of segment {}, where event {} ({}) {}: two events at "
      "once. Where they change places, or a segment of no duration vanishes or appears, the run goes on with another "
      "signature: --to signature --signature '...'; or move along the branch, or choose another section",
      source, contact.event, system.function_name(FunctionKind::event, contact.event), s + 1, index.event,
      system.function_name(FunctionKind::event, index.event),
      same_field ? "changes the state" : "changes the vector field"));
}

/// Contact inside a segment, or on one of its ends; the start of a segment is the end of the one before.
ContactPoint contact_along(const UserPointKind& kind, const Orbit& x, const HybridSystem& system,
                           const RunSettings& settings, const std::string& source) {
  const int m = x.shape.segments;
  ContactPoint contact{ContactPoint::inside, kind.segment - 1, kind.index, kind.tau};
  if (kind.tau > at_the_end && kind.tau < 1.0 - at_the_end) return contact;
  contact.where = ContactPoint::section;
  if (kind.tau <= at_the_end) contact.segment = (contact.segment + m - 1) % m;
  contact.tau = 1.0;
  require_section(contact, x, system, settings, source);
  return contact;
}

}  // namespace

int jump_at_contact(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                    const ContactPoint& contact) {
  const int m = x.shape.segments;
  const int before = (contact.segment + m - 1) % m;
  const IndexVector& from = settings.segments[static_cast<std::size_t>(before)].index;
  // An orbit that had no section was cut at this contact, so what a start in mid-orbit may meet is asked for instead.
  const bool was_smooth = m == 1 && from.jump == no_function;
  const auto watched = was_smooth
                           ? system.successors({0, 0, 0}, x.node(before, x.shape.nodes_of(before) / 2), x.par.data())
                           : system.successors(from, x.end(before), x.par.data());
  const int field = settings.segments[static_cast<std::size_t>(contact.segment)].index.field;
  std::vector<int> jumps;
  for (const IndexVector& v : watched.value_or(std::vector<IndexVector>{}))
    if (v.field == field && v.event == contact.event) jumps.push_back(v.jump);
  return jumps.size() == 1 ? jumps.front() : settings.grazing_jump;
}

ContactPoint contact_point(const LabelledSolution& solution, const Orbit& x, const HybridSystem& system,
                           const RunSettings& settings, const std::string& source) {
  if (keeps_contact(solution.problem_type)) {
    const int s = marked_segment(settings);
    return {ContactPoint::grazing_curve, s, settings.segments[static_cast<std::size_t>(s)].index.event, 1.0};
  }
  const std::vector<UserPointKind> kinds = all_kinds(solution);
  const auto grazing = std::find_if(kinds.begin(), kinds.end(), [](const UserPointKind& kind) {
    return kind.kind == UserPointKind::contact || kind.kind == UserPointKind::impact_velocity;
  });
  if (grazing == kinds.end()) {
    const std::string type = type_name(solution);
    throw UserError(
        fmt::format("{} is no grazing point but {}; choose a GR label (GR1 is the first one, `tchat labels` lists "
                    "them) or a label of a grazing curve (IPS = 150)",
                    source, type.empty() ? "an ordinary point" : "of type " + type));
  }
  const UserPointKind& kind = *grazing;
  checked(kind.segment, x.shape.segments, "segment", source);
  checked(kind.index, system.count(FunctionKind::event), "event function", source);
  if (kind.kind == UserPointKind::impact_velocity) return {ContactPoint::impact, kind.segment - 1, kind.index, 1.0};
  return contact_along(kind, x, system, settings, source);
}

}  // namespace tchat
