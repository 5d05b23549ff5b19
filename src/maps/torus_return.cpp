#include "maps/torus_return.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/solution_file_reader.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/orbit_flow.hpp"
#include "run/orbit_start.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double largest_defect = level::five_digits;
constexpr double largest_interpolation_error = 1e-3;

/// Angles between 0 and 2 pi.
VectorXd reduced(const InvariantCurve& curve, VectorXd x) {
  for (Index i = 0; i < x.size(); ++i)
    if (curve.is_angle(i)) x(i) -= full_turn * std::floor(x(i) / full_turn);
  return x;
}

Index triangle(Index n) { return n * (n + 1) / 2; }

/// The size of the highest quarter of the harmonics beside that of all.
double tail_of(const TrigonometricSeries& series) {
  const MatrixXd& c = series.coefficients();
  const double all = c.cwiseAbs().maxCoeff();
  const Index tail = std::max<Index>(1, c.cols() / 4);
  return all > 0.0 ? c.rightCols(tail).cwiseAbs().maxCoeff() / all : 0.0;
}

}  // namespace

/// Derivatives at equal phases.
struct TorusReturn::Nodes {
  MatrixXd first, second, times;
  double defect = 0.0, by_parameters = 0.0;

  Index count() const { return times.cols(); }
  void take(Index node, const Nodes& from, Index there) {
    first.col(node) = from.first.col(there);
    second.col(node) = from.second.col(there);
    times.col(node) = from.times.col(there);
  }
};

/// Every second of `count` nodes is one of `known`, where these are half as many.
TorusReturn::Nodes TorusReturn::nodes_at(int count, const Nodes& known, const ParameterVector& par, int section,
                                         const TorusSettings& settings) const {
  const HybridSystem& system = suspended_->system();
  const Index n = curve_.dimension();
  const Index all = system.dimension();
  Nodes nodes{MatrixXd(n * all, count), MatrixXd(settings.order > 1 ? n * triangle(all) : 0, count), MatrixXd(1, count),
              known.defect, known.by_parameters};
  for (int node = 0; node < count; ++node) {
    if (node % 2 == 0 && count == 2 * known.count()) {
      nodes.take(node, known, node / 2);
      continue;
    }
    const double phi = static_cast<double>(node) / count;
    const VectorXd start = suspended_->suspended(on_curve(phi), par);
    const Signature path = return_path(system, start, par, section, suspended_->field(), settings.flow);
    const QuadraticMap map = smooth_return(system, path, start, par, settings.order, settings.flow);
    const VectorXd miss = curve_.difference(map.value.head(n), curve_.at(phi + curve_.rotation()));
    nodes.defect = std::max(nodes.defect, miss.cwiseQuotient(scale_).cwiseAbs().maxCoeff());
    if (!(nodes.defect <= largest_defect))
      throw UserError(
          fmt::format("the return map does not take the invariant curve to itself: it misses by {:.1e} of "
                      "the curve's extent; give the parameters of the simulation that the points come from, "
                      "as 'PAR(k)=v', and its section",
                      nodes.defect));
    const MatrixXd of_state = map.first.topRows(n);
    nodes.first.col(node) = Eigen::Map<const VectorXd>(of_state.data(), of_state.size());
    nodes.times(0, node) = map.time;
    if (all > n) nodes.by_parameters = std::max(nodes.by_parameters, of_state.rightCols(all - n).cwiseAbs().maxCoeff());
    Index row = 0;
    for (Index i = 0; i < n && settings.order > 1; ++i)
      for (Index a = 0; a < all; ++a)
        for (Index b = a; b < all; ++b) nodes.second(row++, node) = map.second[static_cast<std::size_t>(i)](a, b);
  }
  return nodes;
}

