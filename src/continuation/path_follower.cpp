#include "continuation/path_follower.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/levels.hpp"
#include "linear/array_kernel.hpp"

namespace tchat {

namespace {

void copy(const PathPoint& point, const std::vector<int>& free, PathTrail::Mark& mark) {
  mark.place.states = point.orbit.states;
  mark.place.durations.resize(point.tangent.durations.size());
  mark.place.globals.resize(point.tangent.globals.size());
  for (int s = 0; s < point.orbit.shape.segments; ++s) mark.place.durations(s) = point.orbit.duration(s);
  for (std::size_t g = 0; g < free.size(); ++g)
    mark.place.globals(static_cast<Eigen::Index>(g)) = point.orbit.par(free[g] - 1);
  mark.tangent.states = point.tangent.states;
  mark.tangent.durations = point.tangent.durations;
  mark.tangent.globals = point.tangent.globals;
}

}  // namespace

PathTrail::PathTrail(const OrbitShape& shape, int global_count) : mesh_(index(shape.mesh_points())) {
  const OrbitVector zero(shape, global_count);
  for (const std::size_t k : {0U, 1U}) own_[k] = std::make_shared<Mark>(Mark{zero, zero});
}

/// Space is not shared.
PathTrail::PathTrail(const PathTrail& other) : marks_(other.marks_), count_(other.count_), mesh_(other.mesh_) {
  for (const std::size_t k : {0U, 1U})
    if (other.own_[k]) own_[k] = std::make_shared<Mark>(*other.own_[k]);
}

PathTrail& PathTrail::operator=(const PathTrail& other) {
  if (this == &other) return *this;
  marks_ = other.marks_;
  count_ = other.count_;
  mesh_ = other.mesh_;
  return *this;
}

std::shared_ptr<PathTrail::Mark> PathTrail::unused_mark() {
  const auto unused = [](const std::shared_ptr<Mark>& mark) { return mark == nullptr || mark.use_count() == 1; };
  const auto found = std::find_if(own_.begin(), own_.end(), unused);
  std::shared_ptr<Mark>& mark = found != own_.end() ? *found : own_.front();
  if (found == own_.end() || mark == nullptr) mark = std::make_shared<Mark>();
  return mark;
}

void PathTrail::clear() {
  marks_.fill(nullptr);
  count_ = 0;
}

void PathTrail::follow(const PathPoint& from, const std::vector<int>& free_parameters) {
  assert(this != &from.trail);
  mesh_ = from.orbit.mesh;
  marks_.fill(nullptr);
  count_ = from.trail.mesh_ == from.orbit.mesh ? std::min(from.trail.count_ + 1, most) : 1;
  std::copy_n(from.trail.marks_.begin(), count_ - 1, marks_.begin() + 1);
  const std::shared_ptr<Mark> newest = unused_mark();
  copy(from, free_parameters, *newest);
  marks_.front() = newest;
}

void PathTrail::add(const PathPoint& point, const std::vector<int>& free_parameters) {
  if (count_ > 0 && mesh_ != point.orbit.mesh) clear();
  mesh_ = point.orbit.mesh;
  count_ = std::min(count_ + 1, most);
  std::copy_backward(marks_.begin(), marks_.begin() + count_ - 1, marks_.begin() + count_);
  const std::shared_ptr<Mark> newest = unused_mark();
  copy(point, free_parameters, *newest);
  marks_.front() = newest;
}

void PathTrail::change_mesh(const std::vector<double>& mesh, const MeshTransfer& transfer) {
  for (int k = 0; k < count_; ++k) {
    const std::shared_ptr<Mark> moved = unused_mark();
    const Mark& old = mark(k);
    transfer(old.place.states, moved->place.states);
    transfer(old.tangent.states, moved->tangent.states);
    moved->place.durations = old.place.durations;
    moved->place.globals = old.place.globals;
    moved->tangent.durations = old.tangent.durations;
    moved->tangent.globals = old.tangent.globals;
    marks_[index(k)] = moved;
  }
  mesh_ = mesh;
}

namespace {

/// Factors older than this (relative change of the point since) are renewed before anything is read off them.
constexpr double current_enough = level::converged;
/// A prediction is brought so near by chord iterations that the first correction with a new matrix is below that.
constexpr double near_enough = 0.3 * current_enough;
constexpr int most_chords = 3;
/// Each is to make the next one smaller by this factor: expected of the first one, asked of the others.
constexpr double contraction = 0.1;

}  // namespace

PathFollower::PathFollower(const DefiningSystem& system, const OrbitShape& shape, WeightedNorm norm,
                           const NewtonSettings& settings, int principal, std::unique_ptr<OrbitCondition> condition,
                           BranchMonitors monitors)
    : system_(system),
      norm_(std::move(norm)),
      principal_(principal),
      monitors_(std::move(monitors.watched)),
      problem_(system, shape, std::move(condition), std::move(monitors.held), settings.threads),
      newton_(problem_, settings),
      predictor_(make_predictor(system)),
      settings_(settings),
      dx_(condensed().make_vector()),
      on_tangent_{shape, uniform_mesh(shape), dx_.states, ParameterVector(system.layout(), shape.segments)} {
  problem_.remember(unused_);
}

PathPoint PathFollower::make_point(Orbit orbit) const {
  PathTrail trail(orbit.shape, system_.free_count());
  return {std::move(orbit), condensed().make_vector(), condensed().make_vector(), unused_, std::move(trail)};
}

OrbitVector PathFollower::principal_row(const Orbit& x) const {
  OrbitVector row = condensed().make_vector();
  if (monitors_.has_gradient(principal_)) {
    monitors_.gradient(principal_, x, condensed().rule(), row);
  } else if (system_.layout().is_duration(principal_, system_.segments())) {
    row.durations(system_.layout().duration_segment(principal_)) = 1.0;
  } else {
    row.globals(principal_global()) = 1.0;
  }
  return row;
}

double PathFollower::principal_direction(const PathPoint& point) const {
  if (monitors_.has_gradient(principal_)) return dot(principal_row(point.orbit), point.tangent);
  if (const ParameterLayout layout = system_.layout(); layout.is_duration(principal_, system_.segments()))
    return point.tangent.durations(layout.duration_segment(principal_));
  return point.tangent.globals(principal_global());
}

Eigen::Index PathFollower::principal_global() const {
  const auto& free = system_.free_parameters();
  return std::find(free.begin(), free.end(), principal_) - free.begin();
}

double PathFollower::alignment(const PathPoint& point, const OrbitVector& direction) const {
  OrbitVector v = direction;
  OrbitVector dual = condensed().make_vector();
  normalise(point.orbit, v, dual);
  return dot(dual, point.tangent);
}

double PathFollower::cosine_at_ends(const PathPoint& from, const PathPoint& to) const {
  if (condensed().closing_rows_gave_way()) return 1.0;
  const auto at_ends = [&](const OrbitVector& row, const OrbitVector& v) {
    return BorderedProblem::at_ends(from.orbit.shape, row, v);
  };
  const double cosine = at_ends(from.dual, to.tangent) /
                        std::sqrt(std::abs(at_ends(from.dual, from.tangent) * at_ends(to.dual, to.tangent)));
  return std::isfinite(cosine) ? cosine : 1.0;
}

double PathFollower::distance(const Orbit& a, const Orbit& b) const {
  OrbitVector difference = condensed().make_vector();
  OrbitVector dual = condensed().make_vector();
  difference.states = a.states - b.states;
  for (int s = 0; s < a.shape.segments; ++s) difference.durations(s) = a.duration(s) - b.duration(s);
  const std::vector<int>& free = system_.free_parameters();
  for (std::size_t g = 0; g < free.size(); ++g)
    difference.globals(static_cast<Eigen::Index>(g)) = a.par(free[g] - 1) - b.par(free[g] - 1);
  return std::sqrt(std::abs(norm_.dual(a, condensed().rule(), free, difference, dual)));
}

bool PathFollower::linearize_at(const PathPoint& point) {
  problem_.recall(point.memory);
  problem_.set_reference(point.orbit);
  factors_known_ = linearize(point.orbit, point.dual);
  return factors_known_;
}

bool PathFollower::linearize(const Orbit& x, const OrbitVector& row) {
  factors_known_ = false;
  return problem_.linearize(x, row, newton_.linearized()) == Linearization::ready;
}

/// The dual of v, and v's length.
double PathFollower::measure(const Orbit& x, const OrbitVector& v, OrbitVector& dual) const {
  return std::sqrt(std::abs(norm_.dual(x, condensed().rule(), system_.free_parameters(), v, dual)));
}

void PathFollower::normalise(const Orbit& x, OrbitVector& tangent, OrbitVector& dual) const {
  const double length = measure(x, tangent, dual);
  if (!(length > 0.0)) return;
  tangent.scale(1.0 / length);
  dual.scale(1.0 / length);
}

/// From the current factors: the vector that every condition but the border annihilates, along which `row` grows. False
/// where it is not finite; the dual is of no use then.
bool PathFollower::find_tangent(const Orbit& x, const OrbitVector& row, OrbitVector& tangent, OrbitVector& dual) {
  const OrbitVector& along = problem_.tangent();
  const double length = measure(x, along, dual);
  if (!std::isfinite(length)) return false;
  const double factor = problem_.tangent_sign(row) / (length > 0.0 ? length : 1.0);
  tangent.states = factor * along.states;
  tangent.durations = factor * along.durations;
  tangent.globals = factor * along.globals;
  dual.scale(factor);
  return true;
}

/// Newton with this row, whose value changes by so much; then the tangent at the result, with factors that are not
/// older than this.
NewtonResult PathFollower::correct_and_orient(PathPoint& point, const OrbitVector& row, double change_along_row,
                                              double oldest) {
  assert(&row != &point.dual);
  factors_known_ = false;
  NewtonResult result = newton_.correct(point.orbit, row, change_along_row);
  if (!result.converged()) return result;
  const bool current = result.change_since_factorization <= oldest;
  if ((!current && !linearize(point.orbit, row)) || !find_tangent(point.orbit, row, point.tangent, point.dual))
    result.status = NewtonStatus::singular;
  else
    factors_known_ = true;
  problem_.remember(point.memory);
  monitors_.store(point.orbit, condensed().rule());
  return result;
}

void PathFollower::put_on_tangent(const PathPoint& from, double ds, Orbit& x) const {
  x.shape = from.orbit.shape;
  x.mesh = from.orbit.mesh;
  x.states.resize(from.orbit.states.rows(), from.orbit.states.cols());
  const std::array states{from.orbit.states.data(), from.tangent.states.data()};
  const std::array weights{1.0, ds};
  array_functions().combine(states.data(), weights.data(), 2, x.states.data(), x.states.size());
  x.par = from.orbit.par;
  advance_parameters(x, ds, from.tangent, system_.free_parameters());
}

/// What the equations of a step take from the point that it goes from, besides its row, the dual.
void PathFollower::begin_step(const PathPoint& from) {
  problem_.recall(from.memory);
  problem_.set_reference(from.orbit);
}

NewtonResult PathFollower::step(const PathPoint& from, double ds, PathPoint& to) {
  const Prediction prediction = predictor_->predict(from, ds, to.orbit);
  if (prediction.error > 0.0) {
    begin_step(from);
    double correction = polish(from, prediction.error, to.orbit);
    const NewtonResult result = step_from_plane(from, 0.0, to, current_enough);
    for (const NewtonIteration& iteration : newton_.history()) correction += iteration.larger();
    if (result.converged() && !predictor_->rejected(prediction, correction)) return result;
  }
  return step_along_tangent(from, ds, to);
}

NewtonResult PathFollower::step_along_tangent(const PathPoint& from, double ds, PathPoint& to) {
  put_on_tangent(from, ds, to.orbit);
  NewtonResult result = step_from_plane(from, 0.0, to, current_enough);
  result.from_tangent = true;
  const std::vector<NewtonIteration>& history = newton_.history();
  if (result.converged() && history.size() > 1 && history[0].larger() > 0.0)
    to.newton_constant = history[1].larger() / (history[0].larger() * history[0].larger());
  return result;
}

NewtonResult PathFollower::step_beside_branch_point(const PathPoint& from, double ds, PathPoint& to) {
  return step_from_plane(from, ahead(from, ds, to.orbit), to, 0.0);
}

/// How far the plane of a step of length ds is ahead of x.
double PathFollower::ahead(const PathPoint& from, double ds, const Orbit& x) const {
  return ds - dot_difference(from.dual, x, from.orbit, system_.free_parameters());
}

/// From a plane that the one of the step is so far `ahead` of, 0 where to.orbit was predicted, with factors for the
/// tangent that are not older than this.
NewtonResult PathFollower::step_from_plane(const PathPoint& from, double ahead, PathPoint& to, double oldest) {
  begin_step(from);
  to.newton_constant = from.newton_constant;
  const NewtonResult result = correct_and_orient(to, from.dual, ahead, oldest);
  if (result.converged()) predictor_->accepted(from, system_.free_parameters(), to);
  return result;
}

/// dx_ is set to the correction of x by the factors at hand, whatever the row was that they have, in the plane of a
/// step from `from` that x is in.
OrbitChange PathFollower::chord(const PathPoint& from, const Orbit& x) {
  problem_.evaluate(x, newton_.residual());
  problem_.solve_across(newton_.residual(), dx_);
  const OrbitVector& along = problem_.tangent();
  const auto [of_dx, of_tangent] = dot_both(from.dual, dx_, along);
  const double share = -of_dx / of_tangent;
  ArrayRange of_along{}, change{};
  array_functions().add_and_measure(share, along.states.data(), dx_.states.data(), dx_.states.size(), &of_along,
                                    &change);
  dx_.durations += share * along.durations;
  dx_.globals += share * along.globals;
  return change_by(problem_.system(), dx_, x, change, largest_state(x));
}

/// Brings a prediction nearer to the branch while that takes few chord iterations. How far it is moved.
double PathFollower::polish(const PathPoint& from, double expected, Orbit& x) {
  if (!factors_known_ || !problem_.allows_chord() || expected <= near_enough) return 0.0;
  double last = 0.0;
  double moved = 0.0;
  for (int k = 0; k < most_chords; ++k) {
    const double size = chord(from, x).larger();
    const double factor = k == 0 ? contraction : size / last;
    if (!(factor <= contraction) || !std::isfinite(size)) break;
    advance(x, 1.0, dx_, system_.free_parameters());
    moved += size;
    const double rest = size * factor;
    if (rest <= near_enough || rest * std::pow(factor, most_chords - 1 - k) > near_enough) break;
    last = size;
  }
  return moved;
}

void PathFollower::set_tangent(PathPoint& point, const OrbitVector& tangent) {
  point.tangent = tangent;
  normalise(point.orbit, point.tangent, point.dual);
  factors_known_ = false;
}

IterationRange PathFollower::iterations_along_tangent(const PathPoint& from, double ds, PathPoint& to, bool exactly) {
  constexpr double fast = 1e-2;         // a contraction of Newton's method that is far from none
  constexpr double of_measured = 1.5;   // error of the second correction, as a factor
  constexpr double of_estimated = 5.0;  // the same, and of what is made of the constant
  OrbitChange first = difference(to.orbit, from.orbit, ds, from.tangent);
  const double estimated = from.newton_constant * first.larger();
  const bool measured =
      problem_.allows_chord() && factors_known_ && (exactly || !(estimated > 0.0 && estimated < fast));
  OrbitChange second{0.0, estimated * first.larger()};
  if (measured) {
    begin_step(from);
    put_on_tangent(from, ds, on_tangent_);
    first = chord(from, on_tangent_);
    second = difference(to.orbit, on_tangent_, 1.0, dx_);
    to.newton_constant = second.larger() / (first.larger() * first.larger());
  }
  const double constant = second.larger() / (first.larger() * first.larger());
  if (!std::isfinite(constant) || !(constant > 0.0)) return {1, settings_.max_iterations};
  const double error = measured ? of_measured : of_estimated;
  return {iterations_of(first, {second.parameters / error, second.states / error}, constant / of_estimated),
          iterations_of(first, {second.parameters * error, second.states * error}, constant * of_estimated)};
}

/// Each iteration with a new matrix leaves C e^2 of an error e, a chord iteration 2 C e times what the errors were when
/// the matrix was new.
int PathFollower::iterations_of(const OrbitChange& first, const OrbitChange& second, double constant) const {
  const auto small = [&](const OrbitChange& change) {
    return change.parameters <= settings_.tolerance_parameters && change.states < settings_.tolerance_states;
  };
  if (small(first)) return 1;
  if (second.larger() >= first.larger()) return settings_.max_iterations;
  const int full = problem_.allows_chord() ? std::max(settings_.full_iterations, 1) : settings_.max_iterations;
  double error = second.larger();
  double at_matrix = full == 1 ? first.larger() : error;
  int iterations = 2;
  for (OrbitChange change = second; iterations < settings_.max_iterations && !small(change); ++iterations) {
    const double factor = std::min(iterations < full ? constant * error : 2.0 * constant * at_matrix, 1.0);
    error = std::max(error * factor, level::rounding);
    if (iterations < full) at_matrix = error;
    change = {error, error};
  }
  return iterations;
}

/// The change that leads from x + step v to `to`. Overwrites dx_.durations and dx_.globals, which may be those of v.
OrbitChange PathFollower::difference(const Orbit& to, const Orbit& x, double step, const OrbitVector& v) {
  ArrayRange change{}, states{};
  array_functions().measure_difference(to.states.data(), x.states.data(), step, v.states.data(), to.states.size(),
                                       &change, &states);
  for (int s = 0; s < x.shape.segments; ++s)
    dx_.durations(s) = to.duration(s) - (x.duration(s) + step * v.durations(s));
  const std::vector<int>& free = system_.free_parameters();
  for (std::size_t g = 0; g < free.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    dx_.globals(i) = to.par(free[g] - 1) - (x.par(free[g] - 1) + step * v.globals(i));
  }
  return change_by(problem_.system(), dx_, to, change, states.largest);
}

bool PathFollower::solves(const Orbit& x) {
  problem_.set_reference(x);
  problem_.evaluate(x, newton_.residual());
  return is_rounding(problem_.residual_size(newton_.residual()), x);
}

double PathFollower::relative_residual(const Orbit& x) {
  problem_.set_reference(x);
  problem_.evaluate(x, newton_.residual());
  return problem_.residual_size(newton_.residual()) / (1.0 + largest_state(x));
}

/// The largest relative change along the tangent.
double PathFollower::relative_length(const PathPoint& point) const {
  const Orbit& x = point.orbit;
  const DefiningSystem& system = problem_.system();
  const OrbitVector& t = point.tangent;
  const double states = array_functions().range(t.states.data(), t.states.size()).largest / (1.0 + largest_state(x));
  double largest = states;
  const double time = time_size(system, x);
  for (int s = 0; s < x.shape.segments; ++s)
    largest = std::max(largest, std::abs(t.durations(s)) / (time + std::abs(x.duration(s))));
  for (int g = 0; g < system.free_count(); ++g)
    largest = std::max(largest, std::abs(t.globals(g)) / parameter_size(system, x, g));
  return largest;
}

double PathFollower::principal_rate_size(const PathPoint& point) const {
  const double value = std::abs(point.orbit.par(principal_ - 1));
  const HybridSystem& system = problem_.system().system();
  const bool is_parameter = principal_ <= system.parameters();  // else a duration or a monitor
  return relative_length(point) * (is_parameter || value == 0.0 ? system.parameter_size(principal_, value) : value);
}

double PathFollower::principal_share(const PathPoint& point) const {
  const double value = std::abs(point.orbit.par(principal_ - 1));
  const double size = value > 0.0 ? value : problem_.system().system().parameter_size(principal_, value);
  return std::abs(principal_direction(point)) / size / relative_length(point);
}

/// The first component of the tangent that is not negligible decides: the principal parameter's when it varies.
void PathFollower::orient(PathPoint& point) const {
  constexpr double negligible = level::double_zero;
  const Orbit& x = point.orbit;
  const DefiningSystem& system = problem_.system();
  const double length = relative_length(point);
  double direction = principal_direction(point);
  bool decides = principal_share(point) >= negligible;
  for (int g = 0; !decides && g < system.free_count(); ++g) {
    direction = point.tangent.globals(g);
    decides = std::abs(direction) >= negligible * length * parameter_size(system, x, g);
  }
  for (int s = 0; !decides && s < x.shape.segments; ++s) {
    direction = point.tangent.durations(s);
    decides = std::abs(direction) >= negligible * length * (time_size(system, x) + std::abs(x.duration(s)));
  }
  if (direction < 0.0) reverse(point);
}

NewtonResult PathFollower::start_at_fixed_parameter(PathPoint& point) {
  point.trail.clear();
  const OrbitVector row = principal_row(point.orbit);
  problem_.recall(point.memory);
  problem_.set_reference(point.orbit);
  NewtonResult result = correct_and_orient(point, row, 0.0, current_enough);
  if (result.converged()) orient(point);
  return result;
}

NewtonResult PathFollower::start_along(PathPoint& point, const OrbitVector& direction) {
  point.trail.clear();
  point.tangent = direction;
  normalise(point.orbit, point.tangent, point.dual);
  const OrbitVector row = point.dual;
  problem_.recall(point.memory);
  problem_.set_reference(point.orbit);
  return correct_and_orient(point, row, 0.0, current_enough);
}

NewtonResult PathFollower::start_by_minimum_norm(PathPoint& point) {
  point.trail.clear();
  // Any border that is not orthogonal to the null vector will do to find it the first time.
  OrbitVector row = condensed().make_vector();
  for (Eigen::Index i = 0; i < row.states.size(); ++i)
    row.states.data()[i] = std::cos(1.0 + 0.37 * static_cast<double>(i));
  row.durations.setOnes();
  row.globals.setOnes();
  problem_.recall(point.memory);
  problem_.set_reference(point.orbit);
  NewtonResult result;
  result.status = NewtonStatus::singular;
  if (!linearize(point.orbit, row) || !find_tangent(point.orbit, row, point.tangent, point.dual)) return result;
  // A few Gauss-Newton steps with a fresh null vector each, then the ordinary iteration across the last one.
  for (int iteration = 0; iteration < settings_.max_iterations; ++iteration) {
    row = point.dual;
    problem_.set_reference(point.orbit);
    result = correct_and_orient(point, row, 0.0, current_enough);
    if (result.converged() || result.status == NewtonStatus::not_finite) break;
    if (!linearize(point.orbit, row) || !find_tangent(point.orbit, row, point.tangent, point.dual)) return result;
  }
  if (result.converged()) orient(point);
  return result;
}

void PathFollower::change_mesh(PathPoint& point, const OrbitShape& shape, const std::vector<double>& mesh) {
  transfer_.set(point.orbit.shape, point.orbit.mesh, shape, mesh, condensed().rule());
  for (Eigen::MatrixXd* states : {&point.orbit.states, &point.tangent.states}) {
    transfer_(*states, moved_);
    states->swap(moved_);
  }
  if (point.trail.mesh() == point.orbit.mesh) point.trail.change_mesh(mesh, transfer_);
  point.orbit.shape = shape;
  point.orbit.mesh = mesh;
  normalise(point.orbit, point.tangent, point.dual);
}

void PathFollower::reverse(PathPoint& point) const {
  point.tangent.scale(-1.0);
  point.dual.scale(-1.0);
}

CondensedSystem::Singularity PathFollower::singularity(const PathPoint& point) {
  factors_known_ = false;
  problem_.recall(point.memory);
  problem_.set_reference(point.orbit);
  if (problem_.linearize(point.orbit, point.dual, newton_.linearized()) == Linearization::not_finite) return {1.0, {}};
  return problem_.singularity(point.dual);
}

}  // namespace tchat
