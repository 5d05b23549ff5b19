#include "maps/map_model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "maps/grazing_orbit.hpp"
#include "maps/grazing_source.hpp"
#include "maps/invariant_curve.hpp"
#include "maps/smooth_return.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/hybrid_simulation.hpp"
#include "plugin/problem_setup.hpp"
#include "resegment/signature_match.hpp"
#include "run/torus_start.hpp"
#include "settings/constants_file.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Points of an event function lie on P where h_P is this small beside its sizes.
constexpr double on_p = level::located;
/// An angle that varies less than this on a section is constant there.
constexpr double constant_angle = 1e-3;
constexpr double torus_neighbourhood = 0.25;

std::string numbers(const VectorXd& x) {
  return fmt::format("({:.10g})", fmt::join(x.data(), x.data() + x.size(), ", "));
}

/// What is taken along as a state: what is swept, and what differs from the motion's own values.
std::vector<int> parameters_along(const MapContext& context, const ParameterVector& own) {
  std::vector<int> along = context.swept;
  for (const int k : context.given)
    if (context.par(k - 1) != own(k - 1) && std::find(along.begin(), along.end(), k) == along.end()) along.push_back(k);
  return along;
}

ParameterVector with_given(const MapContext& context, ParameterVector par) {
  for (const int k : context.given) par(k - 1) = context.par(k - 1);
  return par;
}

/// An event function of the problem that is P beside x*: index vectors of returns have its number then.
IndexVector free_return(const HybridSystem& system, const GrazingPoint& point,
                        const std::optional<CrossSection>& section) {
  const auto follow = system.successors({0, 0, 0}, point.x.data(), point.par.data());
  for (const IndexVector& index : follow.value_or(std::vector<IndexVector>{})) {
    if (index.field != point.field || index.event == point.event || !is_identity_jump(system, index)) continue;
    if (section) {
      if (index.event == section->event) return index;
      continue;
    }
    const EventAt at = event_at(system, index.event, point.x.data(), point.par.data());
    const double sizes = at.gradient.norm() * point.section_gradient.norm();
    const VectorXd of_states = sizes_at(system, point.field, point.x, point.par);
    if (std::abs(at.h) <= on_p * at.scale(point.x.data(), of_states) &&
        std::abs(at.gradient.dot(point.section_gradient)) >= (1.0 - level::orbit) * sizes)
      return index;
  }
  return {point.field, section ? section->event : no_function, no_function};
}

std::optional<SectionPlane> plane_of(const std::optional<CrossSection>& section, const VectorXd& x, const VectorXd& f) {
  if (!section || section->event > 0) return std::nullopt;
  VectorXd normal = VectorXd::Unit(x.size(), section->state - 1);
  if (f(section->state - 1) > 0.0) normal = -normal;
  return SectionPlane{normal, x};
}

VectorXd extent_of(const LabelledSolution& solution, int n) {
  VectorXd low = solution.states.col(0).head(n), high = low;
  for (Index row = 0; row < solution.states.rows(); ++row) {
    const Index i = row % n;
    low(i) = std::min(low(i), solution.states.row(row).minCoeff());
    high(i) = std::max(high(i), solution.states.row(row).maxCoeff());
  }
  return high - low;
}

struct LabelledRun {
  LabelledSolution solution;
  RunSettings settings;
  std::string source;
};

bool has_several_returns(const LabelledSolution& label) {
  return family_of(label.problem_type).facts().has_several_returns;
}

LabelledRun labelled_run(const MapRequest& request, const MapContext& context, const HybridSystem& system) {
  const std::size_t colon = request.source.rfind(':');
  const std::string path = resolve_solution_path(request.source.substr(0, colon));
  const SolutionFile file = read_solution_file(path);
  LabelledRun run;
  run.solution = find_solution(file.solutions, read_label(request.source.substr(colon + 1)), path);
  run.source = fmt::format("label {} of {}", run.solution.label, path);
  const std::string constants = constants_of_run(context.constants, path);
  run.settings = read_constants_file(constants);
  resolve_names(run.settings, system);
  check_settings_against(system, run.settings, {constants});
  if (!is_same_problem_type(run.solution.problem_type, run.settings.problem_type) ||
      !family_of(run.settings).why_not(Analysis::composite_map, request.source).empty() ||
      has_several_returns(run.solution) != family_of(run.settings).facts().has_several_returns)
    throw UserError(
        fmt::format("{} is no periodic orbit or torus of {} (IPS = {} there, {} here); choose a GR label of periodic "
                    "orbits or of tori, or give the constants of its run with -c",
                    run.source, constants, run.solution.problem_type, run.settings.problem_type));
  return run;
}

