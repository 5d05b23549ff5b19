#include "maps/grazing_orbit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/orbit_flow.hpp"
#include "orbit/ring_system.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One turn from x*: where it ends, and the derivatives of that by x*, the last duration and the parameters.
struct Turn {
  std::string message;  // why there is none
  VectorXd end, f;      // f there
  MatrixXd by_state, by_parameters;
  std::vector<double> durations;
};

Turn failed(const std::string& message) {
  Turn turn;
  turn.message = message;
  return turn;
}

class TurnMap {
 public:
  TurnMap(const HybridSystem& system, const ContactTurn& turn)
      : system_(system),
        first_jump_(turn.section_jump),
        leading_(turn.segments.begin(), turn.segments.end() - 1),
        field_(turn.segments.back().field) {
    options_.active.resize(static_cast<std::size_t>(system.parameters()));
    std::iota(options_.active.begin(), options_.active.end(), 1);
    options_.max_duration = 10.0 * std::accumulate(turn.durations.begin(), turn.durations.end(), 0.0);
  }

  /// By Adams' formulas, else with less accuracy, else for stiff problems: what works is kept.
  Turn at(const VectorXd& x, double last, const VectorXd& par) {
    Turn turn = once(x, last, par);
    while (!turn.message.empty() && relax()) turn = once(x, last, par);
    return turn;
  }

 private:
  bool relax() {
    if (options_.method == IntegrationMethod::bdf) return false;
    if (options_.relative_tolerance < level::relaxed_flow.relative) {
      options_.set(level::relaxed_flow);
      return true;
    }
    options_.method = IntegrationMethod::bdf;
    options_.set(level::stiff_flow);
    options_.max_steps = 1000000;
    return true;
  }

  Turn once(const VectorXd& x, double last, const VectorXd& par) const {
    Turn turn;
    turn.end.resize(x.size());
    turn.by_state.resize(x.size(), x.size());
    turn.by_parameters.resize(x.size(), system_.parameters());
    system_.first(FunctionKind::jump, first_jump_, x.data(), par.data(), options_.active, turn.end.data(),
                  turn.by_state.data(), turn.by_parameters.data());
    if (!turn.end.allFinite()) return failed("the jump at the contact cannot be evaluated");
    if (!leading_.empty()) {
      const ReturnMap map = return_map(system_, leading_, turn.end, par, options_);
      if (!map.ok) return failed(map.message);
      turn.end = map.end;
      turn.by_parameters = (map.derivative * turn.by_parameters + map.parameter_derivative).eval();
      turn.by_state = (map.derivative * turn.by_state).eval();
      for (const MapSegment& segment : map.segments) turn.durations.push_back(segment.duration);
    }
    const SegmentFlow flow = integrate_for(system_, field_, turn.end, par, last, options_);
    if (flow.status == FlowStatus::failed) return failed(flow.message);
    turn.end = flow.end_state;
    turn.by_state = (flow.jacobian * turn.by_state).eval();
    turn.by_parameters = (flow.jacobian * turn.by_parameters + flow.parameter_derivative).eval();
    turn.durations.push_back(last);
    turn.f.resize(x.size());
    system_.value(FunctionKind::field, field_, turn.end.data(), par.data(), turn.f.data());
    return turn;
  }

  const HybridSystem& system_;
  int first_jump_;
  Signature leading_;
  int field_;
  FlowOptions options_;
};

Eigen::VectorXcd largest_first(const MatrixXd& matrix) {
  Eigen::VectorXcd values = eigenvalues(matrix);
  std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) {
    const double difference = std::abs(a) - std::abs(b);
    return difference != 0.0 ? difference > 0.0 : a.imag() > b.imag();
  });
  return values;
}

std::vector<int> all_parameters(const HybridSystem& system) {
  std::vector<int> all(static_cast<std::size_t>(system.parameters()));
  std::iota(all.begin(), all.end(), 1);
  return all;
}

/// Newton's method on x*, the last duration and one parameter.
class ContactSearch {
 public:
  ContactSearch(const HybridSystem& system, const ContactTurn& start, const std::string& source)
      : system_(system),
        start_(start),
        source_(source),
        map_(system, start),
        parameters_(all_parameters(system)),
        surface_(system.dimension(), system.parameters()),
        x_(start.x),
        par_(start.par),
        sizes_(sizes_at(system, start.contact.field, start.x, start.par).unaryExpr(&size_for_tolerance)),
        last_(start.durations.back()) {}

