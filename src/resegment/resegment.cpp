#include "resegment/resegment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/recorded_labels.hpp"
#include "files/replaced_file.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "plugin/problem_setup.hpp"
#include "resegment/contact_point.hpp"
#include "resegment/lost_contacts.hpp"
#include "resegment/new_orbit.hpp"
#include "resegment/orbit_pieces.hpp"
#include "resegment/segment_list.hpp"
#include "resegment/signature_match.hpp"
#include "run/branch_setup.hpp"
#include "run/orbit_start.hpp"
#include "settings/constant_value.hpp"
#include "settings/constants_file.hpp"
#include "settings/constants_writer.hpp"
#include "settings/keyword_form.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

OrbitStart start_of(const LabelledOrbit& source, const std::string& path) {
  const LabelledSolution& solution = source.solution;
  const auto segments = static_cast<int>(source.settings.segments.size());
  return orbit_from_solution(solution, stored_shape(solution, source.settings.dimension, segments),
                             source.free_parameters, path);
}

LabelledOrbit read_source(const ResegmentRequest& request, const std::string& path, const std::string& constants,
                          const SolutionFile& file, std::vector<std::string>& warnings) {
  LabelledOrbit source;
  source.settings = read_constants_file(constants, &warnings);
  warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
  source.solution = find_solution(file.solutions, read_label(request.label), path);
  const LabelledSolution& solution = source.solution;
  source.name = fmt::format("label {} of {}", solution.label, path);
  if (!is_same_problem_type(solution.problem_type, source.settings.problem_type))
    throw UserError(
        fmt::format("{} was computed with IPS = {}, but {} has IPS = {}; give the constants of that run "
                    "with -c",
                    source.name, solution.problem_type, constants, source.settings.problem_type));
  const SolutionFamily& family = family_of(source.settings);
  if (const std::string why = family.why_not(Analysis::resegmentation, request.label); !why.empty())
    throw UserError(
        fmt::format("{} is {} (IPS = {}){}", source.name, family.facts().solution, source.settings.problem_type, why));
  return source;
}

/// Takes the orbit over into the numbering of the problem's PAR.
void place_source(LabelledOrbit& source, const ParameterLayout& layout, const std::string& path) {
  source.solution = in_layout(std::move(source.solution), layout);
  for (const int k : source.solution.free_parameters)
    if (!is_duration(source.settings, k)) source.free_parameters.push_back(k);
  source.start = start_of(source, path);
}

/// A direction, computed with the label's free parameters, as one of the new problem: nothing when the problem is of
/// another type, frees other parameters, or continues other orbits (an impact is born); the run then finds its own.
std::optional<OrbitVector> kept_direction(const LabelledOrbit& source, const NewOrbit& target,
                                          const std::optional<OrbitVector>& direction, const RunSettings& settings) {
  const std::vector<int> free = free_problem_parameters(settings);
  const bool other_problem = !is_same_problem_type(source.settings.problem_type, settings.problem_type) ||
                             source.free_parameters.size() != free.size() || !target.birth.impacts.empty();
  if (!direction || other_problem) return std::nullopt;
  OrbitVector kept = *direction;
  for (std::size_t g = 0; g < free.size(); ++g) {
    const auto at = std::find(source.free_parameters.begin(), source.free_parameters.end(), free[g]);
    if (at == source.free_parameters.end()) return std::nullopt;
    kept.globals(static_cast<Eigen::Index>(g)) = direction->globals(at - source.free_parameters.begin());
  }
  return kept;
}

LabelledSolution make_solution(const LabelledOrbit& source, const NewOrbit& target, const OrbitStart& start,
                               const RunSettings& settings) {
  const std::vector<int> free = free_problem_parameters(settings);
  std::vector<int> listed = free;
  for (int s = 0; s < start.orbit.shape.segments; ++s) listed.push_back(start.orbit.par.layout().duration(s));
  LabelledSolution solution = labelled_solution(start.orbit, start.direction.value_or(OrbitVector{}), free,
                                                start.direction ? listed : std::vector<int>{});
  solution.branch = source.solution.branch;
  solution.type = target.type;
  solution.kind = target.kind;
  solution.further = target.further;
  solution.problem_type = settings.problem_type;
  solution.branch_mode = source.solution.branch_mode;
  return solution;
}

void refuse_same_file(const std::string& output, const std::string& input, const char* what) {
  std::error_code error;
  if (std::filesystem::equivalent(output, input, error) && !error)
    throw UserError(
        fmt::format("the output {} would replace the {} that is read; give another name with -o", output, what));
}

