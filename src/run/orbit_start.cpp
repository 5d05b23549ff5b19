#include "run/orbit_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/dat_file.hpp"
#include "files/recorded_labels.hpp"
#include "files/replaced_file.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "settings/constants_table.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Half of the mesh density follows time, half the arclength of the data with every component scaled by its range.
std::vector<double> mesh_of_data(const DatFile& data, int intervals) {
  const Eigen::Index rows = data.states.cols();
  const Eigen::VectorXd range = data.states.rowwise().maxCoeff() - data.states.rowwise().minCoeff();
  Eigen::VectorXd length(rows - 1);
  for (Eigen::Index j = 0; j + 1 < rows; ++j) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < range.size(); ++i)
      if (range(i) > 0.0) sum += std::pow((data.states(i, j + 1) - data.states(i, j)) / range(i), 2);
    length(j) = std::sqrt(sum);
  }
  const double total = length.sum();
  Eigen::VectorXd density(rows - 1);
  for (Eigen::Index j = 0; j + 1 < rows; ++j) {
    const double dt = data.tau[static_cast<std::size_t>(j + 1)] - data.tau[static_cast<std::size_t>(j)];
    density(j) = 1.0 + (total > 0.0 ? length(j) / (total * dt) : 0.0);
  }
  return equal_parts(data.tau, density, intervals);
}

/// Lagrange interpolation through the (at most) four rows around tau.
Eigen::VectorXd interpolate(const DatFile& data, double tau) {
  const int rows = static_cast<int>(data.tau.size());
  const int right = static_cast<int>(std::upper_bound(data.tau.begin(), data.tau.end(), tau) - data.tau.begin());
  const int count = std::min(rows, 4);
  const int first = std::clamp(right - 2, 0, rows - count);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(data.states.rows());
  for (int i = first; i < first + count; ++i) {
    double weight = 1.0;
    for (int k = first; k < first + count; ++k)
      if (k != i) weight *= (tau - data.tau[index(k)]) / (data.tau[index(i)] - data.tau[index(k)]);
    result += weight * data.states.col(i);
  }
  return result;
}

/// (n m) x NTPL stacked segments to n x (m NTPL), and back.
Eigen::MatrixXd unstack(const Eigen::MatrixXd& stacked, int n) {
  const Eigen::Index m = stacked.rows() / n;
  Eigen::MatrixXd result(n, m * stacked.cols());
  for (Eigen::Index s = 0; s < m; ++s)
    result.middleCols(s * stacked.cols(), stacked.cols()) = stacked.middleRows(s * n, n);
  return result;
}

Eigen::MatrixXd stack(const Eigen::MatrixXd& states, const OrbitShape& shape) {
  Eigen::MatrixXd result(shape.dimension * shape.segments, shape.nodes());
  for (int s = 0; s < shape.segments; ++s)
    result.middleRows(s * shape.dimension, shape.dimension) = states.middleCols(s * shape.nodes(), shape.nodes());
  return result;
}

/// The mesh that the rows lie on, when they divide NTST intervals of different length into equal parts, a multiple of
/// NCOL on each; empty when there is none.
std::vector<double> mesh_of_rows(const DatFile& data, const OrbitShape& shape) {
  constexpr double rounding = level::orbit;  // of a step: rows may be written with 15 digits
  const int rows = static_cast<int>(data.tau.size()) - 1;
  if (rows < 1 || rows % (shape.nodes() - 1) != 0) return {};
  const int parts = rows / shape.intervals;
  std::vector<double> mesh{data.tau.front()};
  bool uniform = true;
  for (int j = 0; j < shape.intervals; ++j) {
    const double begin = data.tau[index(j * parts)];
    const double length = data.tau[index((j + 1) * parts)] - begin;
    for (int k = 1; k < parts; ++k)
      if (std::abs(data.tau[index(j * parts + k)] - begin - length * k / parts) > rounding * (1e-3 + length)) return {};
    mesh.push_back(begin + length);
    uniform = uniform && std::abs(length * shape.intervals - 1.0) < 1e-3;
  }
  mesh.back() = 1.0;
  return uniform ? std::vector<double>{} : mesh;
}

/// The data on a mesh.
Orbit on_mesh(const DatFile& data, const std::vector<double>& mesh, const OrbitShape& shape,
              const ParameterVector& par) {
  Orbit orbit{shape, mesh, Eigen::MatrixXd(shape.dimension, shape.columns()), par};
  Eigen::MatrixXd stacked(data.states.rows(), shape.nodes());
  for (int k = 0; k < shape.nodes(); ++k) stacked.col(k) = interpolate(data, orbit.tau(k));
  orbit.states = unstack(stacked, shape.dimension);
  return orbit;
}