MapModel periodic_model(const MapRequest& request, const MapContext& context, const HybridSystem& system,
                        const LabelledRun& run) {
  if (request.reduced)
    throw UserError("--reduced: a reduced map is the map of a torus's phase; a periodic orbit has none, leave it out");
  const ContactTurn turn =
      contact_turn(run.solution, run.settings, system, std::nullopt, context.swept.front(), run.source);
  const GrazingOrbit orbit = find_grazing_orbit(system, turn, run.source);
  MapModel model;
  model.point = orbit.point;
  if (context.section) model.section = cross_section(system, *context.section);
  // The map of P itself where the section named is P.
  if (model.section && model.section->event > 0) {
    const EventAt at =
        event_at(system, model.section->event, model.point.field, model.point.x.data(), model.point.par.data());
    const VectorXd sizes = sizes_at(system, model.point.field, model.point.x, model.point.par);
    const double rate = on_p * at.rate_scale(sizes);
    if (std::abs(at.rate()) > rate && std::abs(at.h) > on_p * at.scale(model.point.x.data(), sizes))
      throw UserError(
          fmt::format("--section {}: event function {} is {:.6g} at the grazing point x* = {}: the section must "
                      "pass through it; name a state instead, whose value at x* makes the section",
                      *context.section, model.section->event, at.h, numbers(model.point.x)));
    if (at.rate() > rate)
      throw UserError(
          fmt::format("--section {}: event function {} rises at the grazing point x* = {}; sections are those "
                      "where functions fall: name a state instead",
                      *context.section, model.section->event, numbers(model.point.x)));
    if (std::abs(at.gradient.dot(model.point.section_gradient)) >=
        (1.0 - level::orbit) * at.gradient.norm() * model.point.section_gradient.norm())
      model.section.reset();
  }
  const auto suspended =
      std::make_shared<SuspendedSystem>(system, parameters_along(context, model.point.par), model.point.field,
                                        model.point.event, plane_of(model.section, model.point.x, model.point.f));
  const int section = !model.section             ? suspended->least_distance()
                      : model.section->event > 0 ? model.section->event
                                                 : suspended->plane();
  const GrazingTurn cut{model.point.x, model.point.par, orbit.segments, orbit.durations,
                        extent_of(run.solution, system.dimension())};
  const auto smooth = std::make_shared<PeriodicReturn>(suspended, cut, section, request.smooth_order);
  model.smooth = smooth;
  model.par = with_given(context, model.point.par);
  model.neighbourhood = request.neighbourhood.value_or(INFINITY);
  model.text.push_back(fmt::format("Composite map of {}: x* = {}, {} = {:.12g}, period {:.10g}", run.source,
                                   numbers(model.point.x), system.parameter_name(turn.parameter),
                                   model.point.par(turn.parameter - 1), smooth->map().time));
  model.identity = fmt::format("{} x* = {}", request.source, numbers(model.point.x));
  return model;
}

/// States that some jump takes a whole turn off, or adds it to: angles.
std::vector<Index> angle_states(const HybridSystem& system, const VectorXd& x, const ParameterVector& par) {
  std::vector<Index> angles;
  VectorXd g(x.size());
  for (int k = 1; k <= system.count(FunctionKind::jump); ++k) {
    system.value(FunctionKind::jump, k, x.data(), par.data(), g.data());
    const VectorXd moved = g - x;
    Index state = 0;
    if (std::abs(moved.cwiseAbs().maxCoeff(&state) - full_turn) > level::orbit) continue;
    VectorXd rest = moved;
    rest(state) = 0.0;
    const bool others_stay = (rest.array().abs() <= level::orbit * x.array().abs()).all();
    if (others_stay && std::find(angles.begin(), angles.end(), state) == angles.end()) angles.push_back(state);
  }
  return angles;
}

bool varies(const Eigen::MatrixXd& points, Index state) {
  const double first = points(state, 0);
  for (Index k = 1; k < points.cols(); ++k)
    if (std::abs(nearest_phase((points(state, k) - first) / full_turn)) > constant_angle) return true;
  return false;
}

/// "x3" or "y1,y2".
std::vector<Index> phase_states(const HybridSystem& system, const std::string& text) {
  std::vector<Index> states;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    states.push_back(state_index(system, text.substr(begin, comma - begin), "--phase " + text) - 1);
    begin = comma + 1;
  }
  if (states.size() > 2 || (states.size() == 2 && states[0] == states[1]))
    throw UserError(
        fmt::format("--phase {}: a phase is one state that is an angle, as x3, or two that go round, as y1,y2", text));
  return states;
}

