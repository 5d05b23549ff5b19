#include "resegment/smooth_contact.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "base/user_error.hpp"
#include "files/solution_file_reader.hpp"
#include "model/identity_jump.hpp"
#include "model/index_vector.hpp"
#include "orbit/orbit.hpp"
#include "resegment/contact_point.hpp"
#include "resegment/orbit_pieces.hpp"
#include "run/orbit_start.hpp"

namespace tchat {

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
      "    tchat simulate {} -s {} IRS=1 --signature {},{},{} --dat {}_cut\n"
      "    tchat run {} -c {}_cut -d {}_cut -o {}_cut\n"
      "  and its labels are of orbits with a section.",
      solution.label, path, what, system.state_name(1), middle, problem, name, field,
      system.count(FunctionKind::event) + 1, identity != no_function ? identity : system.count(FunctionKind::jump) + 1,
      name, problem, name, name, name));
}

}  // namespace tchat
