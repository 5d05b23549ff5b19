#include "maps/simulated_torus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/dat_file.hpp"
#include "files/replaced_file.hpp"
#include "files/run_files.hpp"
#include "files/solution_file.hpp"
#include "model/events.hpp"
#include "motion/orbit_flow.hpp"
#include "orbit/torus_system.hpp"
#include "plugin/problem_setup.hpp"
#include "run/orbit_start.hpp"
#include "run/run_remarks.hpp"
#include "settings/constants_writer.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_type.hpp"
#include "simulate/orbit_hand_over.hpp"
#include "simulate/simulation_start.hpp"
#include "simulate/simulation_summary.hpp"

namespace tchat {

namespace {

std::string text_of(const IndexVector& index) {
  return fmt::format("({}, {}, {})", index.field, index.event, index.jump);
}

/// How many segments from `first` on are those of the signature, again and again.
std::size_t agreeing(const std::vector<PassedSegment>& motion, const Signature& one_return, std::size_t first) {
  std::size_t k = first;
  while (k < motion.size() && motion[k].index == one_return[(k - first) % one_return.size()]) ++k;
  return k - first;
}

/// In turns. The middle of the widest gap that points leave on the circle, and its width.
std::pair<double, double> widest_gap_of(const Eigen::RowVectorXd& turns) {
  std::vector<double> sorted;
  for (const double t : turns) sorted.push_back(t - std::floor(t));
  std::sort(sorted.begin(), sorted.end());
  double middle = 0.0, width = -1.0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const double next = k + 1 < sorted.size() ? sorted[k + 1] : sorted.front() + 1.0;
    if (next - sorted[k] <= width) continue;
    width = next - sorted[k];
    middle = 0.5 * (next + sorted[k]);
  }
  return {middle, width};
}

[[noreturn]] void fail(int orbit, std::size_t segment, const std::string& why) {
  throw ComputationError(
      fmt::format("return {} from the fitted curve cannot be integrated, segment {}: {}", orbit + 1, segment + 1, why));
}

}  // namespace

Eigen::MatrixXd points_of_returns(const std::vector<PassedSegment>& motion, const Signature& one_return,
                                  const std::string& source) {
  const std::size_t m = one_return.size();
  std::size_t best = 0;
  for (std::size_t first = 1; first < std::min(m, motion.size()); ++first)
    if (agreeing(motion, one_return, first) > agreeing(motion, one_return, best)) best = first;
  const std::size_t count = agreeing(motion, one_return, best);
  if (best + count < motion.size())
    throw UserError(
        fmt::format("{}: the motion does not go by the signature of one return: segment {} after the transient is {}, "
                    "not {}; give the "
                    "signature that the motion on the torus has (O.events of a plain simulation lists it), drop a "
                    "longer transient, or "
                    "follow the signature's own events alone (--follow-signature)",
                    source, best + count + 1, text_of(motion[best + count].index), text_of(one_return[count % m])));
  Eigen::MatrixXd points(motion.front().start.size(), static_cast<Eigen::Index>((count + m - 1) / m));
  for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) = motion[best + static_cast<std::size_t>(k) * m].start;
  return points;
}

PointsWithAngles with_angles(const HybridSystem& system, const Signature& one_return, Eigen::MatrixXd points,
                             const ParameterVector& par) {
  constexpr Eigen::Index samples = 20;
  constexpr double empty = 0.05;  // turns: so many points of a curve that goes round leave less
  constexpr double turn = 2.0 * std::numbers::pi;
  PointsWithAngles result;
  for (const Eigen::Index state :
       angle_states(system, one_return, points.leftCols(std::min(samples, points.cols())), par)) {
    const auto [middle, width] = widest_gap_of(points.row(state) / turn);
    if (width < empty) result.winding.push_back(state);
    // From the middle of the gap on: a curve that does not go round is in one piece then.
    for (double& x : points.row(state)) x -= turn * std::floor(x / turn - middle + 1.0);
  }
  result.points = std::move(points);
  return result;
}

