#include "motion/tangent_flow.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/sparse_solver.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

// The error of sixth order that goes with it is about this to the power 7/5.
constexpr double most_difference = level::differences;
// The error of Gauss' quadrature of A is h^7 / 2016000 times its sixth derivative: next to h = 0.3 times the scale of
// time on which A of size 1 changes, 1e-10.
constexpr double most_slope = 0.3;  // of h^2 A'
constexpr double most_bend = 0.01;  // of h^3 A'' / 2
constexpr double most_bend_of_rough = 0.03;
// exp(Omega) V then loses two digits at most, and the shortest direction of V seven between two orthonormalisations.
constexpr double most_norm = 4.0;
constexpr double most_stretched = 4.0;
// From this tolerance of the states on, fourth order does. Simpson's rule has the error h^5 A'''' / 2880.
constexpr double rough = level::orbit;
constexpr int most_terms = 60;
constexpr double shortest_share = level::negligible;  // of a piece, that a step is halved to
// Of one piece, which is a step of the integration. Far from all orbits a state may be so large that it would take
// years.
constexpr int most_steps = 100'000;

constexpr Eigen::Index few_rows = 6;

/// out += factor a b, a of N x N.
template <int N>
void add_product(double factor, const MatrixXd& a, const MatrixXd& b, MatrixXd& out) {
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    Eigen::Map<Eigen::Matrix<double, N, 1>> column(out.col(j).data());
    Eigen::Matrix<double, N, 1> sum = column;
    for (int k = 0; k < N; ++k)
      sum += factor * b(k, j) * Eigen::Map<const Eigen::Matrix<double, N, 1>>(a.col(k).data());
    column = sum;
  }
}

/// The same of any size. Of few rows Eigen's product takes longer than the arithmetic.
void add_product(double factor, const MatrixXd& a, const MatrixXd& b, MatrixXd& out) {
  switch (a.rows()) {
    case 2:
      return add_product<2>(factor, a, b, out);
    case 3:
      return add_product<3>(factor, a, b, out);
    case 4:
      return add_product<4>(factor, a, b, out);
    case 5:
      return add_product<5>(factor, a, b, out);
    case few_rows:
      return add_product<few_rows>(factor, a, b, out);
    default:
      out.noalias() += factor * a * b;
  }
}

void commutator(const MatrixXd& a, const MatrixXd& b, MatrixXd& out) {
  out.setZero();
  add_product(1.0, a, b, out);
  add_product(-1.0, b, a, out);
}

void commutator(const SparseMatrix& a, const SparseMatrix& b, SparseMatrix& out) {
  out = a * b;
  const SparseMatrix other = b * a;
  out -= other;
}

}  // namespace

TangentFlow::TangentFlow(const HybridSystem& system, const Eigen::VectorXd& par, double tolerance)
    : system_(system),
      par_(par),
      is_rough_(tolerance >= rough),
      f_(system.dimension()),
      units_(Eigen::VectorXd::Ones(system.dimension())) {
  for (MatrixXd* const m : {&first_, &middle_, &last_}) m->resize(system.dimension(), system.dimension());
  const Eigen::Index n = system.dimension();
  dense_ = {MatrixXd(n, n), MatrixXd(n, n), MatrixXd(n, n), MatrixXd(n, n),
            MatrixXd(n, n), MatrixXd(n, n), MatrixXd(n, n)};
}

bool TangentFlow::evaluate(int field, const double* x, MatrixXd& out) {
  double no_parameters = 0.0;
  system_.first(FunctionKind::field, field, x, par_.data(), {}, f_.data(), out.data(), &no_parameters);
  if (!all_finite(out.data(), static_cast<int>(out.size()))) return false;
  if (has_units_) out = units_.cwiseInverse().asDiagonal() * out * units_.asDiagonal();
  return true;
}

void TangentFlow::use_sizes(const Eigen::VectorXd& sizes) {
  known_at_ = -1.0;
  has_units_ = !are_usual(sizes);
  units_ = units_of(sizes);
}

void TangentFlow::to_units(MatrixXd& vectors) const {
  if (has_units_) vectors = units_.cwiseInverse().asDiagonal() * vectors;
}

void TangentFlow::from_units(MatrixXd& vectors) const {
  if (has_units_) vectors = units_.asDiagonal() * vectors;
}

/// Units in which A is smaller, if there are any.
bool TangentFlow::balance() {
  const Eigen::VectorXd units = balancing_units(middle_);
  const double balanced = (units.cwiseInverse().asDiagonal() * middle_ * units.asDiagonal()).norm();
  if (!(balanced < 0.5 * middle_.norm())) return false;
  units_ = units_.cwiseProduct(units);
  has_units_ = true;
  known_at_ = -1.0;
  return true;
}