  GrazingOrbit run() {
    converge();
    x_ = corrected_contact(system_, start_.contact.field, start_.contact.event, x_, par_, source_);
    GrazingOrbit orbit{grazing_point(system_, start_.contact.field, start_.contact.event, start_.contact.jump, x_, par_,
                                     source_, start_.aftermath),
                       start_.segments,
                       turn_.durations,
                       start_.parameter,
                       {},
                       {},
                       {},
                       par_(free()) - start_.par(free())};
    const GrazingPoint& at = orbit.point;
    const auto onto_p = [&](const MatrixXd& v) -> MatrixXd { return project_along_flow(at.f, at.section_gradient, v); };
    orbit.A = onto_p(turn_.by_state);
    orbit.by_parameters = onto_p(turn_.by_parameters) - at.f * (surface_.rate_p.transpose() / at.a);
    orbit.multipliers = largest_first(orbit.A);
    return orbit;
  }

 private:
  Eigen::Index free() const { return start_.parameter - 1; }

  void converge() {
    constexpr int most_iterations = 20;
    constexpr double converged = level::rounding_of_sums;
    constexpr double good_enough = level::orbit;  // where errors of the integration end Newton's method
    double before = INFINITY;
    for (int iteration = 0;; ++iteration) {
      evaluate();
      if (before <= converged) return;
      const VectorXd step = newton_step();
      const double size = size_of(step);
      const bool stalls = size >= 0.5 * before;
      if (stalls && before <= good_enough) return;
      if (!std::isfinite(size) || iteration == most_iterations || (stalls && iteration > 5))
        throw ComputationError(fmt::format(
            "{}: Newton's method does not find the orbit in contact by forward integration (last steps {:.1e}, "
            "{:.1e}); compute the label with smaller EPSS, EPSU and more intervals (NTST)",
            source_, before, size));
      x_ += step.head(x_.size());
      last_ += step(x_.size());
      par_(free()) += step(x_.size() + 1);
      before = size;
    }
  }

  /// Each state in units of its size at the contact, the duration of the period, the parameter of its own size.
  double size_of(const VectorXd& step) const {
    const Eigen::Index n = x_.size();
    const double period = std::accumulate(start_.durations.begin(), start_.durations.end(), 0.0);
    const double parameter = system_.parameter_size(start_.parameter, par_(free()));
    return std::max({step.head(n).cwiseAbs().cwiseQuotient(sizes_.cwiseMax(x_.cwiseAbs())).maxCoeff(),
                     std::abs(step(n)) / period, std::abs(step(n + 1)) / parameter});
  }

  void evaluate() {
    turn_ = map_.at(x_, last_, par_);
    if (!turn_.message.empty())
      throw ComputationError(
          fmt::format("{}: the orbit cannot be followed by forward integration: {}", source_, turn_.message));
    surface_.evaluate(system_, start_.contact, x_.data(), par_.data(), parameters_);
  }

  VectorXd newton_step() const {
    const Eigen::Index n = x_.size(), k = free();
    MatrixXd matrix = MatrixXd::Zero(n + 2, n + 2);
    matrix.topLeftCorner(n, n) = turn_.by_state - MatrixXd::Identity(n, n);
    matrix.block(0, n, n, 1) = turn_.f;
    matrix.block(0, n + 1, n, 1) = turn_.by_parameters.col(k);
    matrix.block(n, 0, 1, n) = surface_.hx.transpose();
    matrix(n, n + 1) = surface_.hp(k);
    matrix.block(n + 1, 0, 1, n) = surface_.rate_x.transpose();
    matrix(n + 1, n + 1) = surface_.rate_p(k);
    VectorXd right(n + 2);
    right << x_ - turn_.end, -surface_.h, -surface_.rate;
    return solve_with_complete_pivoting(matrix, right);
  }

  const HybridSystem& system_;
  const ContactTurn& start_;
  const std::string& source_;
  TurnMap map_;
  std::vector<int> parameters_;
  SurfaceRate surface_;
  VectorXd x_;
  ParameterVector par_;
  VectorXd sizes_;  // of the states, where the turn begins
  double last_;     // duration of the last segment
  Turn turn_;
};

}  // namespace