int wall_of(const MapRequest& request, const HybridSystem& system, const VectorXd& x, const ParameterVector& par) {
  if (request.wall) return cross_section(system, *request.wall).event;
  std::vector<int> walls;
  for (const IndexVector& index :
       system.successors({0, 0, 0}, x.data(), par.data()).value_or(std::vector<IndexVector>{})) {
    VectorXd g(x.size());
    system.value(FunctionKind::jump, index.jump, x.data(), par.data(), g.data());
    const bool turns = std::abs((g - x).cwiseAbs().maxCoeff() - full_turn) < level::orbit;
    if (!is_identity_jump(system, index) && !turns && std::find(walls.begin(), walls.end(), index.event) == walls.end())
      walls.push_back(index.event);
  }
  if (walls.size() == 1) return walls.front();
  throw UserError(fmt::format("--map {}: which event function is the wall that the torus touches? Name it with --wall",
                              request.source));
}

int jump_of(const MapContext& context, const HybridSystem& system, int field, int wall, const VectorXd& x,
            const ParameterVector& par) {
  for (const IndexVector& index :
       system.successors({0, 0, 0}, x.data(), par.data()).value_or(std::vector<IndexVector>{}))
    if (index.field == field && index.event == wall) return index.jump;
  return context.settings.grazing_jump;
}

/// Do all points lie where h_D is stationary?
bool lie_on_p(const HybridSystem& system, const Eigen::MatrixXd& points, int field, int wall,
              const ParameterVector& par) {
  for (Index k = 0; k < points.cols(); k += std::max<Index>(1, points.cols() / 50)) {
    const VectorXd x = points.col(k);
    const EventAt at = event_at(system, wall, field, x.data(), par.data());
    if (std::abs(at.rate()) > on_p * at.rate_scale(sizes_at(system, field, x, par))) return false;
  }
  return true;
}

/// The invariant curve of a torus on a section, from wherever it is known.
struct TorusCurve {
  InvariantCurve curve;
  std::vector<Index> angles;
  int event;  ///< of the section; 0: P, which no event function is
  int field, wall;
  bool is_p;
  ParameterVector par;     ///< of the torus
  std::vector<int> along;  ///< PAR indices in which the smooth map is expanded
  std::string text;        ///< for people: where it comes from
};

std::vector<Index> angles_of(const HybridSystem& system, const Eigen::MatrixXd& points, const ParameterVector& par) {
  std::vector<Index> angles;
  for (const Index state : angle_states(system, points.col(0), par))
    if (varies(points, state)) angles.push_back(state);
  return angles;
}

CurveSettings curve_settings(const HybridSystem& system, const Eigen::MatrixXd& points, int field,
                             const ParameterVector& par) {
  CurveSettings settings;
  settings.angles = angles_of(system, points, par);
  settings.sizes = points.cwiseAbs().rowwise().maxCoeff().cwiseMax(sizes_at(system, field, points.col(0), par));
  return settings;
}

TorusCurve curve_of_points(const MapRequest& request, const MapContext& context, const HybridSystem& system,
                           int named) {
  const std::vector<SectionPoints> all = read_section_points(system, request.source, named);
  const ParameterVector& par = context.par;
  const int wall = wall_of(request, system, all.front().states.col(0), par);
  const auto on = std::find_if(all.begin(), all.end(), [&](const SectionPoints& points) {
    return points.event != wall && lie_on_p(system, points.states, points.field, wall, par);
  });
  const bool is_p = on != all.end();
  if (!is_p && named == 0)
    throw UserError(
        fmt::format("{}: no event function's points in it lie where event {} ({}) is least; say with --section "
                    "which of them make the section",
                    request.source, wall, system.function_name(FunctionKind::event, wall)));
  const SectionPoints& points = is_p ? *on : all.front();
  const CurveSettings settings = curve_settings(system, points.states, points.field, par);
  const FittedCurve fit = fit_invariant_curve(points.states, settings, request.source);
  const std::string text = fmt::format(
      "Invariant curve of {} points on {}: rotation number {:.12g} +- {:.1e}, {} harmonics, {:.1e} off at most",
      points.states.cols(), system.function_name(FunctionKind::event, points.event), fit.curve.rotation(),
      fit.rotation_error, fit.curve.harmonics(), fit.error);
  return {fit.curve, settings.angles, points.event, points.field, wall, is_p, par, context.swept, text};
}

/// The event function that the run of the label watches, where it is one.
std::optional<int> watched_wall(const LabelledRun& run) {
  std::optional<int> wall;
  for (const MonitoredEvent& watched : chosen_events(run.settings, segment_count(run.settings))) {
    if (wall && *wall != watched.event) return std::nullopt;
    wall = watched.event;
  }
  return wall;
}