std::string summary(const LabelledOrbit& source, const RunSettings& settings, const Orbit& x,
                    const HybridSystem& system) {
  const std::string type = fmt::format("{}", fmt::join(type_names(source.solution), " "));
  const std::string meaning =
      description(source.solution, [&](int k) { return parameter_name(system, source.settings, k); });
  std::string text = fmt::format("{}{}{}\n", source.name, type.empty() ? "" : fmt::format(" ({})", type),
                                 meaning.empty() ? "" : ": " + meaning);
  text += fmt::format("  signature {}\n         -> {}, IPS = {}, ISW = {}\n", to_string(source.settings.signature()),
                      to_string(settings.signature()), settings.problem_type, settings.branch_mode);
  for (int s = 0; s < x.shape.segments; ++s) {
    const SegmentSettings& segment = settings.segments[static_cast<std::size_t>(s)];
    std::string events;
    for (const int event : segment.monitor)
      events += fmt::format("{}{}", events.empty() ? "" : ", ", system.function_name(FunctionKind::event, event));
    text += fmt::format("  segment {}  {:<14} to {:<22} then {:<12} T = {:<14.9g} monitors {}\n", s + 1,
                        system.function_name(FunctionKind::field, segment.index.field),
                        fmt::format("{}{}", system.function_name(FunctionKind::event, segment.index.event),
                                    segment.type == 2 ? " (grazing)" : ""),
                        system.function_name(FunctionKind::jump, segment.index.jump), x.duration(s),
                        events.empty() ? "nothing" : events);
  }
  std::string free;
  for (const int k : settings.free_parameters)
    free += fmt::format("{}{}", free.empty() ? "" : ", ", parameter_name(system, settings, k));
  return text + fmt::format("  free: {}\n", free);
}

/// On one side of this point the orbit has the new event and segments, on the other it is inadmissible. Gives DS the
/// sign for them unless the user gave DS, and says so.
std::string choose_side(const ResegmentRequest& request, const HybridSystem& system, const NewOrbit& target,
                        OrbitStart start, RunSettings& settings) {
  if (request.data) start.direction.reset();
  SelectedStart selected;
  selected.start = std::move(start);
  selected.known_parameters = selected.start.orbit.par;
  selected.from_solution = !request.data;
  selected.problem_type = settings.problem_type;
  selected.type = target.type;
  selected.kind = target.kind;
  selected.types = {basic_type(target.type)};
  const std::string born = !target.birth.lost_contacts.empty()   ? "no contact"
                           : !target.birth.impacts.empty()       ? "the new event"
                           : target.birth.empty_segments.empty() ? "the new signature"
                                                                 : "the new segment";
  const int side = side_of_birth(system, settings, selected, target.birth);
  if (side == 0)
    return fmt::format(
        "On one side of this point the orbit has {}, on the other it is inadmissible: choose by the sign of DS, "
        "or\nsee "
        "both with --both.\n",
        born);
  const double step = std::copysign(settings.step, side);
  if (!is_overridden(request.overrides, "DS")) settings.step = step;
  if (settings.step == step)
    return fmt::format("DS = {} leads to the side with {}; on the other side the orbit is inadmissible.\n", step, born);
  return fmt::format("DS = {} leads to the side where the orbit is inadmissible; {} is on the side of DS = {}.\n",
                     settings.step, born, step);
}

std::vector<OrbitPiece> pieces_of(const NewOrbit& target) {
  std::vector<OrbitPiece> pieces;
  for (const NewSegment& segment : target.segments) pieces.push_back(segment.piece);
  return pieces;
}

/// Why the run of `settings` from `start` does not begin; empty when it does.
std::string obstacle(const HybridSystem& system, const RunSettings& settings, const OrbitStart& start) {
  SelectedStart selected;
  selected.start = start;
  selected.known_parameters = start.orbit.par;
  selected.from_solution = true;
  selected.problem_type = settings.problem_type;
  try {
    set_up_branch(system, settings, selected);
  } catch (const ComputationError& error) {
    return error.what();
  }
  return "";
}