double GrazingOrbit::period() const { return std::accumulate(durations.begin(), durations.end(), 0.0); }

GrazingOrbit find_grazing_orbit(const HybridSystem& system, const ContactTurn& turn, const std::string& source) {
  return ContactSearch(system, turn, source).run();
}

namespace {

using Kind = GrazingVerdict::Kind;

constexpr double xi_rounding = level::orbit;  // of shares in xi_n, of determinants
std::string number(double value) { return fmt::format("{:.6g}", value); }

std::string text(std::complex<double> value) {
  if (value.imag() == 0.0) return number(value.real());
  return fmt::format("{} {} {} i", number(value.real()), value.imag() < 0.0 ? '-' : '+',
                     number(std::abs(value.imag())));
}

double determinant(const MatrixXd& matrix) {
  const PivotedLu lu(matrix);
  return lu.pivots().prod() * lu.parity();
}

double largest_modulus(const MatrixXd& matrix) { return eigenvalues(matrix).cwiseAbs().maxCoeff(); }

GrazingVerdict unstable(std::complex<double> largest) {
  return {Kind::unstable, 0,
          fmt::format("the orbit is unstable without contact: A has the eigenvalue {}, of modulus {}", text(largest),
                      number(std::abs(largest)))};
}

/// (3.11-3.12): fixed points of both linear maps, and which side of contact they lie on.
GrazingVerdict by_linear_map(const GrazingOrbit& orbit, const DiscontinuityMap& map) {
  const Eigen::Index n = orbit.A.rows();
  const MatrixXd unit = MatrixXd::Identity(n, n);
  const MatrixXd with_contact = orbit.A * linear_contact(map);
  GrazingVerdict verdict;
  verdict.is_linear = true;
  verdict.linear = determinant(unit - with_contact) * determinant(unit - orbit.A);
  const double largest = largest_modulus(with_contact);
  const std::string product = fmt::format("det(Id - A L) det(Id - A) = {:.10g}", verdict.linear);
  if (std::abs(verdict.linear) <= xi_rounding) {
    verdict.reason = fmt::format("there is no square root, and {} is zero to rounding (3.11)", product);
  } else if (verdict.linear < 0.0) {
    verdict.kind = Kind::discontinuous;
    verdict.reason = fmt::format(
        "there is no square root, and {} < 0 (3.11): the impacting orbit and the one without contact live on the same "
        "side of grazing, and vanish together",
        product);
  } else if (largest > 1.0 + level::on_circle) {
    verdict.reason = fmt::format(
        "there is no square root and {} > 0 (3.12), but the impacting orbit is born unstable: A L has an eigenvalue of "
        "modulus {}",
        product, number(largest));
  } else {
    verdict.kind = Kind::continuous;
    verdict.reason = fmt::format(
        "there is no square root, and {} > 0 (3.12): beyond grazing a stable impacting orbit, with eigenvalues of "
        "modulus up to {}, takes the place of the one without contact",
        product, number(largest));
  }
  return verdict;
}

/// The part of each eigenvalue of A in xi_n = sum of share_k lambda_k^n.
struct Share {
  std::complex<double> eigenvalue, share;
};

std::vector<Share> shares(const GrazingOrbit& orbit) {
  const GrazingPoint& at = orbit.point;
  const Eigen::VectorXcd& values = orbit.multipliers;
  std::vector<Share> result;
  for (const std::complex<double> value : values) {
    if (std::abs(value) <= xi_rounding * std::abs(values(0))) continue;  // zeros, which may be defective: no share
    // By right and left eigenvectors: simple eigenvalues only.
    const Eigen::VectorXcd right = eigenvector(orbit.A, value);
    const Eigen::VectorXcd left = eigenvector(orbit.A.transpose(), value);
    const std::complex<double> size = left.transpose() * right;
    const std::complex<double> seen = at.event_gradient.cast<std::complex<double>>().transpose() * right;
    const std::complex<double> excited = left.transpose() * at.impact.beta.cast<std::complex<double>>();
    result.push_back({value, -seen * excited / size});
  }
  return result;
}

std::string undecided(const std::vector<Share>& parts, int n) {
  const Share& first = parts.front();
  const double size = std::abs(first.eigenvalue);
  if (first.eigenvalue.imag() != 0.0)
    return fmt::format("the dominant eigenvalue {} of A is complex, so that some xi_n with n > {} is negative",
                       text(first.eigenvalue), n);
  if (first.eigenvalue.real() < 0.0)
    return fmt::format("the dominant eigenvalue {} of A is negative, so that xi_n changes its sign at some n > {}",
                       text(first.eigenvalue), n);
  const double share = first.share.real();
  double others = 0.0;
  for (std::size_t k = 1; k < parts.size(); ++k)
    others += std::abs(parts[k].share) * std::pow(std::abs(parts[k].eigenvalue) / size, n);
  if (!std::isfinite(share) || !std::isfinite(others)) return "A has eigenvalues that are not simple";
  if (share < 0.0)
    return fmt::format("the dominant eigenvalue {} of A has a negative share in xi_n, which is negative at some n > {}",
                       text(first.eigenvalue), n);
  if (share <= others)
    return fmt::format("the dominant eigenvalue {} of A does not outweigh the others yet at n = {}",
                       text(first.eigenvalue), n);
  return "";
}

GrazingVerdict by_returns(const GrazingOrbit& orbit, const std::vector<ImpactReturn>& xi) {
  const int count = static_cast<int>(xi.size());
  for (int n = 1; n <= count; ++n) {
    const ImpactReturn& at = xi[static_cast<std::size_t>(n - 1)];
    if (at.is_zero())
      return {Kind::unknown, n,
              fmt::format("xi_{} = {:.2g} is zero to rounding (codimension two), and no earlier one is negative", n,
                          at.xi)};
    if (at.xi < 0.0)
      return {Kind::discontinuous, n,
              fmt::format("xi_{} = {:.10g} < 0{}: after an impact of low velocity the next one comes {} later, and its "
                          "stretching by the square root repeats before the orbit can recover",
                          n, at.xi, n == 1 ? "" : ", the first negative one",
                          n == 1 ? "one period" : fmt::format("{} periods", n))};
  }
  const std::vector<Share> parts = shares(orbit);
  const std::string doubt = undecided(parts, count);
  if (!doubt.empty())
    return {Kind::unknown, 0,
            fmt::format("xi_1 ... xi_{} are positive, but {}; more of them: --xi {}", count, doubt, 4 * count)};
  return {Kind::continuous, 0,
          fmt::format("xi_1 ... xi_{} are positive, and so are all others: the dominant eigenvalue {} of A is real and "
                      "positive, with the share {} in xi_n; no new impact follows one of low velocity before the orbit "
                      "has recovered",
                      count, text(parts.front().eigenvalue), number(parts.front().share.real()))};
}

}  // namespace