bool is_stored_point(const LabelledSolution& solution) { return solution.tau.size() == 1; }

/// A point is stored with one state, its shape has two nodes.
Eigen::MatrixXd at_nodes(const Eigen::MatrixXd& states, const OrbitShape& shape) {
  return shape.stored_nodes() == 1 ? states.replicate(1, shape.nodes()) : unstack(states, shape.dimension);
}

/// The stored direction on the stored mesh; nothing when it belongs to other free parameters.
std::optional<OrbitVector> stored_direction(const LabelledSolution& solution, const OrbitShape& stored,
                                            const std::vector<int>& free_parameters) {
  if (!solution.has_direction()) return std::nullopt;
  OrbitVector direction(stored, static_cast<int>(free_parameters.size()));
  std::size_t found = 0;
  for (std::size_t i = 0; i < solution.free_parameters.size() && i < solution.parameter_direction.size(); ++i) {
    const bool is_period = solution.free_parameters[i] == auto_period(solution.problem_type);
    const ParameterLayout& layout = solution.layout;
    const int k = is_period ? layout.first_duration() : solution.free_parameters[i];
    if (layout.is_duration(k, stored.segments)) {
      direction.durations(layout.duration_segment(k)) = solution.parameter_direction[i];
      continue;
    }
    const auto at = std::find(free_parameters.begin(), free_parameters.end(), k);
    if (at == free_parameters.end()) return std::nullopt;
    direction.globals(at - free_parameters.begin()) = solution.parameter_direction[i];
    ++found;
  }
  if (found != free_parameters.size()) return std::nullopt;
  direction.states = at_nodes(solution.state_direction, stored);
  return direction;
}

ParameterVector stored_parameters(const LabelledSolution& solution, const OrbitShape& shape) {
  ParameterVector par(solution.layout, shape.segments);
  for (std::size_t k = 0; k < std::min(solution.parameters.size(), static_cast<std::size_t>(par.size())); ++k)
    par(static_cast<Eigen::Index>(k)) = solution.parameters[k];
  return par;
}

/// The intervals of a segment on average.
int own_intervals(const LabelledSolution& solution, int segments) {
  return (static_cast<int>(solution.own_mesh.size()) - segments) / segments;
}

/// On the segments' own meshes: those of the file, exactly, or the one in common for each.
void take_own_meshes(const LabelledSolution& solution, OrbitStart& start) {
  Orbit& x = start.orbit;
  if (solution.own_mesh.empty()) {
    x = with_own_meshes(std::move(x));
    return;
  }
  const std::vector<double>& mesh = solution.own_mesh;
  std::vector<int> intervals;
  for (auto begin = mesh.begin(); begin != mesh.end();) {
    const auto end = std::find(begin, mesh.end(), 1.0);
    intervals.push_back(static_cast<int>(end - begin));
    begin = end + 1;
  }
  OrbitShape own = x.shape;
  own.intervals = own_intervals(solution, own.segments);
  own.own = OwnIntervals(intervals);
  const auto on_own = [&](const Eigen::MatrixXd& states) {
    return states_on_own_meshes(states, x.shape, x.mesh, own, mesh);
  };
  if (start.direction) start.direction->states = on_own(start.direction->states);
  x.states = on_own(x.states);
  x.shape = own;
  x.mesh = mesh;
}

OrbitStart point_start(const LabelledSolution& solution, const OrbitShape& shape,
                       const std::vector<int>& free_parameters) {
  OrbitStart start;
  start.direction = stored_direction(solution, shape, free_parameters);
  start.orbit = {shape, uniform_mesh(1), at_nodes(solution.states, shape), stored_parameters(solution, shape)};
  start.orbit.duration(0) = 0.0;
  return start;
}

struct StoredStates {
  Orbit orbit;
  OrbitVector direction;
};

/// An orbit on own meshes on one in common.
StoredStates in_common(const Orbit& x, const OrbitVector& direction) {
  StoredStates result{{x.shape.in_common(), mesh_in_common(x.shape, x.mesh), {}, x.par}, direction};
  Orbit& stored = result.orbit;
  stored.shape.intervals = static_cast<int>(stored.mesh.size()) - 1;
  const MeshTransfer transfer(x.shape, x.mesh, stored.shape, stored.mesh, CollocationRule(x.shape.collocation));
  stored.states = transfer(x.states);
  if (direction.states.size() > 0) result.direction.states = transfer(direction.states);
  return result;
}