TorusReturn::TorusReturn(std::shared_ptr<const SuspendedSystem> suspended, InvariantCurve curve,
                         CurveProjection projection, const ParameterVector& par, int section,
                         const TorusSettings& settings)
    : suspended_(std::move(suspended)),
      curve_(std::move(curve)),
      projection_(std::move(projection)),
      par_(par),
      scale_(curve_.extent()) {
  parameters_along_ = suspended_->suspended(curve_.at(0.0), par).tail(suspended_->system().dimension() - dimension());
  // As many as the curve has harmonics is a good guess.
  const int first_count = std::clamp(2 * (curve_.harmonics() / 2), 64, settings.most_nodes);
  Nodes nodes;
  for (int count = first_count; count <= settings.most_nodes; count *= 2) {
    nodes = nodes_at(count, nodes, par, section, settings);
    nodes_ = count;
    first_ = TrigonometricSeries::through(nodes.first);
    second_ = TrigonometricSeries::through(nodes.second);
    times_ = TrigonometricSeries::through(nodes.times);
    defect_ = nodes.defect;
    depends_ = nodes.by_parameters > level::converged;
    mean_time_ = nodes.times.mean();
    interpolation_error_ = std::max(tail_of(first_), settings.order > 1 ? tail_of(second_) : 0.0);
    if (interpolation_error_ <= settings.accuracy) return;
  }
  if (!(interpolation_error_ <= largest_interpolation_error))
    throw UserError(
        fmt::format("the derivative of the return map varies too much along the invariant curve: error "
                    "{:.1e} with {} harmonics; take a section that the torus crosses at larger angles",
                    interpolation_error_, first_.harmonics()));
}

VectorXd TorusReturn::on_curve(double phi) const { return reduced(curve_, curve_.at(phi)); }

TorusReturn::Deviation TorusReturn::deviation(const VectorXd& x, const ParameterVector& par) const {
  const Index n = x.size();
  const double phi = projection_.phase(x);
  VectorXd u = suspended_->suspended(x, par);
  u.head(n) = curve_.difference(x, curve_.at(phi));
  u.tail(u.size() - n) -= parameters_along_;
  return {phi, std::move(u)};
}

/// n x N, or its derivatives by phi.
MatrixXd TorusReturn::matrix(double phi, int derivative) const {
  const VectorXd entries = first_.derivative(phi, derivative);
  return Eigen::Map<const MatrixXd>(entries.data(), curve_.dimension(), entries.size() / curve_.dimension());
}

/// u^T S_i u for each component.
VectorXd TorusReturn::quadratic(double phi, const VectorXd& u, int derivative) const {
  VectorXd out = VectorXd::Zero(curve_.dimension());
  if (second_.rows() == 0) return out;
  const VectorXd entries = second_.derivative(phi, derivative);
  Index row = 0;
  for (Index i = 0; i < out.size(); ++i)
    for (Index a = 0; a < u.size(); ++a)
      for (Index b = a; b < u.size(); ++b) out(i) += (a == b ? 1.0 : 2.0) * entries(row++) * u(a) * u(b);
  return out;
}

VectorXd TorusReturn::image(const VectorXd& x, const ParameterVector& par) const {
  const Deviation at = deviation(x, par);
  return reduced(curve_,
                 curve_.at(at.phi + curve_.rotation()) + matrix(at.phi, 0) * at.u + 0.5 * quadratic(at.phi, at.u, 0));
}

/// With phi_x the gradient of the projection: (u'(phi + rho) + A' d) phi_x + A (Id - u' phi_x), and the second order.
MatrixXd TorusReturn::derivative(const VectorXd& x, const ParameterVector& par) const {
  const Index n = x.size();
  const Deviation at = deviation(x, par);
  const RowVectorXd phi_x = projection_.gradient(x, at.phi);
  const MatrixXd first = matrix(at.phi, 0);
  const VectorXd tangent = curve_.derivative(at.phi);
  VectorXd by_phi =
      curve_.derivative(at.phi + curve_.rotation()) + matrix(at.phi, 1) * at.u - first.leftCols(n) * tangent;
  MatrixXd jacobian = first.leftCols(n);
  if (second_.rows() > 0) {
    by_phi += 0.5 * quadratic(at.phi, at.u, 1);
    const VectorXd entries = second_(at.phi);
    MatrixXd linear = MatrixXd::Zero(n, at.u.size());  // S_i u
    Index row = 0;
    for (Index i = 0; i < n; ++i)
      for (Index a = 0; a < at.u.size(); ++a)
        for (Index b = a; b < at.u.size(); ++b, ++row) {
          linear(i, a) += entries(row) * at.u(b);
          if (b != a) linear(i, b) += entries(row) * at.u(a);
        }
    jacobian += linear.leftCols(n);
    by_phi -= linear.leftCols(n) * tangent;
  }
  return jacobian + by_phi * phi_x;
}