/// Of several jumps that leave the orbit at its contact as it is, the first with which the problem is regular.
void choose_contact_jump(const ResegmentRequest& request, const LabelledOrbit& source, const HybridSystem& system,
                         NewOrbit& target) {
  if (target.contact_jumps.size() < 2) return;
  int& jump = target.segments[target.contact].index.jump;
  const auto name = [&](int k) { return fmt::format("{} ({})", k, system.function_name(FunctionKind::jump, k)); };
  const int first = target.contact_jumps.front();
  std::string why;
  for (const int candidate : target.contact_jumps) {
    jump = candidate;
    RunSettings settings = new_settings(source.settings, target.segments, target.problem, system);
    apply_overrides(settings, request.overrides);
    resolve_names(settings, system);
    const std::string refusal = obstacle(system, settings, assemble(source.start, pieces_of(target)));
    if (why.empty()) why = refusal;
    if (!refusal.empty()) continue;
    if (candidate != first)
      target.remarks.push_back(
          fmt::format("The segment in contact ends in jump {}, which leaves this orbit as it is too; with jump {}\n{}",
                      name(candidate), name(first), why));
    return;
  }
  jump = first;
  target.remarks.push_back(
      fmt::format("The run will not begin: {}\nAnother jump at the contact may help: --jump", why));
}

/// The orbit that is to have another signature: where contacts are lost, without them, and then `request` has its
/// signature.
LabelledOrbit without_contacts(ResegmentRequest& request, LabelledOrbit source, const HybridSystem& system,
                               std::vector<Birth::InnerContact>& lost) {
  if (request.kind != ResegmentKind::signature) return source;
  std::optional<Signature> wanted;
  if (request.signature) wanted = parse_signature(*request.signature);
  std::optional<OrbitWithoutContacts> found = without_lost_contacts(source, wanted, system);
  if (!found) return source;
  if (!request.signature) request.signature = to_string(found->signature);
  lost = found->contacts;
  return std::move(found->orbit);
}

/// The same orbit with the number of impacts before each limit of chatter that --signature asks for.
LabelledOrbit with_impacts(const ResegmentRequest& request, LabelledOrbit source, const HybridSystem& system) {
  if (request.kind != ResegmentKind::signature || !request.signature) return source;
  std::optional<OtherImpacts> found =
      with_other_impacts(system, segments_of(source.settings), source.start.orbit, parse_signature(*request.signature));
  if (!found) return source;
  return with_segments(std::move(source), std::move(found->orbit), found->segments, system);
}

/// The orbit with a section: one that has none is cut at its contact.
LabelledOrbit with_section(const ResegmentRequest& request, LabelledOrbit labelled, const HybridSystem& system,
                           const std::string& problem, const std::string& path) {
  if (has_section(labelled.settings)) return labelled;
  const bool is_cut = request.kind == ResegmentKind::grazing_curve || request.kind == ResegmentKind::impacting;
  if (!is_cut)
    require_section(labelled.solution, labelled.settings, system, "the new signature",
                    shell_words(problem_words(problem)), path);
  labelled.solution = cut_at_contact(labelled.solution, labelled.settings, system, labelled.name);
  labelled.start = start_of(labelled, path);
  return labelled;
}

/// In the segments that these pieces have become.
void add_lost_contacts(const std::vector<Birth::InnerContact>& lost, NewOrbit& target) {
  for (const Birth::InnerContact& contact : lost)
    for (std::size_t s = 0; s < target.segments.size(); ++s)
      if (const OrbitPiece& piece = target.segments[s].piece; !piece.empty() && piece.segment == contact.segment)
        target.birth.lost_contacts.push_back({static_cast<int>(s), contact.event, contact.tau});
}

/// The functions of the orbit and of what is made of it, for a plugin that does not say what it has.
ProblemSizes sizes_for(const ResegmentRequest& request, const RunSettings& settings) {
  ProblemSizes sizes = problem_sizes(settings);
  if (request.signature)
    for (const IndexVector& index : parse_signature(*request.signature)) sizes.add(index);
  if (request.contact)
    for (const IndexVector& index : parse_signature(*request.contact, "--contact")) sizes.add(index);
  if (request.jump && *request.jump >= 1) sizes.add_jump(*request.jump);
  if (request.kind == ResegmentKind::impacting) sizes.add_jump(request.jump.value_or(settings.grazing_jump));
  return sizes;
}

/// Where things are written.
struct Outputs {
  std::string solutions, constants;
};

Outputs outputs_of(const std::string& name) { return {output_path('q', name), constants_file_of(name)}; }