/// Where the rows tell the derivatives between them, on meshes that equidistribute the error of the data on a mesh in
/// common, which is as fine as the rows or four times as fine.
Orbit on_own_meshes(const DatFile& data, const OrbitShape& shape, const ParameterVector& par) {
  const auto rows = static_cast<int>(data.tau.size());
  OrbitShape fine = shape.in_common();
  fine.intervals = std::clamp(rows / fine.collocation, fine.intervals, 4 * fine.intervals);
  const Orbit x = with_own_meshes(orbit_from_data(data, fine, par));
  if (rows < shape.mean_nodes()) return x;
  const CollocationRule rule(shape.collocation);
  MeshEquidistribution equidistribution;
  const std::vector<double> mesh = equidistribution.mesh(x, rule, shape.intervals);
  const MeshTransfer transfer(x.shape, x.mesh, equidistribution.shape(), mesh, rule);
  return {equidistribution.shape(), mesh, transfer(x.states), par};
}

}  // namespace

std::optional<Orbit> orbit_from_rows(const DatFile& data, const OrbitShape& shape, const ParameterVector& par) {
  constexpr int highest_degree = 7;
  if (shape.own) {
    std::optional<Orbit> in_common = orbit_from_rows(data, shape.in_common(), par);
    return in_common ? std::optional(with_own_meshes(*std::move(in_common))) : std::nullopt;
  }
  const int rows = static_cast<int>(data.tau.size()) - 1;
  for (int degree = highest_degree; degree > 1; --degree) {
    if (rows % degree != 0) continue;
    const OrbitShape stored{shape.dimension, shape.segments, rows / degree, degree};
    const std::vector<double> mesh = mesh_of_rows(data, stored);
    if (mesh.empty()) continue;
    Orbit orbit{shape, resampled_mesh(mesh, shape.intervals), {}, par};
    orbit.states = interpolate_states(unstack(data.states, shape.dimension), stored, mesh, shape, orbit.mesh);
    return orbit;
  }
  return std::nullopt;
}

Orbit orbit_from_data(const DatFile& data, const OrbitShape& shape, const ParameterVector& par) {
  if (shape.own) return on_own_meshes(data, shape, par);
  if (const std::vector<double> mesh = mesh_of_rows(data, shape); !mesh.empty()) return on_mesh(data, mesh, shape, par);
  std::optional<Orbit> same_density = orbit_from_rows(data, shape, par);
  // On a coarser mesh every interval covers several, and which of them it had best unite is seen anew.
  if (same_density && shape.nodes() >= static_cast<int>(data.tau.size())) return *std::move(same_density);
  Orbit orbit = on_mesh(data, mesh_of_data(data, shape.intervals), shape, par);
  // Fewer rows than nodes say nothing of the derivatives between them.
  if (static_cast<int>(data.tau.size()) < shape.nodes()) return orbit;
  const CollocationRule rule(shape.collocation);
  for (int pass = 0; pass < 5; ++pass)
    orbit = on_mesh(data, equidistributed_mesh(orbit, rule, shape.intervals), shape, par);
  return orbit;
}

Orbit point_from_data(const DatFile& data, const ParameterVector& par) {
  const OrbitShape shape = OrbitShape::point(static_cast<int>(data.states.rows()));
  return {shape, uniform_mesh(1), at_nodes(data.states.leftCols(1), shape), par};
}