double TorusReturn::time(const VectorXd& x) const { return times_(projection_.phase(x))(0); }

double TorusReturn::distance(const VectorXd& x) const {
  const VectorXd d = curve_.difference(x, curve_.at(projection_.phase(x)));
  return d.cwiseQuotient(scale_).cwiseAbs().maxCoeff();
}

namespace {

/// Longest way from the section to P, as a share of the time of a return, on which x* is looked for; and at which it
/// counts as lying on the section.
constexpr double search_share = 0.1;
constexpr double on_section_share = 1e-3;

/// The trajectory through a point of the curve where it meets P.
struct Least {
  double phi = 0.0, time = 0.0;
  VectorXd x;
  double h = 0.0;
  double slope = 0.0;  // d h / d phi
};

class LeastDistance {
 public:
  LeastDistance(const HybridSystem& system, const TorusReturn& torus, int field, int wall)
      : system_(system), torus_(torus), field_(field), wall_(wall) {}

  /// h_D where P is met, as a parabola in time from u(phi) tells; nothing where P is far or h_D has a maximum there.
  std::optional<double> estimate(double phi) const {
    const VectorXd x = torus_.on_curve(phi);
    const Surface at = surface(x);
    if (!(at.a > 0.0) || std::abs(at.rate / at.a) > search_share * torus_.mean_time()) return std::nullopt;
    return at.h - 0.5 * at.rate * at.rate / at.a;
  }

  Least at(double phi) const {
    Least least{phi, 0.0, torus_.on_curve(phi), 0.0, 0.0};
    const VectorXd start = least.x;
    Eigen::MatrixXd flow = Eigen::MatrixXd::Identity(start.size(), start.size());
    for (int iteration = 0; iteration < 10; ++iteration) {
      const Surface now = surface(least.x);
      const double step = -now.rate / now.a;
      if (std::abs(step) <= level::rounding * torus_.mean_time()) break;
      least.time += step;
      FlowOptions options;
      const SegmentFlow moved = integrate_for(system_, field_, start, torus_.parameters(), least.time, options);
      if (moved.status == FlowStatus::failed) throw ComputationError(moved.message);
      least.x = moved.end_state;
      flow = moved.jacobian;
    }
    const EventAt event = event_at(system_, wall_, least.x.data(), torus_.parameters().data());
    least.h = event.h;
    least.slope = event.gradient.dot(flow * torus_.curve().derivative(phi));
    return least;
  }

 private:
  struct Surface {
    double h, rate, a;  // h_D, h_P, h_{P,x} f
  };
  Surface surface(const VectorXd& x) const {
    const EventAt at = event_at(system_, wall_, field_, x.data(), torus_.parameters().data());
    return {at.h, at.rate(), rate_gradient(system_, at, wall_, field_, x.data(), torus_.parameters().data()).dot(at.f)};
  }

  const HybridSystem& system_;
  const TorusReturn& torus_;
  int field_, wall_;
};

}  // namespace

