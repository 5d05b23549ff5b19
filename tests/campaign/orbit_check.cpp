/// Integrates stored orbits once more, with an integrator of its own, from the plain table of tchat/problem.h alone.
///
/// Standard input has one orbit after the other, as words:
///
///     LIBRARY  n m  count PAR(1..count)
///     for each of the m segments:  field event jump  duration  points  then for each point: t x_1 .. x_n
///     number of monitored functions, then for each: segment event
///
/// where t runs from 0 to 1; event 0 is an orbit without a section, jump 0 the identity. For each orbit one line of
/// JSON answers: `interval` is the largest difference between a stored point and the integration from the one before
/// it, divided by how far the flow between them takes neighbours apart (each state in units of its size), `connection`
/// that between the image of a segment's end and the next start, both relative to the largest state; `event` is h at
/// the ends of segments relative to its gradient and the largest state; `velocity` is h_x f there; `real` and
/// `imaginary` are the parts of the multipliers of the return map, from central differences over each interval and, at
/// events, from the saltation matrix; `least` is the local minimum of each monitored function that is nearest to zero,
/// relative as `event` is.
#include <dlfcn.h>

#include <Eigen/Core>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "tchat/problem.h"

// LAPACK: eigenvalues real + i imaginary of `a`, which is overwritten.
extern "C" void dgeev_(const char* left, const char* right, const int* n, double* a, const int* lda, double* real,
                       double* imaginary, double* vl, const int* ldvl, double* vr, const int* ldvr, double* work,
                       const int* length, int* info);

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using State = std::vector<double>;

constexpr double integration_error = 1e-13;  // of a step, relative
constexpr double difference = 1e-6;          // of central differences, relative: their error is about 1e-9
constexpr long most_steps = 200000;

struct Segment {
  int field = 1, event = 0, jump = 0;
  double duration = 0.0;
  std::vector<double> times;
  std::vector<VectorXd> points;
};

struct Orbit {
  const tchat_problem* problem = nullptr;
  std::vector<double> par;
  std::vector<Segment> segments;
  std::vector<std::pair<int, int>> monitored;  // segment, event
  double scale = 0.0;                          // the largest state
  VectorXd sizes;                              // of each state, at least 1e-6 of the largest
};

VectorXd value(const Orbit& orbit, int kind, int index, const VectorXd& x, Eigen::Index rows) {
  VectorXd out(rows);
  orbit.problem->value(orbit.problem->self, kind, index, x.data(), orbit.par.data(), out.data());
  return out;
}

VectorXd field_at(const Orbit& orbit, int field, const VectorXd& x) {
  return value(orbit, TCHAT_FIELD, field, x, x.size());
}

double event_at(const Orbit& orbit, int event, const VectorXd& x) { return value(orbit, TCHAT_EVENT, event, x, 1)(0); }

VectorXd image_of(const Orbit& orbit, int jump, const VectorXd& x) {
  return jump == 0 ? x : value(orbit, TCHAT_JUMP, jump, x, x.size());
}

/// The state after `duration` from x.
VectorXd flow(const Orbit& orbit, int field, const VectorXd& x, double duration) {
  namespace odeint = boost::numeric::odeint;
  if (duration == 0.0) return x;
  State state(x.data(), x.data() + x.size());
  const auto right_side = [&](const State& y, State& dy, double) {
    orbit.problem->value(orbit.problem->self, TCHAT_FIELD, field, y.data(), orbit.par.data(), dy.data());
  };
  auto stepper = odeint::make_controlled(integration_error * (orbit.scale + 1e-300), integration_error,
                                         odeint::runge_kutta_fehlberg78<State>());
  double t = 0.0;
  double step = duration;
  for (long steps = 0; std::abs(duration - t) > 1e-15 * std::abs(duration); ++steps) {
    if (steps > most_steps || !std::isfinite(step)) throw std::runtime_error("too many steps");
    if (std::abs(step) > std::abs(duration - t)) step = duration - t;
    if (step == 0.0 || t + step == t) throw std::runtime_error("steps become too small");
    stepper.try_step(right_side, state, t, step);
  }
  return Eigen::Map<const VectorXd>(state.data(), x.size());
}