bool TangentFlow::series(int field, const DenseOutput& state, double from, double step) {
  if (is_rough_) return rough_series(field, state, from, step);
  const double root = std::sqrt(15.0);
  if (!evaluate(field, state(from + (0.5 - root / 10.0) * step), first_)) return false;
  if (!evaluate(field, state(from + 0.5 * step), middle_)) return false;
  if (!evaluate(field, state(from + (0.5 + root / 10.0) * step), last_)) return false;
  has_few_entries_ = is_sparse(middle_);
  if (!has_few_entries_) {
    dense_.a1 = step * middle_;
    dense_.a2 = (root / 3.0 * step) * (last_ - first_);
    dense_.a3 = (10.0 / 3.0 * step) * (last_ - 2.0 * middle_ + first_);
    magnus(dense_);
    return true;
  }
  sparse_.a1 = (step * middle_).sparseView();
  sparse_.a2 = ((root / 3.0 * step) * (last_ - first_)).sparseView();
  sparse_.a3 = ((10.0 / 3.0 * step) * (last_ - 2.0 * middle_ + first_)).sparseView();
  magnus(sparse_);
  return true;
}

bool TangentFlow::rough_series(int field, const DenseOutput& state, double from, double step) {
  const bool is_known = from > 0.0 && from == known_at_ && field == known_field_;
  if (!is_known && !evaluate(field, state(from), first_)) return false;
  if (!evaluate(field, state(from + 0.5 * step), middle_) || !evaluate(field, state(from + step), last_)) return false;
  known_at_ = from;
  known_field_ = field;
  has_few_entries_ = is_sparse(middle_);
  if (has_few_entries_) {
    sparse_.a1 = (step / 6.0 * (first_ + 4.0 * middle_ + last_)).sparseView();
    sparse_.a2 = (step * (last_ - first_)).sparseView();
    sparse_.a3 = (2.0 * step * (last_ - 2.0 * middle_ + first_)).sparseView();
    rough_magnus(sparse_);
    return true;
  }
  dense_.a1 = step / 6.0 * (first_ + 4.0 * middle_ + last_);
  dense_.a2 = step * (last_ - first_);
  dense_.a3 = 2.0 * step * (last_ - 2.0 * middle_ + first_);
  rough_magnus(dense_);
  return true;
}

/// The step has been made: it ends where the next one begins.
void TangentFlow::keep_last(double to) {
  first_.swap(last_);
  known_at_ = to;
}

template <class Matrix>
void TangentFlow::rough_magnus(Series<Matrix>& s) {
  commutator(s.a1, s.a2, s.c1);
  s.omega = s.a1 - s.c1 / 12.0;
  norm_ = s.omega.norm();
  const double slope = s.a2.norm();
  difference_ = s.c1.norm() * (norm_ * norm_ / 720.0 + slope / 240.0);
  changes_ = std::max(slope / most_slope, s.a3.norm() / most_bend_of_rough);
}

template <class Matrix>
void TangentFlow::magnus(Series<Matrix>& s) {
  commutator(s.a1, s.a2, s.c1);
  s.b = 2.0 * s.a3 + s.c1;
  commutator(s.a1, s.b, s.c2);
  s.c2 = s.a2 - s.c2 / 60.0;
  s.b = -20.0 * s.a1 - s.a3 + s.c1;
  commutator(s.b, s.c2, s.omega);
  s.omega /= 240.0;
  difference_ = (s.omega + s.c1 / 12.0).norm();
  changes_ = std::max(s.a2.norm() / most_slope, s.a3.norm() / most_bend);
  s.omega += s.a1 + s.a3 / 12.0;
  norm_ = s.omega.norm();
}

/// How many terms of exp(Omega) V are not below `enough` in any column: each is e^-|Omega| times as long as before, at
/// least.
int TangentFlow::terms(double enough) const {
  double last = std::exp(norm_);
  int k = 0;
  while (last > enough && k < most_terms) last *= norm_ / ++k;
  return std::max(k, 1);
}

/// V + Omega (V + Omega/2 (V + ...))
void TangentFlow::apply_exponential(MatrixXd& vectors) {
  const int count = terms(is_rough_ ? 0.01 * most_difference : level::rounding);
  if (has_few_entries_) {  // entries of one row of V together
    rows_ = vectors;
    row_term_ = rows_;
    for (int k = count; k > 0; --k) {
      row_product_.noalias() = sparse_.omega * row_term_;
      row_term_ = rows_ + row_product_ / static_cast<double>(k);
    }
    vectors = row_term_;
    return;
  }
  term_ = vectors;
  for (int k = count; k > 0; --k) {
    product_ = vectors;
    add_product(1.0 / static_cast<double>(k), dense_.omega, term_, product_);
    term_.swap(product_);
  }
  vectors.swap(term_);
}