Orbit orbits_from_curve(const HybridSystem& system, const Signature& one_return, const InvariantCurve& curve,
                        const ParameterVector& par, const TorusMesh& mesh, double longest,
                        const Eigen::VectorXd& sizes) {
  const auto m = static_cast<int>(one_return.size());
  const OrbitShape shape{system.dimension(), mesh.orbits * m, mesh.intervals, mesh.collocation};
  Orbit x{shape, uniform_mesh(mesh.intervals), Eigen::MatrixXd(shape.dimension, shape.columns()), par};
  x.par.rotation() = curve.rotation();
  FlowOptions options;
  options.set(level::relaxed_flow);
  options.surface_tolerance = level::same;  // the fitted curve is on the section to the accuracy of the fit
  options.variational = false;
  options.max_duration = 10.0 * longest;
  options.sizes = sizes;
  for (int i = 0; i < mesh.orbits; ++i) {
    Eigen::VectorXd state = curve.at(static_cast<double>(i) / mesh.orbits);
    for (int s = 0; s < m; ++s) {
      const IndexVector& index = one_return[static_cast<std::size_t>(s)];
      const SegmentFlow whole = integrate_segment(system, index, state, par, options);
      if (whole.status != FlowStatus::event_reached) fail(i, static_cast<std::size_t>(s), whole.message);
      const int segment = i * m + s;
      x.duration(segment) = whole.duration;
      for (int k = 0; k < shape.nodes(); ++k) {
        x.states.col(segment * shape.nodes() + k) = state;
        if (k + 1 == shape.nodes()) break;
        const SegmentFlow part =
            integrate_for(system, index.field, state, par, (x.tau(k + 1) - x.tau(k)) * whole.duration, options);
        if (part.status == FlowStatus::failed) fail(i, static_cast<std::size_t>(s), part.message);
        state = part.end_state;
      }
      Eigen::VectorXd next(shape.dimension);
      system.value(FunctionKind::jump, index.jump, state.data(), par.data(), next.data());
      state = next;
    }
  }
  return x;
}

namespace {

constexpr long returns = 1500;
constexpr long transient_returns = 500;
/// Newton's method corrects what the fit leaves.
constexpr double fit_tolerance = 1e-3;
constexpr int fewest_harmonics = 7;

Signature signature_of(const SimulationConstants& constants, const SimulationRequest& request) {
  if (!constants.has_signature)
    throw UserError(fmt::format(
        "{}: --torus needs the signature of one return to a section: give it in constants (-c), or as --signature "
        "'FIELD,EVENT,JUMP;...'",
        request.name));
  Signature signature = constants.settings.signature();
  const auto room = static_cast<std::size_t>(max_torus_segments / (2 * fewest_harmonics + 1));
  if (signature.size() > room)
    throw UserError(
        fmt::format("{}: a return of {} segments is too long for a torus, at most {} are allowed; choose a "
                    "section that the motion meets more often",
                    request.name, signature.size(), room));
  return signature;
}

SimulationPlan plan_of(const SimulationPlan& asked, std::size_t segments) {
  SimulationPlan plan = asked;
  const auto m = static_cast<long>(segments);
  if (!plan.time && !plan.events) plan.events = returns * m;
  if (plan.transient_time == 0.0 && plan.transient_events == 0) plan.transient_events = transient_returns * m;
  return plan;
}

/// A state that goes on and on is an angle to the user, not to the problem.
void refuse_growth(const HybridSystem& system, const Eigen::MatrixXd& points, const std::string& source) {
  const Eigen::Index half = points.cols() / 2;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::RowVectorXd first = points.row(i).head(half), second = points.row(i).tail(half);
    const bool apart = first.maxCoeff() < second.minCoeff() || second.maxCoeff() < first.minCoeff();
    const double moved = std::abs(second.mean() - first.mean());
    if (!apart || moved < 1.0) continue;
    throw UserError(
        fmt::format("{}: {} goes on and on, from {:.4g} to {:.4g}: an angle may do so where 2 pi more changes neither "
                    "fields nor events nor jumps of the signature, which is not so here; end returns in the event "
                    "whose jump takes 2 pi off (--signature), or write the problem with sine and cosine of that angle "
                    "as two states, or drop a longer transient where the motion only drifts",
                    source, system.state_name(static_cast<int>(i) + 1), points(i, 0), points(i, points.cols() - 1)));
  }
}

int free_parameter(const SimulationRequest& request, const SimulationConstants& constants, const HybridSystem& system) {
  if (request.parameter) return parameter_index(system, *request.parameter, "--free");
  for (const int k : constants.settings.free_parameters)
    if (k <= system.parameters()) return k;
  return 1;
}

RunSettings torus_settings(const SimulationConstants& constants, int parameter) {
  RunSettings settings = constants.is_given() ? constants.settings : default_orbit_settings(constants.settings);
  leave_out_monitors(settings);
  settings.held.clear();
  settings.conserved.clear();
  settings.problem_type = invariant_torus.number;
  settings.branch_mode = invariant_torus.branch_mode;
  settings.free_parameters = {parameter, constants.settings.layout.rotation()};
  settings.start = {"", 1};
  return settings;
}

/// What constants would have said of the segments: types by the jumps, events that may come next are watched.
void complete_segments(RunSettings& settings, const HybridSystem& system, const Orbit& orbit) {
  for (SegmentSettings& segment : settings.segments) segment.type = is_identity_jump(system, segment.index) ? 0 : 1;
  watch_possible_events(system, settings, orbit);
}

}  // namespace