std::string GrazingVerdict::words() const {
  switch (kind) {
    case Kind::continuous:
      return "continuous";
    case Kind::discontinuous:
      return n > 0 ? fmt::format("discontinuous, n = {}", n) : "discontinuous";
    case Kind::unstable:
      return "none";
    default:
      return "cannot tell";
  }
}

MatrixXd linear_contact(const DiscontinuityMap& map) {
  return map.expansion().dx - map.expansion().yy * map.point().event_gradient.transpose();
}

GrazingVerdict grazing_verdict(const GrazingOrbit& orbit, const DiscontinuityMap& map,
                               const std::vector<ImpactReturn>& xi) {
  const std::complex<double> largest = orbit.multipliers(0);
  if (std::abs(largest) > 1.0 + level::on_circle) return unstable(largest);
  if (std::abs(largest) >= 1.0 - level::on_circle)
    return {Kind::unknown, 0,
            fmt::format("the orbit bifurcates without contact as well: A has the eigenvalue {}, of modulus 1",
                        text(largest))};
  return orbit.point.has_square_root() ? by_returns(orbit, xi) : by_linear_map(orbit, map);
}

namespace {

constexpr double none = level::orbit;  // of the sizes of what is summed: zero to rounding

/// What both kinds of map need: A, b, h_x, h_p of one parameter.
struct LinearReturn {
  MatrixXd A;
  VectorXd b;
  VectorXd hx;
  double hp;
};

LinearReturn return_of(const HybridSystem& system, const GrazingOrbit& orbit) {
  const GrazingPoint& at = orbit.point;
  SurfaceRate surface(system.dimension(), 1);
  surface.evaluate(system, {at.field, at.event, at.jump}, at.x.data(), at.par.data(), {orbit.parameter});
  return {orbit.A, orbit.by_parameters.col(orbit.parameter - 1), at.event_gradient, surface.hp(0)};
}

int sign(double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

BornOrbit with_square_root(const GrazingPoint& at, const LinearReturn& smooth, double clearance, int k) {
  const Eigen::Index n = at.x.size();
  MatrixXd power = MatrixXd::Identity(n, n);
  std::vector<VectorXd> turned{at.impact.beta};  // A^j beta
  for (int j = 1; j <= k; ++j) {
    power = smooth.A * power;
    turned.push_back(smooth.A * turned.back());
  }
  const MatrixXd repeated = MatrixXd::Identity(n, n) - power;
  const auto sum = [&](int j) { return -smooth.hx.dot(solve(repeated, turned[static_cast<std::size_t>(j)]).col(0)); };
  const double stretch = std::sqrt(2.0 / at.a);
  const double last = sum(k);
  BornOrbit born{k};
  if (!std::isfinite(last) || std::abs(last) <= none * smooth.hx.norm() * at.impact.beta.norm()) return born;
  const double slope = -clearance / (stretch * last);  // y = slope delta
  born.side = sign(slope);
  born.beyond_contact = last > 0.0;
  born.rate = std::abs(slope);
  const double xi = -smooth.hx.dot(turned.back());
  if (born.rate > 0.0) born.multiplier = -stretch * xi / (2.0 * born.rate);
  for (int j = 1; j < k && born.hits_at == 0; ++j)
    if (sum(j) <= last) born.hits_at = j;
  return born;
}

/// With contact d1 = L d0 + G delta.
BornOrbit without_square_root(const GrazingOrbit& orbit, const DiscontinuityMap& map, const LinearReturn& smooth,
                              double clearance, int k) {
  const Eigen::Index n = orbit.A.rows();
  const MatrixXd L = linear_contact(map);
  const VectorXd G = map.expansion().dp.col(orbit.parameter - 1) - map.expansion().yy * smooth.hp;
  std::vector<MatrixXd> powers{MatrixXd::Identity(n, n)};
  std::vector<VectorXd> sums{VectorXd::Zero(n)};
  for (int j = 1; j <= k; ++j) {
    sums.push_back(smooth.A * sums.back() + smooth.b);
    powers.push_back(smooth.A * powers.back());
  }
  const MatrixXd turn = powers.back() * L;
  const VectorXd right = powers.back() * G + sums.back();
  const VectorXd d0 = solve(MatrixXd::Identity(n, n) - turn, right);
  const double slope = -(smooth.hx.dot(d0) + smooth.hp);  // y^2 = slope delta
  BornOrbit born{k};
  if (!std::isfinite(slope) || std::abs(slope) <= none * std::abs(clearance)) return born;
  born.side = sign(slope);
  born.beyond_contact = slope * clearance < 0.0;
  born.rate = std::abs(slope);
  const Eigen::VectorXcd values = eigenvalues(turn);
  Eigen::Index largest = 0;
  values.cwiseAbs().maxCoeff(&largest);
  born.multiplier = values(largest);
  const VectorXd d1 = L * d0 + G;
  for (int j = 1; j < k && born.hits_at == 0; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double h = smooth.hx.dot(powers[i] * d1 + sums[i]) + smooth.hp;
    if (h * born.side <= 0.0) born.hits_at = j;
  }
  return born;
}

}  // namespace

BornOrbits born_orbits(const HybridSystem& system, const GrazingOrbit& orbit, const DiscontinuityMap& map, int most) {
  const LinearReturn smooth = return_of(system, orbit);
  const Eigen::Index n = orbit.A.rows();
  BornOrbits result;
  result.has_square_root = orbit.point.has_square_root();
  const VectorXd moved = solve(MatrixXd::Identity(n, n) - smooth.A, smooth.b).col(0);
  result.clearance = smooth.hx.dot(moved) + smooth.hp;
  result.clearance_terms = smooth.hx.cwiseAbs().dot(moved.cwiseAbs()) + std::abs(smooth.hp);
  for (int k = 1; k <= most; ++k)
    result.orbits.push_back(result.has_square_root ? with_square_root(orbit.point, smooth, result.clearance, k)
                                                   : without_square_root(orbit, map, smooth, result.clearance, k));
  return result;
}

}  // namespace tchat