OrbitStart orbit_from_solution(const LabelledSolution& solution, const OrbitShape& shape,
                               const std::vector<int>& free_parameters, const std::string& source) {
  const int rows = static_cast<int>(solution.states.rows());
  const bool other_dimension = solution.dimension > 0 && solution.dimension != shape.dimension;
  if (rows != shape.dimension * shape.segments || other_dimension)
    throw UserError(fmt::format(
        "{}: label {} has {} states at each time ({}), the constants ask for {} segments of {} states; restart with "
        "the "
        "signature and dimension of the label, or make new starting data where the number of segments changes",
        source, solution.label, rows,
        solution.dimension > 0 ? fmt::format("{} segments of {}", rows / solution.dimension, solution.dimension)
                               : "dimension of a segment not recorded",
        shape.segments, shape.dimension));
  const bool is_one_state = shape.stored_nodes() == 1;
  if (is_stored_point(solution) != is_one_state)
    throw UserError(
        is_one_state
            ? fmt::format("{}: label {} is an orbit, not an equilibrium; restart from a label of a run with IPS = {}, "
                          "or from data",
                          source, solution.label, equilibrium.number)
            : fmt::format("{}: label {} is an equilibrium, not an orbit; at a Hopf bifurcation (HB) ISW = -1 begins "
                          "the periodic orbits, and IPS = {} goes on with equilibria",
                          source, solution.label, equilibrium.number));
  if (is_one_state) return point_start(solution, shape, free_parameters);
  if (solution.collocation_points < 1 || solution.collocation_points > 7 || solution.mesh_intervals < 1)
    throw UserError(
        fmt::format("{}: label {} has {} collocation points on {} mesh intervals, not an orbit; restart "
                    "from another label",
                    source, solution.label, solution.collocation_points, solution.mesh_intervals));

  const OrbitShape stored{shape.dimension, shape.segments, solution.mesh_intervals, solution.collocation_points};
  std::vector<double> mesh;
  for (int j = 0; j <= stored.intervals; ++j) mesh.push_back(solution.tau[index(j * stored.collocation)]);
  for (std::size_t j = 1; j < mesh.size(); ++j)
    if (!(mesh[j] > mesh[j - 1]))
      throw UserError(fmt::format("{}: the mesh of label {} does not rise at interval {}; restart from another label",
                                  source, solution.label, j));

  OrbitStart start;
  start.direction = stored_direction(solution, stored, free_parameters);
  start.orbit = {stored, mesh, unstack(solution.states, shape.dimension), {}};
  start.orbit.par = stored_parameters(solution, stored);
  // A boundary value problem of AUTO itself is one on the interval from 0 to 1.
  if (is_shared_problem_type(solution.problem_type) &&
      solution.parameters.size() < static_cast<std::size_t>(solution.layout.first_duration()))
    start.orbit.par.durations(shape.segments).setOnes();
  if (const std::optional<int> period = auto_period(solution.problem_type))
    std::swap(start.orbit.par(*period - 1), start.orbit.duration(0));
  if (shape.own) take_own_meshes(solution, start);
  const OrbitShape from = start.orbit.shape;
  if (from.intervals == shape.intervals && from.collocation == shape.collocation) return start;

  const CollocationRule rule(from.collocation);
  OrbitShape to = resized(from, shape.intervals);
  std::vector<double> new_mesh;
  if (shape.own && solution.own_mesh.empty()) {  // as many intervals for each segment as it needs
    MeshEquidistribution equidistribution;
    new_mesh = equidistribution.mesh(start.orbit, rule, shape.intervals);
    to = equidistribution.shape();
  } else {
    new_mesh = resampled_mesh(from, start.orbit.mesh, to);
  }
  to.collocation = shape.collocation;
  const MeshTransfer transfer(from, start.orbit.mesh, to, new_mesh, rule);
  start.orbit.states = transfer(start.orbit.states);
  if (start.direction) start.direction->states = transfer(start.direction->states);
  start.orbit.mesh = new_mesh;
  start.orbit.shape = to;
  return start;
}

OrbitShape stored_shape(const LabelledSolution& solution, int dimension, int segments) {
  OrbitShape shape{dimension, segments, solution.mesh_intervals, solution.collocation_points};
  if (solution.own_mesh.empty()) return shape;
  shape.intervals = own_intervals(solution, segments);
  return shape.with_own_meshes();
}

LabelledSolution labelled_solution(const Orbit& orbit, const OrbitVector& direction,
                                   const std::vector<int>& free_parameters, const std::vector<int>& listed) {
  const OrbitShape& shape = orbit.shape;
  if (shape.own) {
    const StoredStates stored = in_common(orbit, direction);
    LabelledSolution solution = labelled_solution(stored.orbit, stored.direction, free_parameters, listed);
    if (!have_one_mesh(shape, orbit.mesh)) solution.own_mesh = orbit.mesh;
    return solution;
  }
  const ParameterLayout& layout = orbit.par.layout();
  LabelledSolution solution;
  solution.dimension = shape.dimension;
  solution.layout = layout;
  solution.mesh_intervals = shape.intervals;
  const int points = shape.stored_nodes();
  solution.collocation_points = (points - 1) / shape.intervals;
  solution.tau = orbit.node_times();
  solution.tau.resize(static_cast<std::size_t>(points));
  solution.states = stack(orbit.states, shape).leftCols(points);
  if (direction.states.size() > 0) solution.state_direction = stack(direction.states, shape).leftCols(points);
  solution.free_parameters = listed;
  for (const int k : listed) {
    if (layout.is_duration(k, shape.segments)) {
      solution.parameter_direction.push_back(direction.durations(layout.duration_segment(k)));
      continue;
    }
    const auto at = std::find(free_parameters.begin(), free_parameters.end(), k);
    solution.parameter_direction.push_back(
        at == free_parameters.end() ? 0.0 : direction.globals(at - free_parameters.begin()));
  }
  const int used = layout.stored(shape.segments, true);  // the orbit may be part of a torus
  solution.parameters.assign(orbit.par.data(), orbit.par.data() + used);
  return solution;
}