int simulate_torus(const SimulationRequest& request, const std::string& torus_name, std::ostream& screen,
                   std::ostream& warnings, const std::function<bool()>& interrupted, std::ostream* progress) {
  const auto say = [&](const std::string& text) {
    if (!request.quiet) screen << text << std::flush;
  };
  const LoadedProblem loaded = load_for_simulation(request, progress);
  const HybridSystem& system = loaded.library->system();
  const SimulationConstants& constants = loaded.constants;
  const Signature one_return = signature_of(constants, request);
  const SimulationStart start = simulation_start(request, constants, system);
  const std::string name = torus_name.empty() ? request.output.value_or(request.name) : torus_name;
  const std::string solutions = output_path('q', name);
  const std::string constants_file = constants_file_of(name);
  require_writable(solutions);
  require_writable(constants_file);
  if (!constants.path.empty() && same_file(constants_file, constants.path))
    throw UserError(
        fmt::format("--torus would replace {}, which the simulation reads; give the torus a name, as in "
                    "--torus {}_torus",
                    constants_file, request.name));

  SimulationSettings motion_settings = simulation_settings(request, interrupted);
  motion_settings.side = start.side;
  HybridSimulation simulation(start.rule, start.state, start.par, motion_settings);
  say(start_text(system, start, simulation.mode()));
  warnings << side_without_effect(simulation, request.side);
  for (const StartNotice& notice : start_notices(simulation)) warnings << notice_text(system, notice);
  std::vector<PassedSegment> motion;
  double longest = 0.0;
  SimulationResult result;
  {
    ProgressLine line(progress);
    AttractorSearch search(request.plan.max_period, request.plan.recognition, motion_settings);
    const auto keep = [&](const SimulatedSegment& segment) {
      if (goes_on(segment)) motion.push_back({segment.index, segment.start});
      longest = std::max(longest, segment.duration);
      if (line.is_due()) line.show(fmt::format("{} events, t = {:.6g} ", segment.number, segment.end_time()));
    };
    result = run_simulation(simulation, plan_of(request.plan, one_return.size()), keep, search);
  }
  if (result.end == MotionEnd::failed) throw ComputationError(result.last.message);
  if (motion.empty())
    throw ComputationError(
        fmt::format("{}: no segment ended in an event after the transient: {}", request.name, result.last.message));
  const auto [points, angles] =
      with_angles(system, one_return, points_of_returns(motion, one_return, request.name), start.par);
  refuse_growth(system, points, request.name);
  const FittedCurve fitted = fit_invariant_curve(
      points, {.angles = angles, .sizes = simulation.sizes(), .max_harmonics = 200, .tolerance = fit_tolerance},
      request.name);

  RunSettings settings = torus_settings(constants, free_parameter(request, constants, system));
  const int most = (max_torus_segments / static_cast<int>(one_return.size()) - 1) / 2;
  const int harmonics = std::clamp(settings.harmonics > 0 ? settings.harmonics : fitted.curve.harmonics(),
                                   std::min(fewest_harmonics, most), most);
  const Orbit orbit = orbits_from_curve(system, one_return, fitted.curve, start.par,
                                        {2 * harmonics + 1, settings.mesh_intervals, settings.collocation_points},
                                        longest, simulation.sizes());
  if (!constants.is_given()) complete_segments(settings, system, orbit);
  LabelledSolution solution = labelled_solution(orbit, {}, {}, {});
  solution.type = static_cast<int>(PointType::end);
  solution.problem_type = settings.problem_type;
  solution.branch_mode = settings.branch_mode;
  write_whole_file(solutions, format_solution(solution));
  settings.problem = problem_to_record(request.problem.value_or(request.name), constants_file);
  write_whole_file(constants_file, keyword_text(settings));

  say(fmt::format(
      "The motion is quasi-periodic: {} points of returns lie on a closed curve of {} harmonics, to {:.1e} of "
      "its extent.\nRotation number rho = {:.10g} (+- {:.0e}), mean return time {:.10g}.\n",
      points.cols(), fitted.curve.harmonics(), fitted.error, fitted.curve.rotation(), fitted.rotation_error,
      orbit.period() / (2 * harmonics + 1)));
  const std::string plugin = request.problem ? fmt::format(" -p {}", *request.problem) : "";
  say(fmt::format("Written: {} and {}, {} orbits of one return\n  next: tchat run {}{} -c {} -s {} -o {}_run\n",
                  solutions, constants_file, 2 * harmonics + 1, request.name, plugin, name, name, name));
  return 0;
}

}  // namespace tchat