/// On P where no segment of the return ends there: a curve through points of the computed torus.
TorusCurve curve_on_p(const HybridSystem& system, const TorusLabel& torus, int field, int wall,
                      const std::vector<int>& along) {
  constexpr int points_on_curve = 4000;
  const Eigen::MatrixXd points = torus.points_on_p(wall, field, points_on_curve);
  const CurveSettings settings = curve_settings(system, points, field, torus.par());
  const FittedCurve fit = fit_invariant_curve(points, settings, torus.source());
  const std::string text = fmt::format(
      "Invariant curve of {}, {} points of its {} orbits on P: rotation number there {:.12g}, {} harmonics, {:.1e} off "
      "at most",
      torus.source(), points.cols(), torus.orbits(), fit.curve.rotation(), fit.curve.harmonics(), fit.error);
  return {fit.curve, settings.angles, 0, field, wall, true, torus.par(), along, text};
}

/// P_smooth of a torus is the flow of one field.
void require_one_field(const LabelledRun& run, const HybridSystem& system) {
  const Signature signature = run.settings.signature();
  for (const IndexVector& v : signature)
    if (v.field != signature.front().field)
      throw UserError(fmt::format(
          "--map {}: its returns have the fields {} ({}) and {} ({}), and the composite map of a torus is made for "
          "one; "
          "sweep by simulation, without --map",
          run.source, signature.front().field, system.function_name(FunctionKind::field, signature.front().field),
          v.field, system.function_name(FunctionKind::field, v.field)));
}

TorusCurve curve_of_label(const MapRequest& request, const MapContext& context, const HybridSystem& system,
                          const LabelledRun& run, int named) {
  require_one_field(run, system);
  const TorusLabel torus(system, run.solution, run.settings, run.source);
  const std::vector<TorusLabel::Section>& sections = torus.sections();
  const std::optional<int> watched = request.wall ? std::nullopt : watched_wall(run);
  const int wall = watched ? *watched : wall_of(request, system, sections.front().points.col(0), torus.par());
  const std::vector<int> along = parameters_along(context, torus.par());
  const auto on = std::find_if(sections.begin(), sections.end(), [&](const TorusLabel::Section& section) {
    return section.event != wall && (named == 0 || section.event == named) &&
           lie_on_p(system, section.points, section.field, wall, torus.par());
  });
  const auto at = on != sections.end()
                      ? on
                      : std::find_if(sections.begin(), sections.end(),
                                     [named](const TorusLabel::Section& section) { return section.event == named; });
  if (named == 0 && on == sections.end()) return curve_on_p(system, torus, sections.front().field, wall, along);
  if (at == sections.end())
    throw UserError(
        fmt::format("--section {}: no segment of the return of {} ends in event function {}; leave --section out for "
                    "P, where event {} ({}) is least",
                    *context.section, torus.source(), named, wall, system.function_name(FunctionKind::event, wall)));
  if (!is_identity_jump(system, {at->field, at->event, at->jump}))
    throw UserError(fmt::format(
        "--section {}: segments of {} that end in event function {} are followed by jump {} ({}); a section "
        "is where nothing happens: leave --section out for P, where event {} ({}) is least",
        *context.section, torus.source(), at->event, at->jump, system.function_name(FunctionKind::jump, at->jump), wall,
        system.function_name(FunctionKind::event, wall)));
  const std::string text = fmt::format(
      "Invariant curve of {}, {} orbits, on {}: rotation number {:.12g}, {} harmonics", torus.source(), torus.orbits(),
      system.function_name(FunctionKind::event, at->event), at->curve.rotation(), at->curve.harmonics());
  std::vector<Index> angles;
  for (Index state = 0; state < at->curve.dimension(); ++state)
    if (at->curve.is_angle(state)) angles.push_back(state);
  return {at->curve, angles, at->event, at->field, wall, on != sections.end(), torus.par(), along, text};
}

CurveProjection projection_of(const MapRequest& request, const HybridSystem& system, const TorusCurve& torus) {
  const std::vector<Index> phase = request.phase ? phase_states(system, *request.phase) : torus.angles;
  if (phase.empty()) return CurveProjection(torus.curve);
  return phase.size() == 1 ? CurveProjection(torus.curve, phase[0]) : CurveProjection(torus.curve, phase[0], phase[1]);
}