namespace {

bool gives_label(const std::string& override_text) {
  return override_text.size() > 3 && find_constant(override_text.substr(0, 3)) == find_constant("IRS") &&
         (override_text[3] == '=' || override_text[3] == ' ');
}

/// The label of IRS; where there is none and IRS is not from the command line, the message says where it is from.
const LabelledSolution& find_start(const SolutionFile& file, const std::string& path, const RunSettings& settings,
                                   const RunRequest& request) {
  try {
    return find_solution(file.solutions, settings.start, path);
  } catch (const UserError& error) {
    if (std::any_of(request.overrides.begin(), request.overrides.end(), gives_label)) throw;
    throw UserError(fmt::format("{}; IRS = {}{} is from {}: give another one, as in IRS=LABEL", error.what(),
                                settings.start.type, settings.start.number,
                                constants_path(request.constants.value_or(request.name))));
  }
}

SelectedStart start_from_solution(const std::string& path, const RunSettings& settings, const HybridSystem& system,
                                  const std::vector<int>& free_parameters, const RunRequest& request) {
  const SolutionFile file = read_solution_file(path, settings.start);
  require_recorded_parameters(path, system);
  const LabelledSolution solution = in_layout(find_start(file, path, settings, request), system.layout());
  SelectedStart selected;
  selected.source = path;
  selected.from_solution = true;
  selected.label_start = false;
  const SolutionFamily& family = family_of(settings);
  family_of(solution.problem_type).check_restart(solution, settings, path);
  selected.start = orbit_from_solution(solution, family.restart_shape(settings, solution, path), free_parameters, path);
  selected.known_parameters = selected.start.orbit.par;
  selected.parameters_changed = apply_command_line(system, settings, selected.start.orbit.par);
  selected.branch = std::max(solution.branch, 1);
  selected.last_label = file.last_label;
  selected.problem_type = solution.problem_type;
  selected.label = solution.label;
  selected.type = solution.type;
  selected.kind = solution.kind;
  selected.types = basic_types(solution, settings.start.type);
  selected.warnings = file.warnings;
  return selected;
}

[[noreturn]] void refuse_solution_without_label(const std::string& path) {
  const SolutionFile file = read_solution_file(path);
  std::string labels;
  for (const LabelledSolution& s : file.solutions)
    labels += fmt::format("{}{}{}", labels.empty() ? "" : ", ", s.label,
                          type_name(s).empty() ? "" : fmt::format(" ({})", type_name(s)));
  throw UserError(
      fmt::format("-s {}: IRS is 0, so no label is chosen; add IRS=LABEL, or IRS=PD1 and the like; labels: {}", path,
                  labels.empty() ? "none" : labels));
}

}  // namespace

SelectedStart select_start(const RunRequest& request, const RunSettings& settings, const HybridSystem& system,
                           const std::vector<int>& free_parameters) {
  const StartLabel& label = settings.start;
  if (request.data && request.start)
    throw UserError("-d and -s are both given; a run starts from data (-d, IRS = 0) or from a label of a q-file (-s)");
  if (request.start) {
    const std::string path = solution_path(*request.start);
    if (label.from_data()) refuse_solution_without_label(path);
    return start_from_solution(path, settings, system, free_parameters, request);
  }
  const bool is_first_label = label.type.empty() && label.number <= 1;
  if (request.data || label.from_data()) {
    if (!is_first_label)
      throw UserError(
          fmt::format("IRS = {}{}, but starting data count as label 1; use IRS=0 or 1, or name a q-file with "
                      "-s",
                      label.type, label.number));
    return family_of(settings).start_from_data(data_path(request.data.value_or(request.name)), settings, system);
  }
  const std::string solutions = output_path('q', request.name);
  if (exists(solutions)) return start_from_solution(solutions, settings, system, free_parameters, request);
  if (is_first_label) return family_of(settings).start_from_data(data_path(request.name), settings, system);
  throw UserError(
      fmt::format("IRS = {}{}, but there is no q.{} to restart from; name a q-file with -s, or use IRS=0 "
                  "with starting data",
                  label.type, label.number, request.name));
}

}  // namespace tchat