/// The start of a curve of grazing tori: nothing is cut.
std::vector<std::string> begin_grazing_tori(const ResegmentRequest& request, const std::string& path,
                                            const SolutionFile& file, const std::string& constants,
                                            std::ostream& screen, std::ostream& notices) {
  std::vector<std::string> warnings = file.warnings;
  RunSettings given = read_constants_file(constants, &warnings);
  const LabelledSolution& solution = find_solution(file.solutions, read_label(request.label), path);
  const std::string name = fmt::format("label {} of {}", solution.label, path);
  if (request.kind != ResegmentKind::grazing_curve)
    throw UserError(
        fmt::format("{} is a torus, and its signature one return: from it a curve of grazing tori begins "
                    "(--to grazing-curve), and nothing else",
                    name));
  if (request.data)
    throw UserError(fmt::format("{} is a torus, which a .dat file does not hold; leave --dat out", name));
  const std::optional<std::string> recorded = recorded_problem(given, constants);
  const std::string problem = problem_of_run(request.problem, run_path(path), recorded);
  const ProblemLibrary library(resolve_plugin_of_run(request.problem, run_path(path), recorded, notices),
                               [&] { return problem_sizes(given); });
  const HybridSystem& system = library.system();
  resolve_names(given, system);
  require_recorded_parameters(path, system);
  const LabelledSolution torus = in_layout(solution, system.layout());
  RunSettings settings = grazing_torus_settings(given, torus, name, system, is_overridden(request.overrides, "ICP"));
  apply_overrides(settings, request.overrides, &warnings);
  resolve_names(settings, system);
  const auto further = check_settings_against(system, settings, {"the new constants", request.overrides});
  warnings.insert(warnings.end(), further.begin(), further.end());
  const Outputs outputs = outputs_of(request.output);
  settings.problem = problem_to_record(problem, outputs.constants);
  refuse_same_file(outputs.solutions, path, "q-file");
  refuse_same_file(outputs.constants, constants, "constants file");
  replace_solution_file(request.output, format_solution(grazing_torus_start(torus)));
  write_whole_file(outputs.constants, keyword_text(settings));
  screen << fmt::format(
      "{}: a torus in grazing contact, IPS = {} from it on.\n{} and {} written; next: tchat run{} -c {} "
      "-s {} -o {}_branch\n",
      name, settings.problem_type, outputs.solutions, outputs.constants, shell_words(problem_words(problem)),
      request.output, request.output, request.output);
  return warnings;
}

}  // namespace

std::vector<std::string> resegment(const ResegmentRequest& asked, std::ostream& screen, std::ostream& notices) {
  ResegmentRequest request = asked;
  std::vector<std::string> warnings;
  const std::string path = resolve_solution_path(request.solutions);
  const SolutionFile file = read_solution_file(path);
  const std::string constants = constants_of_run(request.constants, path);
  const LabelledSolution& label = find_solution(file.solutions, read_label(request.label), path);
  if (family_of(label.problem_type).facts().has_several_returns)
    return begin_grazing_tori(request, path, file, constants, screen, notices);
  LabelledOrbit labelled = read_source(request, path, constants, file, warnings);

  const std::optional<std::string> recorded = recorded_problem(labelled.settings, constants);
  const std::string problem = problem_of_run(request.problem, run_path(path), recorded);
  const std::string plugin = resolve_plugin_of_run(request.problem, run_path(path), recorded, notices);
  const ProblemLibrary library(plugin, [&] { return sizes_for(request, labelled.settings); });
  const HybridSystem& system = library.system();
  resolve_names(labelled.settings, system);
  check_settings_against(system, labelled.settings, {constants});
  require_recorded_parameters(path, system);
  place_source(labelled, system.layout(), path);
  std::vector<Birth::InnerContact> lost;
  const LabelledOrbit source = with_impacts(
      request, without_contacts(request, with_section(request, labelled, system, problem, path), system, lost), system);
  if (request.kind == ResegmentKind::grazing_curve && !source.settings.conserved.empty() &&
      !is_overridden(request.overrides, "ICP"))
    throw UserError(fmt::format(
        "{}: the orbit belongs to a family of CONSERVED = {}, and along a curve of grazing orbits two parameters that "
        "change it vary, such as a damping and a drive: name them with ICP=[..., ...]; --to impacting continues the "
        "family with the impact",
        path, source.settings.conserved));
  NewOrbit target = new_orbit(request, source, system);
  add_lost_contacts(lost, target);
  target.problem.names_parameters = is_overridden(request.overrides, "ICP");
  choose_contact_jump(request, source, system, target);
  OrbitStart start = assemble(source.start, pieces_of(target));
  RunSettings settings = new_settings(source.settings, target.segments, target.problem, system);
  if (RunSettings kept = labelled.settings; leave_out_monitors(kept))
    warnings.push_back(fmt::format(
        "{}: HOLD, monitors of segments, and UZR and BOUNDS of monitors are left out of the new constants, because "
        "segments have other numbers; name them again",
        constants));
  if (request.data) settings.start = {};
  apply_overrides(settings, request.overrides, &warnings);
  resolve_names(settings, system);
  if (!settings.parameter_values.empty())
    throw UserError("values of parameters are not kept in a constants file; give PAR(...)= to `tchat run`");
  const std::vector<std::string> contradictions =
      check_settings_against(system, settings, {"the new constants", request.overrides});
  warnings.insert(warnings.end(), contradictions.begin(), contradictions.end());
  require_fit(system, settings.signature(), start.orbit);
  start.direction = kept_direction(source, target, start.direction, settings);
  if (start.direction && !target.birth.is_any() && !is_overridden(request.overrides, "DS"))
    settings.step = std::abs(settings.step);  // on in the direction that is kept
  const std::string side = target.birth.is_any() ? choose_side(request, system, target, start, settings) : "";

  const auto [solutions_out, constants_out] = outputs_of(request.output);
  settings.problem = problem_to_record(problem, constants_out);
  refuse_same_file(solutions_out, path, "q-file");
  refuse_same_file(constants_out, constants, "constants file");
  const std::string start_out = request.data ? request.output + ".dat" : solutions_out;
  if (request.data)
    write_whole_file(start_out, data_text(start.orbit, system));
  else
    replace_solution_file(request.output, format_solution(make_solution(source, target, start, settings)));
  write_whole_file(constants_out, keyword_text(settings));

  screen << summary(labelled, settings, start.orbit, system)
         << fmt::format("{} and {} written; next: tchat run{} -c {} {} {} -o {}_branch\n", start_out, constants_out,
                        shell_words(problem_words(problem)), request.output, request.data ? "-d" : "-s", request.output,
                        request.output)
         << side;
  for (const std::string& remark : target.remarks) screen << remark << '\n';
  return warnings;
}