/// The derivative of a function of the state by central differences.
template <typename Function>
MatrixXd derivative(const Orbit& orbit, const VectorXd& x, Eigen::Index rows, Function function) {
  MatrixXd result(rows, x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double step = difference * std::max(std::abs(x(i)), 1e-2 * orbit.scale);
    VectorXd forward = x, backward = x;
    forward(i) += step;
    backward(i) -= step;
    result.col(i) = (function(forward) - function(backward)) / (forward(i) - backward(i));
  }
  return result;
}

/// The largest difference of a state, relative to the largest state.
double distance(const Orbit& orbit, const VectorXd& x, const VectorXd& y) {
  return (x - y).lpNorm<Eigen::Infinity>() / orbit.scale;
}

struct Findings {
  double interval = 0.0, connection = 0.0, event = 0.0, shortest = std::numeric_limits<double>::infinity();
  std::vector<double> velocities, least, real, imaginary;  // the last two of the multipliers
  MatrixXd monodromy;
};

void check_segment(const Orbit& orbit, std::size_t s, Findings& found) {
  const Segment& segment = orbit.segments[s];
  MatrixXd& monodromy = found.monodromy;
  const Eigen::Index n = orbit.problem->dimension;
  for (std::size_t k = 0; k + 1 < segment.points.size(); ++k) {
    const double time = (segment.times[k + 1] - segment.times[k]) * segment.duration;
    const auto advance = [&](const VectorXd& x) { return flow(orbit, segment.field, x, time); };
    const MatrixXd growth = derivative(orbit, segment.points[k], n, advance);
    const MatrixXd relative = orbit.sizes.cwiseInverse().asDiagonal() * growth * orbit.sizes.asDiagonal();
    const double largest = std::max(1.0, relative.cwiseAbs().rowwise().sum().maxCoeff());
    const double error = distance(orbit, advance(segment.points[k]), segment.points[k + 1]);
    found.interval = std::max(found.interval, error / largest);
    monodromy = growth * monodromy;
  }
  const VectorXd& end = segment.points.back();
  if (segment.event > 0) {
    const VectorXd f = field_at(orbit, segment.field, end);
    const auto h = [&](const VectorXd& x) { return value(orbit, TCHAT_EVENT, segment.event, x, 1); };
    const MatrixXd gradient = derivative(orbit, end, 1, h);
    const double velocity = (gradient * f)(0);
    found.velocities.push_back(velocity);
    found.event = std::max(found.event, std::abs(h(end)(0)) / (gradient.lpNorm<Eigen::Infinity>() * orbit.scale));
    monodromy -= f * (gradient * monodromy) / velocity;
  }
  monodromy =
      derivative(orbit, end, n, [&](const VectorXd& x) { return image_of(orbit, segment.jump, x); }) * monodromy;
  const VectorXd& next = orbit.segments[(s + 1) % orbit.segments.size()].points.front();
  found.connection = std::max(found.connection, distance(orbit, image_of(orbit, segment.jump, end), next));
  found.shortest = std::min(found.shortest, segment.duration);
}

/// The local minimum nearest to zero, from ten values in each interval and a parabola through the three lowest ones.
double least_value(const Orbit& orbit, const Segment& segment, int event) {
  constexpr int parts = 10;
  std::vector<double> values;
  for (std::size_t k = 0; k + 1 < segment.points.size(); ++k) {
    const double time = (segment.times[k + 1] - segment.times[k]) * segment.duration;
    for (int part = 0; part < parts; ++part)
      values.push_back(event_at(orbit, event, flow(orbit, segment.field, segment.points[k], time * part / parts)));
  }
  values.push_back(event_at(orbit, event, segment.points.back()));
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k + 1 < values.size(); ++k) {
    if (values[k] > values[k - 1] || values[k] > values[k + 1]) continue;
    const double slope = (values[k + 1] - values[k - 1]) / 2;
    const double curvature = values[k + 1] - 2 * values[k] + values[k - 1];
    const double least = curvature > 0.0 ? values[k] - slope * slope / (2 * curvature) : values[k];
    if (std::abs(least) < std::abs(nearest)) nearest = least;
  }
  // A minimum may be at the start or the end, where segments are cut.
  for (const double v : {values.front(), values.back()})
    if (std::abs(v) < std::abs(nearest)) nearest = v;
  const MatrixXd gradient = derivative(orbit, segment.points.front(), 1,
                                       [&](const VectorXd& x) { return value(orbit, TCHAT_EVENT, event, x, 1); });
  return nearest / (gradient.lpNorm<Eigen::Infinity>() * orbit.scale);
}