bool TangentFlow::carry(OrthonormalFrame& frame, int field, const DenseOutput& state, double from, double to) {
  return carry(frame.vectors(), field, state, from, to, [&] {
    stretched_ += norm_;
    if (stretched_ <= most_stretched) return;
    frame.orthonormalise();
    stretched_ = 0.0;
  });
}

bool TangentFlow::carry(MatrixXd& vectors, int field, const DenseOutput& state, double from, double to) {
  return carry(vectors, field, state, from, to, [] {});
}

template <class Stretched>
bool TangentFlow::carry(MatrixXd& vectors, int field, const DenseOutput& state, double from, double to,
                        const Stretched& stretched) {
  const double shortest = shortest_share * (to - from);
  double step = to - from;
  int steps = 0;
  bool is_balanced = false;
  for (double t = from; t < to;) {
    takes_too_many_steps_ = ++steps > most_steps;
    if (takes_too_many_steps_) return false;
    const bool is_last = t + step >= to - shortest;
    if (is_last) step = to - t;
    if (!series(field, state, t, step)) return false;
    if (norm_ > most_norm && !is_balanced) {
      is_balanced = true;
      if (balance()) continue;
    }
    if ((difference_ > most_difference || changes_ > 1.0 || norm_ > most_norm) && step > shortest) {
      step *= 0.5;
      continue;
    }
    to_units(vectors);
    apply_exponential(vectors);
    from_units(vectors);
    stretched();
    t = is_last ? to : t + step;
    if (is_rough_) keep_last(t);
    if (difference_ < 0.01 * most_difference && changes_ < 0.1 && norm_ < 0.5 * most_norm) step *= 2.0;
  }
  return true;
}

namespace {

using Eigen::VectorXd;

constexpr double tangential = level::rounding;  // h_x f beside its scale
constexpr double endless = 1e300;
constexpr double far_off = 100.0;  // from where the motion has been, in the largest size of a state

/// V at the end of a segment, onto the surface of its event. False where that is met tangentially. `sizes`: of states.
bool project_on_event(const HybridSystem& system, const SimulatedSegment& segment, const VectorXd& sizes,
                      const VectorXd& par, MatrixXd& v) {
  const EventAt at = event_at(system, segment.index.event, segment.mode.field(), segment.end.data(), par.data());
  if (!(std::abs(at.rate()) > tangential * at.rate_scale(sizes))) return false;
  v = at.project(v);
  return v.allFinite();
}

}  // namespace

SimulatedTurn simulate_turn(const HybridSimulation& at, const VectorXd& y, const Signature& expected,
                            SimulationSettings settings, bool with_derivative) {
  const HybridSystem& system = at.system();
  const VectorXd& par = at.parameters();
  TangentFlow tangent(system, par, settings.flow.relative_tolerance);
  SimulatedTurn turn;
  MatrixXd& v = turn.derivative;
  settings.on_piece = {};
  tangent.use_sizes(at.sizes());
  const double farthest = far_off * at.sizes().maxCoeff();
  bool has_left = false;
  const bool has_sizes = farthest > 0.0;
  if (with_derivative) v = jump_at(system, at.last_event().jump, y.data(), par.data()).derivative;
  settings.on_piece = [&](int field, const DenseOutput& state, double from, double to) {
    const double* const x = state(to);
    has_left = has_sizes && !(Eigen::Map<const VectorXd>(x, y.size()).cwiseAbs().maxCoeff() <= farthest);
    if (with_derivative && !has_left) turn.is_smooth = turn.is_smooth && tangent.carry(v, field, state, from, to);
  };
  settings.interrupted = [&, outer = settings.interrupted] {
    return has_left || !turn.is_smooth || (outer && outer());
  };
  HybridSimulation simulation(at, y, std::move(settings));
  for (std::size_t s = 0; s < expected.size(); ++s) {
    turn.segments.push_back(simulation.next(endless));
    const SimulatedSegment& segment = turn.segments.back();
    if (segment.ended_by != SegmentEnd::event || segment.index != expected[s]) {
      turn.fault = fmt::format("segment {} does not end as that of the motion", s + 1);
      return turn;
    }
    if (!with_derivative) continue;
    tangent.use_sizes(simulation.sizes());
    turn.is_smooth = turn.is_smooth && project_on_event(system, segment, simulation.sizes(), par, v);
    if (!turn.is_smooth) {
      turn.fault = fmt::format("segment {} has no finite derivative", s + 1);
      return turn;
    }
    if (s + 1 < expected.size()) v = jump_at(system, segment.index.jump, segment.end.data(), par.data()).derivative * v;
  }
  return turn;
}

}  // namespace tchat