TorusGrazing torus_grazing(const HybridSystem& system, const TorusReturn& torus, int field, int wall, int parameter,
                           const std::string& source) {
  const LeastDistance distance(system, torus, field, wall);
  const int samples = std::max(1000, 16 * torus.curve().harmonics());
  double guess = -1.0, least_h = std::numeric_limits<double>::infinity();
  for (int k = 0; k < samples; ++k) {
    const double phi = static_cast<double>(k) / samples;
    const std::optional<double> h = distance.estimate(phi);
    if (h && *h < least_h) least_h = *h, guess = phi;
  }
  const std::string wall_name = system.function_name(FunctionKind::event, wall);
  if (guess < 0.0)
    throw UserError(
        fmt::format("{}: nowhere near this section is event {} ({}) least along a trajectory; take the "
                    "section where it is least, or one through that point",
                    source, wall, wall_name));
  // The zero of the slope between the neighbours of the least sample.
  double low = guess - 1.0 / samples, high = guess + 1.0 / samples;
  Least at_low = distance.at(low), at_high = distance.at(high);
  if (!(at_low.slope < 0.0 && at_high.slope > 0.0))
    throw UserError(
        fmt::format("{}: the section does not pass through the point of the torus nearest to event {} ({}): the "
                    "least value seen near the section, {:.6g}, is at x = {}, at the end of where it can be "
                    "seen; put the section there",
                    source, wall, wall_name, least_h, state_text(distance.at(guess).x)));
  Least best = distance.at(guess);
  for (int iteration = 0; iteration < 60 && std::abs(high - low) > level::rounding; ++iteration) {
    // Regula falsi, with a bisection every third time.
    const double share = iteration % 3 == 2 ? 0.5 : at_low.slope / (at_low.slope - at_high.slope);
    best = distance.at(low + share * (high - low));
    if (best.slope == 0.0) break;
    (best.slope < 0.0 ? low : high) = best.phi;
    (best.slope < 0.0 ? at_low : at_high) = best;
  }
  if (std::abs(best.time) > on_section_share * torus.mean_time())
    throw UserError(
        fmt::format("{}: the section does not pass through the grazing point x* = {}, which is met {:.2g} {} "
                    "it; put the section there (a parameter of it, perhaps) and simulate again",
                    source, state_text(best.x), std::abs(best.time), best.time > 0.0 ? "after" : "before"));

  TorusGrazing grazing{phase_fraction(best.phi), best.time, best.x, torus.parameters()};
  const std::vector<int> active{parameter};
  for (int iteration = 0; iteration < 20; ++iteration) {
    double h = 0.0, hp = 0.0;
    VectorXd hx(grazing.x.size());
    system.first(FunctionKind::event, wall, grazing.x.data(), grazing.par.data(), active, &h, hx.data(), &hp);
    const double known = system.parameter_size(parameter, grazing.par(parameter - 1));
    const double scale = surface_scale(hx, grazing.x.data(), torus.extent());
    if (!(std::abs(hp) * known > level::negligible * scale))
      throw UserError(
          fmt::format("{}: event {} ({}) does not depend on {}, so that it cannot bring the wall to the torus; "
                      "sweep a parameter of the wall, or give the torus in contact",
                      source, wall, wall_name, system.parameter_name(parameter)));
    const double step = -h / hp;
    grazing.par(parameter - 1) += step;
    if (std::abs(step) <= std::numeric_limits<double>::epsilon() * known) break;
  }
  return grazing;
}

namespace {

Orbit orbit_of_label(const HybridSystem& system, const LabelledSolution& solution, const RunSettings& settings,
                     const std::string& source) {
  const auto n = static_cast<Index>(system.dimension());
  const Index m = segment_count(settings);
  const Index rows = solution.states.rows();
  if (rows % (n * m) != 0 || rows / (n * m) % 2 == 0 || rows / (n * m) < 3)
    throw UserError(
        fmt::format("{}: {} states at each time are no odd number of returns of {} segments of {} states; give the "
                    "constants of its run with -c",
                    source, rows, m, n));
  return orbit_from_solution(
             in_layout(solution, system.layout()),
             {system.dimension(), static_cast<int>(rows / n), solution.mesh_intervals, solution.collocation_points}, {},
             source)
      .orbit;
}

InvariantCurve curve_through(const MatrixXd& values, double rotation, const VectorXd& winding, const VectorXd& sizes) {
  MatrixXd periodic = values;
  for (Index l = 0; l < values.cols(); ++l)
    periodic.col(l) -= static_cast<double>(l) / static_cast<double>(values.cols()) * winding;
  return {phase_fraction(rotation), winding, TrigonometricSeries::through(periodic), sizes};
}

}  // namespace

