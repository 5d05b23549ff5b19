#include "resegment/resegment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "constants/constant_value.hpp"
#include "constants/constants_file.hpp"
#include "constants/constants_writer.hpp"
#include "constants/keyword_form.hpp"
#include "constants/user_error.hpp"
#include "output/run_files.hpp"
#include "output/solution_file.hpp"
#include "output/whole_file.hpp"
#include "plugin/exit_guard.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "resegment/contact_point.hpp"
#include "resegment/data_text.hpp"
#include "resegment/empty_segments.hpp"
#include "resegment/impacting_side.hpp"
#include "resegment/new_settings.hpp"
#include "resegment/segment_list.hpp"
#include "run/named_parameters.hpp"
#include "run/problem_setup.hpp"
#include "run/run_request.hpp"
#include "start/orbit_start.hpp"
#include "start/point_type.hpp"
#include "start/solution_file_reader.hpp"

namespace tchat {

namespace {

/// The labelled orbit with the constants of its run.
struct Source {
  std::string name;  ///< "label 3 of q.S"
  RunSettings settings;
  LabelledSolution solution;
  std::vector<int> free_parameters;  ///< of the problem, at the label
  OrbitStart start;
};

/// What becomes of it.
struct Target {
  SegmentList segments;
  NewProblem problem;
  int type = static_cast<int>(PointType::end);
  UserPointKind kind = {};
  std::optional<int> impact = {};  ///< segment (from 0) that ends in the new impact
};

StartLabel read_label(const std::string& text) {
  if (const auto number = parse_integer(text); number && *number >= 1) return {"", *number};
  if (const auto typed = parse_typed_label(text)) return *typed;
  throw UserError(fmt::format("{} is no label; a number or a type with its count is needed, such as 5, GR1 or PD1",
                              in_quotes(text)));
}

/// "results/q.mems" -> "results/mems"
std::string run_name(const std::string& solutions) {
  const std::filesystem::path path(solutions);
  const std::string file = path.filename().string();
  return (path.parent_path() / (file.starts_with("q.") ? file.substr(2) : file)).string();
}

std::string constants_of(const ResegmentRequest& request, const std::string& solutions) {
  if (request.constants) return constants_path(*request.constants);
  const std::string used = output_path('r', run_name(solutions));
  if (std::filesystem::exists(used)) return used;
  throw UserError(
      fmt::format("there is no {} with the constants of the run that wrote {}; give them with -c C", used, solutions));
}

Source read_source(const ResegmentRequest& request, const std::string& path, const std::string& constants,
                   std::vector<std::string>& warnings) {
  Source source;
  source.settings = read_constants_file(constants, &warnings);
  const SolutionFile file = read_solution_file(path);
  warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
  source.solution = find_solution(file.solutions, read_label(request.label), path);
  const LabelledSolution& solution = source.solution;
  source.name = fmt::format("label {} of {}", solution.label, path);
  const int m = static_cast<int>(source.settings.segments.size());
  if (solution.problem_type != 0 && solution.problem_type != source.settings.problem_type)
    throw UserError(
        fmt::format("{} was computed with IPS = {}, but {} has IPS = {}; give the constants of that run "
                    "with -c",
                    source.name, solution.problem_type, constants, source.settings.problem_type));
  for (const int k : solution.free_parameters)
    if (!is_duration(k, m)) source.free_parameters.push_back(k);
  source.start = orbit_from_solution(
      solution, {source.settings.dimension, m, solution.mesh_intervals, solution.collocation_points},
      source.free_parameters, path);
  return source;
}

int checked_jump(const HybridSystem& system, int jump, const char* what) {
  const int count = system.count(FunctionKind::jump);
  if (jump >= 1 && jump <= count) return jump;
  throw UserError(fmt::format("{} is jump {}, but problem {} has {} jumps; allowed: 1..{}", what, jump, system.name(),
                              count, count));
}

int identity_jump(const HybridSystem& system) {
  for (int k = 1; k <= system.count(FunctionKind::jump); ++k)
    if (is_identity_jump(system, k)) return k;
  throw UserError(fmt::format(
      "problem {} has no identity jump, which the cut at a grazing contact needs: add one (g = x) to the plugin, or "
      "choose the jump with --jump",
      system.name()));
}

/// The segments of the cut take the index vectors given by the user; the segments of no duration among them come after
/// the contact.
CutList with_signature(CutList cut, const Signature& signature, bool may_add, const ContactPoint& contact) {
  const std::size_t pieces = cut.segments.size();
  if (signature.size() < pieces || (signature.size() > pieces && !may_add))
    throw UserError(fmt::format("--signature has {} index vectors, but the orbit cut at the contact has {} segments{}",
                                signature.size(), pieces,
                                may_add ? "; further ones are segments of zero duration after the contact" : ""));
  cut = with_empty_segments(std::move(cut), static_cast<int>(signature.size() - pieces), contact.event);
  for (std::size_t s = 0; s < signature.size(); ++s) {
    NewSegment& segment = cut.segments[s];
    if (!segment.piece.empty() && segment.index.field != signature[s].field)
      throw UserError(
          fmt::format("--signature: index vector {} has field {}, but that part of the orbit was computed "
                      "with field {}",
                      s + 1, signature[s].field, segment.index.field));
    if (s == cut.contact && segment.index.event != signature[s].event)
      throw UserError(
          fmt::format("--signature: index vector {} ends in event {}, but that segment ends in the contact "
                      "with event {}",
                      s + 1, signature[s].event, segment.index.event));
    segment.index = signature[s];
  }
  return cut;
}

Target to_grazing_curve(const ResegmentRequest& request, const Source& source, const HybridSystem& system) {
  const ContactPoint contact = contact_point(source.solution, source.start.orbit, system, source.settings, source.name);
  const auto at = static_cast<std::size_t>(contact.segment);
  if (contact.where == ContactPoint::grazing_curve)
    throw UserError(fmt::format("{} lies on a grazing curve already; `tchat run` goes on along it", source.name));
  const int own = source.settings.segments[at].index.jump;
  const int jump = request.jump ? *request.jump : contact.where == ContactPoint::section ? own : identity_jump(system);
  CutList cut = cut_at(segments_of(source.settings), contact, checked_jump(system, jump, "--jump"));
  if (contact.where == ContactPoint::impact) cut = without_empty_segments(std::move(cut), source.start.orbit);
  if (request.signature) cut = with_signature(std::move(cut), parse_signature(*request.signature), false, contact);
  cut.segments[cut.contact].grazes = true;
  const int contact_jump = contact.where == ContactPoint::impact
                               ? own
                               : jump_at_contact(system, source.settings, source.start.orbit, contact);
  return {cut.segments, {150, 1, contact_jump}};
}

Target to_impacting(const ResegmentRequest& request, const Source& source, const HybridSystem& system) {
  const ContactPoint contact = contact_point(source.solution, source.start.orbit, system, source.settings, source.name);
  if (contact.where == ContactPoint::impact)
    throw UserError(
        fmt::format("{} is where an impact of this signature has velocity zero: the impacting orbits are those of its "
                    "own branch; `tchat run` goes on along it",
                    source.name));
  const int jump = request.jump
                       ? checked_jump(system, *request.jump, "--jump")
                       : checked_jump(system, jump_at_contact(system, source.settings, source.start.orbit, contact),
                                      "GRJUMP, the jump that contact brings,");
  CutList cut = cut_at(segments_of(source.settings), contact, jump);
  Signature signature;
  if (request.signature) {
    cut = with_signature(std::move(cut), parse_signature(*request.signature), true, contact);
  } else {
    const NewSegment& impact = cut.segments[cut.contact];
    const NewSegment& next = cut.segments[(cut.contact + 1) % cut.segments.size()];
    const CollocationRule rule(source.start.orbit.shape.collocation);
    const Eigen::VectorXd x = state_at(source.start.orbit, rule, impact.piece.segment, impact.piece.to);
    const Signature between = segments_after_impact(system, impact.index, x, source.start.orbit.par, next.index.field);
    cut = with_empty_segments(std::move(cut), static_cast<int>(between.size()), contact.event);
    for (std::size_t k = 0; k < between.size(); ++k) cut.segments[cut.contact + 1 + k].index = between[k];
  }
  Target target{cut.segments, {180, 1, source.settings.grazing_jump}};
  target.impact = static_cast<int>(cut.contact);
  return target;
}

Target to_rotated(const ResegmentRequest& request, const Source& source) {
  const RunSettings& old = source.settings;
  const int m = static_cast<int>(old.segments.size());
  SegmentList segments = segments_of(old);
  if (old.problem_type == 150) segments[static_cast<std::size_t>(grazing_segment(old))].grazes = true;
  Target target{rotated(segments, request.rotation),
                {old.problem_type, old.branch_mode, old.grazing_jump},
                source.solution.type,
                source.solution.kind};
  if (target.kind.segment > 0) target.kind.segment = (((target.kind.segment - 1 - request.rotation) % m) + m) % m + 1;
  return target;
}

/// At a period doubling, or anywhere on a curve of them, the doubled problem has a branch point: ISW = -1 goes from
/// there to the doubled orbit.
Target to_repeated(const Source& source) {
  if (source.settings.problem_type != 180)
    throw UserError(fmt::format("{} lies on a grazing curve; an orbit of type IPS = 180 can be doubled", source.name));
  constexpr int period_doubling = static_cast<int>(PointType::period_doubling);
  const int type = source.solution.type;
  const bool doubling = basic_type(type) == period_doubling || std::abs(type) / 10 == period_doubling;
  Target target{repeated(segments_of(source.settings)), {180, doubling ? -1 : 1, source.settings.grazing_jump}};
  target.type = static_cast<int>(doubling ? PointType::branch_point : PointType::end);
  return target;
}

Target make_target(const ResegmentRequest& request, const Source& source, const HybridSystem& system) {
  switch (request.kind) {
    case ResegmentKind::grazing_curve:
      return to_grazing_curve(request, source, system);
    case ResegmentKind::impacting:
      return to_impacting(request, source, system);
    case ResegmentKind::rotate:
      return to_rotated(request, source);
    default:
      return to_repeated(source);
  }
}

LabelledSolution make_solution(const Source& source, const Target& target, const OrbitStart& start,
                               const RunSettings& settings) {
  std::vector<int> listed = source.free_parameters;
  for (int s = 0; s < start.orbit.shape.segments; ++s) listed.push_back(first_duration + s);
  LabelledSolution solution = labelled_solution(start.orbit, start.direction.value_or(OrbitVector{}),
                                                source.free_parameters, start.direction ? listed : std::vector<int>{});
  solution.branch = source.solution.branch;
  solution.type = target.type;
  solution.kind = target.kind;
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

std::string summary(const Source& source, const RunSettings& settings, const Orbit& x, const HybridSystem& system) {
  const std::string type = type_name(source.solution);
  const std::string meaning = description(source.solution.kind, system.parameter_name(source.solution.kind.index));
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
    free += fmt::format("{}{}", free.empty() ? "" : ", ", system.parameter_name(k));
  return text + fmt::format("  free: {}\n", free);
}

bool gives_step(const std::vector<std::string>& overrides) {
  return std::any_of(overrides.begin(), overrides.end(), [](const std::string& text) {
    const std::vector<Assignment> assignments = parse_assignments(text, Place{"command line"});
    return std::any_of(assignments.begin(), assignments.end(),
                       [](const Assignment& a) { return constant_of(a).keyword == "DS"; });
  });
}

/// On one side of grazing the orbit has the new impact, on the other it is inadmissible. Gives DS the sign for impacts
/// unless the user gave DS, and says so.
std::string choose_side(const ResegmentRequest& request, const HybridSystem& system, int impact, OrbitStart start,
                        RunSettings& settings) {
  if (request.data) start.direction.reset();
  SelectedStart selected;
  selected.start = std::move(start);
  selected.from_solution = !request.data;
  selected.problem_type = settings.problem_type;
  selected.type = static_cast<int>(PointType::end);
  const int side = impacting_side(system, settings, selected, impact);
  if (side == 0)
    return "On one side of this point the orbit has the new impact, on the other it is inadmissible: choose by the "
           "sign of DS, or\nsee both with --both.\n";
  const double step = std::copysign(settings.step, side);
  if (!gives_step(request.overrides)) settings.step = step;
  return settings.step == step
             ? fmt::format(
                   "DS = {} leads to the side with the new impact; on the other side the orbit is inadmissible.\n",
                   step)
             : fmt::format(
                   "DS = {} leads to the side where the orbit is inadmissible; the new impact is on the side of "
                   "DS = {}.\n",
                   settings.step, step);
}

/// The functions of the orbit and of what is made of it, for a plugin that does not say what it has.
ProblemSizes sizes_for(const ResegmentRequest& request, const RunSettings& settings) {
  ProblemSizes sizes = problem_sizes(settings);
  if (request.signature)
    for (const IndexVector& index : parse_signature(*request.signature)) sizes.add(index);
  if (request.jump && *request.jump >= 1) sizes.add_jump(*request.jump);
  if (request.kind == ResegmentKind::impacting) sizes.add_jump(request.jump.value_or(settings.grazing_jump));
  return sizes;
}

}  // namespace

std::vector<std::string> resegment(const ResegmentRequest& request, std::ostream& screen) {
  std::vector<std::string> warnings;
  const std::string path = resolve_solution_path(request.solutions);
  const std::string constants = constants_of(request, path);
  const Source source = read_source(request, path, constants, warnings);

  const std::string plugin = resolve_plugin(request.problem.value_or(run_name(path)));
  const ExitGuard guard(plugin);
  const ProblemLibrary library(plugin, [&] { return sizes_for(request, source.settings); });
  const HybridSystem& system = library.system();
  check_settings_against(system, source.settings, constants);

  const Target target = make_target(request, source, system);
  std::vector<OrbitPiece> pieces;
  for (const NewSegment& segment : target.segments) pieces.push_back(segment.piece);
  const OrbitStart start = assemble(source.start, pieces);
  RunSettings settings = new_settings(source.settings, target.segments, target.problem, system);
  if (request.data) settings.start = {};
  apply_overrides(settings, request.overrides, &warnings, names_of(system));
  if (!settings.parameter_values.empty())
    throw UserError("values of parameters are not kept in a constants file; give PAR(...)= to `tchat run`");
  const std::vector<std::string> contradictions = check_settings_against(system, settings, "the new constants");
  warnings.insert(warnings.end(), contradictions.begin(), contradictions.end());
  require_fit(system, settings.signature(), start.orbit);
  const std::string side = target.impact ? choose_side(request, system, *target.impact, start, settings) : "";

  const std::string solutions_out = output_path('q', request.output);
  const std::string constants_out =
      std::filesystem::path(solutions_out)
          .replace_filename("gc." + std::filesystem::path(request.output).filename().string())
          .string();
  refuse_same_file(solutions_out, path, "q-file");
  refuse_same_file(constants_out, constants, "constants file");
  const std::string start_out = request.data ? request.output + ".dat" : solutions_out;
  write_whole_file(start_out, request.data ? data_text(start.orbit, system)
                                           : format_solution(make_solution(source, target, start, settings)));
  write_whole_file(constants_out, keyword_text(settings));

  screen << summary(source, settings, start.orbit, system)
         << fmt::format("{} and {} written; next: tchat run {} -c {} {} {}\n", start_out, constants_out,
                        std::filesystem::path(plugin).stem().string(), request.output, request.data ? "-d" : "-s",
                        request.output)
         << side;
  return warnings;
}

}  // namespace tchat