namespace {

/// The contact that the label is; nothing when it is none.
std::optional<UserPointKind> contact_of(const LabelledSolution& solution) {
  for (const UserPointKind& kind : all_kinds(solution))
    if (kind.kind == UserPointKind::contact) return kind;
  return std::nullopt;
}

/// Its number in GCIPSI: through the GCHGRZIND lists of all segments in order.
int number_of(const RunSettings& settings, const UserPointKind& contact) {
  int number = 0;
  for (int s = 0; s < segment_count(settings); ++s)
    for (const int event : settings.segments[static_cast<std::size_t>(s)].monitor) {
      ++number;
      if (s + 1 == contact.segment && event == contact.index) return number;
    }
  return 0;
}

}  // namespace

RunSettings grazing_torus_settings(const RunSettings& settings, const LabelledSolution& solution,
                                   const std::string& name, const HybridSystem& system, bool icp_is_given) {
  const std::optional<UserPointKind> contact = contact_of(solution);
  const int number = contact ? number_of(settings, *contact) : 0;
  if (number == 0)
    throw UserError(
        fmt::format("{} is no contact of a torus with a monitored event function (GR): a curve of grazing tori begins "
                    "there; run with "
                    "the event in GCHGRZIND, to a GR label",
                    name));
  RunSettings result = settings;
  result.problem_type = grazing_torus.number;
  result.branch_mode = grazing_torus.branch_mode;
  std::erase(result.test_functions, number);
  result.test_functions.insert(result.test_functions.begin(), number);  // the first one is touched all along
  result.start = {"", solution.label};
  result.user_values.clear();
  result.stop_rules.clear();
  if (icp_is_given) return result;
  for (int k = 1; k <= system.parameters(); ++k) {
    auto& free = result.free_parameters;
    if (std::find(free.begin(), free.end(), k) != free.end()) continue;
    free.push_back(k);
    return result;
  }
  throw UserError(
      fmt::format("{}: every parameter of problem {} is free already, and a curve of grazing tori frees one "
                  "more; take rho out of ICP on the run before",
                  name, system.name()));
}

LabelledSolution grazing_torus_start(LabelledSolution solution) {
  solution.problem_type = grazing_torus.number;
  solution.free_parameters.clear();
  solution.parameter_direction.clear();
  solution.state_direction.resize(0, 0);
  return solution;
}

}  // namespace tchat