TorusLabel::TorusLabel(const HybridSystem& system, const LabelledSolution& solution, const RunSettings& settings,
                       std::string source)
    : system_(system),
      settings_(settings),
      source_(std::move(source)),
      orbit_(orbit_of_label(system, solution, settings, source_)),
      torus_(system, settings.signature(), orbit_.shape.segments / segment_count(settings), {},
             torus_winding(system, settings.signature(), orbit_)) {
  const int m = torus_.segments_per_return();
  const TorusWinding& winding = torus_.winding();
  const VectorXd sizes = orbit_.states.cwiseAbs().rowwise().maxCoeff();
  for (int s = 0; s < m; ++s) {
    const IndexVector& index = settings_.segments[static_cast<std::size_t>(s)].index;
    if (std::any_of(sections_.begin(), sections_.end(), [&](const Section& of) { return of.event == index.event; }))
      continue;
    MatrixXd values(system_.dimension(), orbits());
    for (int i = 0; i < orbits(); ++i) values.col(i) = Eigen::Map<const VectorXd>(orbit_.end(i * m + s), values.rows());
    // Angles that do not go round, as a map that counts them modulo 2 pi has them.
    for (Index a = 0; a < values.rows(); ++a)
      if (winding.curve(a) == 0.0 && winding.returns(a) != 0.0)
        values.row(a).array() -= full_turn * std::floor(values.row(a).mean() / full_turn);
    sections_.push_back(
        {index.event, index.field, index.jump, curve_through(values, rotation(), winding.curve, sizes), values});
  }
}

/// From the mesh point before it, by the flow, the time corrected by Newton's method.
VectorXd TorusLabel::on_p(int wall, int field, const VectorXd& from, double duration) const {
  FlowOptions options;
  options.set(level::reference_flow);
  options.variational = false;
  VectorXd x = from;
  constexpr int most_corrections = 6;
  const double longest = orbit_.par.durations(orbit_.shape.segments).cwiseAbs().maxCoeff();
  for (int k = 0; k < most_corrections; ++k) {
    const SegmentFlow flow = integrate_for(system_, field, from, orbit_.par, duration, options);
    if (flow.status == FlowStatus::failed)
      throw ComputationError(fmt::format("{}: a point of P cannot be found: {}", source_, flow.message));
    x = flow.end_state;
    const EventAt at = event_at(system_, wall, field, x.data(), orbit_.par.data());
    const double step = -at.rate() / rate_gradient(system_, at, wall, field, x.data(), orbit_.par.data()).dot(at.f);
    duration += step;
    if (std::abs(step) <= level::rounding_of_sums * longest) break;
  }
  return x;
}

/// Those of one return, from its beginning on.
std::vector<VectorXd> TorusLabel::wall_contacts(int wall, int field, double phi) const {
  const Orbit x = return_at(torus_, orbit_, phase_fraction(phi));
  const int c = x.shape.collocation;
  std::vector<VectorXd> points;
  for (int s = 0; s < x.shape.segments; ++s) {
    if (settings_.segments[static_cast<std::size_t>(s)].index.field != field) continue;
    double before = 0.0;
    for (int k = 0; k < x.shape.nodes(); ++k) {
      const double rate = event_at(system_, wall, field, x.node(s, k), x.par.data()).rate();
      if (before < 0.0 && rate >= 0.0) {
        const int left = (k - 1) / c * c;
        const double share = before / (before - rate);
        const double tau = x.tau(k - 1) + share * (x.tau(k) - x.tau(k - 1));
        points.push_back(on_p(wall, field, Eigen::Map<const VectorXd>(x.node(s, left), x.shape.dimension),
                              (tau - x.tau(left)) * x.duration(s)));
      }
      before = rate;
    }
  }
  return points;
}

MatrixXd TorusLabel::points_on_p(int wall, int field, int count) const {
  MatrixXd points(system_.dimension(), count);
  Index known = 0;
  constexpr int returns_in_vain = 1000;
  for (int k = 0; known < count; ++k) {
    if (k >= returns_in_vain && known == 0)
      throw UserError(
          fmt::format("{}: nowhere on the torus is event {} ({}) least along a trajectory; name another wall with "
                      "--wall",
                      source_, wall, system_.function_name(FunctionKind::event, wall)));
    for (const VectorXd& x : wall_contacts(wall, field, k * rotation()))
      if (known < count) points.col(known++) = x;
  }
  return points;
}

}  // namespace tchat