MapModel torus_model(const MapRequest& request, const MapContext& context, const HybridSystem& system,
                     const std::optional<LabelledRun>& run) {
  const int named = context.section ? cross_section(system, *context.section).event : 0;
  if (context.section && named == 0)
    throw UserError(fmt::format("--section {}: points of a torus are those of an event function; name {}",
                                *context.section,
                                run ? "one that ends segments of its return" : "the one that was recorded"));
  const TorusCurve known =
      run ? curve_of_label(request, context, system, *run, named) : curve_of_points(request, context, system, named);
  const CurveProjection projection = projection_of(request, system, known);
  const auto suspended = std::make_shared<SuspendedSystem>(system, known.along, known.field, known.wall);
  TorusSettings torus_settings;
  torus_settings.order = request.smooth_order;
  const auto torus =
      std::make_shared<TorusReturn>(suspended, known.curve, projection, known.par,
                                    known.is_p ? suspended->least_distance() : known.event, torus_settings);
  const int swept = context.swept.front();
  const int wall = known.wall;
  const TorusGrazing grazing = torus_grazing(system, *torus, known.field, wall, swept, request.source);
  const VectorXd x = corrected_contact(system, known.field, wall, grazing.x, grazing.par, request.source);
  const int jump = jump_of(context, system, known.field, wall, x, grazing.par);
  MapModel model;
  model.point = grazing_point(system, known.field, wall, jump, x, grazing.par, request.source,
                              segments_after_impact(system, {known.field, wall, jump}, x, grazing.par, known.field));
  if (!known.is_p) model.section = CrossSection{known.event, 0};
  model.smooth = model.torus = torus;
  model.phase = projection.phase(model.section ? torus->on_curve(grazing.phase) : x);
  model.par = with_given(context, known.par);
  model.neighbourhood = request.neighbourhood.value_or(torus_neighbourhood);
  model.text.push_back(known.text);
  model.text.push_back(
      fmt::format("Smooth map: derivatives at {} phases, interpolated to {:.1e}; return in {:.6g} of time",
                  torus->nodes(), torus->interpolation_error(), torus->mean_time()));
  model.text.push_back(fmt::format("The torus touches {} at {} = {:.10g}, x* = {}",
                                   system.function_name(FunctionKind::event, wall), system.parameter_name(swept),
                                   grazing.par(swept - 1), numbers(x)));
  if (torus->depends_on_parameters()) {
    std::vector<std::string> names, values;
    for (const int k : known.along) {
      names.push_back(system.parameter_name(k));
      values.push_back(fmt::format("{:.10g}", known.par(k - 1)));
    }
    model.text.push_back(fmt::format(
        "The smooth torus depends on {}: its change is taken to first order from {}, the value{} of the {}",
        fmt::join(names, " or "), fmt::join(values, ", "), names.size() > 1 ? "s" : "", run ? "label" : "points"));
  }
  model.identity = fmt::format("{} rho = {:.17g} x* = {}", request.source, known.curve.rotation(), numbers(x));
  return model;
}

}  // namespace

bool names_label(const std::string& source) {
  const std::size_t colon = source.rfind(':');
  return colon != std::string::npos && colon > 0 && colon + 1 < source.size() &&
         source.find('/', colon) == std::string::npos;
}

MapOrder map_order(const std::string& text) {
  if (text == "1/2") return MapOrder::half;
  if (text == "1") return MapOrder::one;
  if (text == "3/2") return MapOrder::three_halves;
  if (text == "exact") return MapOrder::exact;
  throw UserError(fmt::format("--order {}: it is none of 1/2, 1, 3/2, exact; an example is --order 3/2", text));
}

MapModel map_model(const MapRequest& request, const MapContext& context, const HybridSystem& system) {
  std::optional<LabelledRun> run;
  if (names_label(request.source)) run = labelled_run(request, context, system);
  MapModel model = run && !has_several_returns(run->solution) ? periodic_model(request, context, system, *run)
                                                              : torus_model(request, context, system, run);
  model.free = free_return(system, model.point, model.section);
  model.contact = {model.point.field, model.point.event, model.point.jump};
  return model;
}

std::unique_ptr<IteratedMap> iterated_map(const MapRequest& request, const MapModel& model,
                                          const HybridSystem& system) {
  const auto contact = std::make_shared<const DiscontinuityMap>(system, model.point, model.section);
  const LocalContact local(model.smooth, contact, map_order(request.order), model.neighbourhood);
  if (!request.reduced) return std::make_unique<CompositeMap>(local);
  if (*request.reduced == "map") return std::make_unique<ReducedMap>(model.torus, local);
  if (*request.reduced == "ellipse") return std::make_unique<EllipseMap>(model.torus, contact, model.phase);
  throw UserError(
      fmt::format("--reduced {}: it is neither map nor ellipse; an example is --reduced map", *request.reduced));
}

}  // namespace tchat
