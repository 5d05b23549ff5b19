#include "resegment/contact_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/solution_file_reader.hpp"
#include "model/events.hpp"
#include "model/index_vector.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "resegment/orbit_pieces.hpp"
#include "run/orbit_start.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

/// A contact nearer to a segment's end than this share of it lies on the end.
constexpr double at_the_end = level::located;

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
  const Eigen::VectorXd sizes = state_sizes(system, settings.signature(), x);
  if (same_field && length_in_sizes(after - end, sizes) <= level::located) return;
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

namespace {

/// Of the size of h on the segment: what the location of the label and its mesh leave of a contact.
constexpr double touching = level::located;
/// In tau: a contact nearer than this to a segment's end is on it, two contacts nearer than this are one.
constexpr double same_place = level::located;

struct Slope {
  double rate = 0.0;   ///< h_x f
  double scale = 0.0;  ///< of the rate

  bool is_tangent() const { return std::abs(rate) <= tangent_contact * scale; }
};

/// At the end of segment s; `sizes`: of states.
Slope slope_at(const HybridSystem& system, int field, int event, const Orbit& x, const Eigen::VectorXd& sizes, int s) {
  const EventAt at = event_at(system, event, field, x.end(s), x.par.data());
  return {at.rate(), at.rate_scale(sizes)};
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
      : x_(x),
        sizes_(state_sizes(system, settings.signature(), x)),
        system_(system),
        settings_(settings),
        found_{own} {}

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
    if (slope_at(system_, index(s).field, index(s).event, x_, sizes_, s).is_tangent())
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
    const bool touches = slope_at(system_, index(s).field, event, x_, sizes_, s).is_tangent();
    if (touches && index(s).event != event && ends_in_section(system_, settings_, s))
      add({ContactPoint::section, s, event, 1.0});
  }

  const Orbit& x_;
  const Eigen::VectorXd sizes_;
  const HybridSystem& system_;
  const RunSettings& settings_;
  std::vector<ContactPoint> found_;
};

}  // namespace

std::vector<ContactPoint> simultaneous_contacts(const ContactPoint& own, const Orbit& x, const HybridSystem& system,
                                                const RunSettings& settings) {
  return Search(own, x, system, settings).run();
}

std::optional<int> section_at_end(const Orbit& x, const Eigen::VectorXd& sizes, const HybridSystem& system, int s,
                                  int field, int event) {
  const Eigen::Map<const Eigen::VectorXd> end(x.end(s), x.shape.dimension);
  for (int j = 1; j <= system.count(FunctionKind::event); ++j) {
    if (j == event) continue;
    const Slope slope = slope_at(system, field, j, x, sizes, s);
    if (relative_event(system, j, end, x.par.data(), sizes) <= touching && slope.rate < 0.0 && !slope.is_tangent())
      return j;
  }
  return std::nullopt;
}

namespace {

/// NAME of q.NAME, with its folder.
std::string name_of(const std::string& path) {
  std::filesystem::path name(path);
  const std::string file = name.filename().string();
  if (file.starts_with("q.")) name.replace_filename(file.substr(2));
  return name.string();
}

/// Where a point of the segment is once the segment starts at `cut`.
double place_after_cut(double tau, double cut) { return tau > cut ? tau - cut : tau - cut + 1.0; }

}  // namespace

bool has_section(const RunSettings& settings) {
  return settings.segments.size() != 1 || settings.segments.front().index.event != no_function;
}

LabelledSolution cut_at_contact(const LabelledSolution& solution, RunSettings& settings, const HybridSystem& system,
                                const std::string& source) {
  const OrbitShape shape{settings.dimension, 1, solution.mesh_intervals, solution.collocation_points};
  const Orbit x = orbit_from_solution(in_layout(solution, system.layout()), shape, {}, source).orbit;
  const ContactPoint contact = contact_point(solution, x, system, settings, source);
  const double tau = contact.where == ContactPoint::inside ? contact.tau : 1.0;
  const Orbit cut = tau < 1.0 ? joined_orbit(x, {{{0, tau, 1.0}, {0, 0.0, tau}}}) : x;

  IndexVector& index = settings.segments.front().index;
  index.event = contact.event;
  index.jump = no_function;
  LabelledSolution result = solution;
  LabelledSolution orbit = labelled_solution(cut, {}, solution.free_parameters, {});
  result.tau = std::move(orbit.tau);
  result.states = std::move(orbit.states);
  result.parameters = std::move(orbit.parameters);
  result.layout = orbit.layout;
  result.parameter_direction.clear();
  result.state_direction.resize(0, 0);
  const auto move = [tau](UserPointKind& kind) {
    if (kind.kind == UserPointKind::contact) kind.tau = place_after_cut(kind.tau, tau);
  };
  move(result.kind);
  for (UserPointKind& kind : result.further) move(kind);
  return result;
}

void require_section(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
                     const std::string& what, const std::string& problem, const std::string& path) {
  if (has_section(settings)) return;
  const std::string name = name_of(path);
  const int field = settings.segments.front().index.field;
  const int identity = first_identity_jump(system, field);
  const double middle = 0.5 * (solution.states.row(0).minCoeff() + solution.states.row(0).maxCoeff());
  throw UserError(fmt::format(
      "label {} of {}: the orbit has no section, but {} needs one\n"
      "  Give the problem one more event function, which falls through zero once in each period, as {} - {:.4g}, and "
      "an identity jump unless it has one; then the branch with that section is\n"
      "    tchat simulate{} -s {} IRS=1 --signature {},{},{} --dat {}_cut\n"
      "    tchat run{} -c {}_cut -d {}_cut -o {}_cut\n"
      "  and its labels are of orbits with a section.",
      solution.label, path, what, system.state_name(1), middle, problem, name, field,
      system.count(FunctionKind::event) + 1, identity != no_function ? identity : system.count(FunctionKind::jump) + 1,
      name, problem, name, name, name));
}

}  // namespace tchat