/// None where the matrix is not finite.
void find_multipliers(Findings& found) {
  if (!found.monodromy.allFinite()) return;
  MatrixXd matrix = found.monodromy;
  const int n = static_cast<int>(matrix.rows());
  const int one = 1, length = 8 * n;
  int info = 0;
  double none = 0.0;
  std::vector<double> work(static_cast<std::size_t>(length));
  found.real.resize(static_cast<std::size_t>(n));
  found.imaginary.resize(static_cast<std::size_t>(n));
  dgeev_("N", "N", &n, matrix.data(), &n, found.real.data(), found.imaginary.data(), &none, &one, &none, &one,
         work.data(), &length, &info);
}

Findings check(const Orbit& orbit) {
  Findings found;
  found.monodromy = MatrixXd::Identity(orbit.problem->dimension, orbit.problem->dimension);
  for (std::size_t s = 0; s < orbit.segments.size(); ++s) check_segment(orbit, s, found);
  find_multipliers(found);
  for (const auto& [segment, event] : orbit.monitored)
    found.least.push_back(least_value(orbit, orbit.segments.at(static_cast<std::size_t>(segment - 1)), event));
  return found;
}

const tchat_problem* load(const std::string& library) {
  void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) throw std::runtime_error(dlerror());
  const auto entry = reinterpret_cast<tchat_problem_entry>(dlsym(handle, TCHAT_PROBLEM_ENTRY));
  if (entry == nullptr) throw std::runtime_error(library + " is no plugin");
  return entry();
}

bool read(std::istream& in, Orbit& orbit) {
  std::string library;
  if (!(in >> library)) return false;
  orbit.problem = load(library);
  Eigen::Index n = 0;
  std::size_t segments = 0, count = 0, monitored = 0;
  in >> n >> segments >> count;
  if (n != orbit.problem->dimension) throw std::runtime_error("another dimension than the plugin's");
  orbit.par.assign(std::max<std::size_t>(count, TCHAT_PAR_LENGTH), 0.0);
  for (std::size_t k = 0; k < count; ++k) in >> orbit.par[k];
  orbit.segments.resize(segments);
  orbit.sizes = VectorXd::Zero(n);
  for (Segment& segment : orbit.segments) {
    std::size_t points = 0;
    in >> segment.field >> segment.event >> segment.jump >> segment.duration >> points;
    segment.times.resize(points);
    segment.points.assign(points, VectorXd(n));
    for (std::size_t k = 0; k < points; ++k) {
      in >> segment.times[k];
      for (Eigen::Index i = 0; i < n; ++i) in >> segment.points[k](i);
      orbit.sizes = orbit.sizes.cwiseMax(segment.points[k].cwiseAbs());
    }
  }
  orbit.scale = orbit.sizes.maxCoeff();
  orbit.sizes = orbit.sizes.cwiseMax(1e-6 * orbit.scale);
  in >> monitored;
  orbit.monitored.resize(monitored);
  for (auto& [segment, event] : orbit.monitored) in >> segment >> event;
  if (!in) throw std::runtime_error("the description of an orbit ends too early");
  return true;
}

/// JSON has no infinities; Python reads this as one.
std::string text(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.12g", x);
  return std::isfinite(x) ? buffer : "1e999";
}

std::string list(const std::vector<double>& values) {
  std::string result;
  for (const double x : values) result += (result.empty() ? "" : ", ") + text(x);
  return "[" + result + "]";
}

void print(const Findings& found) {
  std::cout << "{\"interval\": " << text(found.interval) << ", \"connection\": " << text(found.connection)
            << ", \"event\": " << text(found.event) << ", \"shortest\": " << text(found.shortest)
            << ", \"velocity\": " << list(found.velocities) << ", \"least\": " << list(found.least)
            << ", \"real\": " << list(found.real) << ", \"imaginary\": " << list(found.imaginary) << "}" << std::endl;
}

}  // namespace

int main() {
  try {
    for (Orbit orbit; read(std::cin, orbit); orbit = {}) {
      try {
        print(check(orbit));
      } catch (const std::runtime_error& fault) {
        std::cout << "{\"fault\": \"" << fault.what() << "\"}" << std::endl;
      }
    }
  } catch (const std::exception& fault) {
    std::cerr << "orbit_check: " << fault.what() << "\n";
    return 2;
  }
  return 0;
}
