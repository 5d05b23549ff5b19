#include "motion/cvodes_flow.hpp"

#include <cvodes/cvodes.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/levels.hpp"
#include "model/function_values.hpp"
#include "model/parameter_vector.hpp"
#include "model/scales.hpp"
#include "motion/sparse_solver.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct FreeContext {
  void operator()(SUNContext context) const { SUNContext_Free(&context); }
};
struct FreeIntegrator {
  void operator()(void* memory) const { CVodeFree(&memory); }
};
using Context = std::unique_ptr<std::remove_pointer_t<SUNContext>, FreeContext>;
using Vector = std::unique_ptr<std::remove_pointer_t<N_Vector>, decltype(&N_VDestroy)>;
using Matrix = std::unique_ptr<std::remove_pointer_t<SUNMatrix>, decltype(&SUNMatDestroy)>;
using LinearSolver = std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, decltype(&SUNLinSolFree)>;

Context make_context() {
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  return Context(context);
}

constexpr int not_evaluable = 1;     // tells CVODES to try a smaller step
constexpr long most_stalled = 1000;  // steps in a row
constexpr double few_roundings = 4.0;

}  // namespace

struct CvodesFlow::Implementation {
  const HybridSystem& system;
  int field;
  int n;
  int columns;  // of [Phi, X]
  VectorXd par;
  FlowOptions options;
  std::string message;
  std::string not_evaluated;    // which function, and where
  double time = 0.0;            // of the flow as callers see it
  double reached = 0.0;         // by the integrator; the flow from `time` to here is still to be looked at
  long steps = 0, stalled = 0;  // in all; the last ones, that have hardly changed the time
  std::vector<int> events;
  std::optional<EventWatch> watch;
  bool finds_roots = false;  // CVODES does
  std::vector<int> is_root;  // what it located at `reached`
  int fallen = 0;
  std::function<bool(double, double)> observer;
  const DenseOutput output = [this](double t) { return dense_output(t); };

  // Values of the field and its derivatives at the point last asked for.
  VectorXd f;
  MatrixXd fx, fp;
  bool has_few_entries = false;  // f_x, that are not zero

  Context context = make_context();
  Vector x;
  Vector dense;  // what was last asked of the dense output
  std::vector<Vector> sensitivities;
  std::vector<N_Vector> sensitivity_pointers;
  Matrix matrix;
  LinearSolver linear_solver;
  std::unique_ptr<void, FreeIntegrator> integrator;

  Implementation(const HybridSystem& s, int i, const VectorXd& x0, const VectorXd& p, const FlowOptions& o)
      : system(s),
        field(i),
        n(s.dimension()),
        columns(o.variational ? n + static_cast<int>(o.active.size()) : 0),
        par(p),
        options(o),
        f(n),
        fx(n, n),
        fp(n, std::max<Eigen::Index>(1, static_cast<Eigen::Index>(o.active.size()))),
        x(N_VNew_Serial(n, context.get()), &N_VDestroy),
        dense(N_VNew_Serial(n, context.get()), &N_VDestroy),
        matrix(SUNDenseMatrix(n, n, context.get()), &SUNMatDestroy),
        linear_solver(nullptr, &SUNLinSolFree),
        integrator(CVodeCreate(o.method == IntegrationMethod::bdf ? CV_BDF : CV_ADAMS, context.get())) {
    Eigen::Map<VectorXd>(N_VGetArrayPointer(x.get()), n) = x0;
    if (n >= least_sparse_dimension && evaluate(x.get())) has_few_entries = is_sparse(fx);
    linear_solver.reset(has_few_entries ? new_sparse_solver(context.get())
                                        : SUNLinSol_Dense(x.get(), matrix.get(), context.get()));
    start();
    if (columns > 0) start_sensitivities();
  }

  void* cvode() { return integrator.get(); }

  void start() {
    CVodeSetErrHandlerFn(cvode(), &keep_message, this);
    CVodeInit(cvode(), &right_hand_side, 0.0, x.get());
    set_tolerances();
    CVodeSetUserData(cvode(), this);
    CVodeSetLinearSolver(cvode(), linear_solver.get(), matrix.get());
    CVodeSetJacFn(cvode(), &jacobian);
  }

  /// Absolute ones are shares of sizes, where these are known and small.
  void set_tolerances() {
    if (are_usual(options.sizes)) {
      CVodeSStolerances(cvode(), options.relative_tolerance, options.absolute_tolerance);
      return;
    }
    const Vector absolute(N_VNew_Serial(n, context.get()), &N_VDestroy);
    for (int i = 0; i < n; ++i) N_VGetArrayPointer(absolute.get())[i] = tolerance_of(i);
    CVodeSVtolerances(cvode(), options.relative_tolerance, absolute.get());
  }

  double tolerance_of(int state) const { return options.absolute_tolerance * size_for_tolerance(options.sizes(state)); }

  void start_sensitivities() {
    for (int c = 0; c < columns; ++c) {
      sensitivities.emplace_back(N_VNew_Serial(n, context.get()), &N_VDestroy);
      sensitivity_pointers.push_back(sensitivities.back().get());
      N_VConst(0.0, sensitivity_pointers.back());
      if (c < n) N_VGetArrayPointer(sensitivity_pointers.back())[c] = 1.0;
    }
    CVodeSensInit(cvode(), columns, CV_STAGGERED, &variational_equations, sensitivity_pointers.data());
    set_tolerances_of_sensitivities();
    CVodeSetSensErrCon(cvode(), SUNTRUE);
  }

  /// dx_i / dx_c and dx_i / dp: shares of the size of x_i by that of x_c, or by the modulus of a parameter.
  void set_tolerances_of_sensitivities() {
    if (are_usual(options.sizes)) {
      std::vector<double> absolute(static_cast<std::size_t>(columns), options.absolute_tolerance);
      CVodeSensSStolerances(cvode(), options.relative_tolerance, absolute.data());
      return;
    }
    std::vector<Vector> absolute;
    std::vector<N_Vector> pointers;
    for (int c = 0; c < columns; ++c) {
      const double by = c < n ? options.sizes(c) : std::abs(par(options.active[static_cast<std::size_t>(c - n)] - 1));
      absolute.emplace_back(N_VNew_Serial(n, context.get()), &N_VDestroy);
      pointers.push_back(absolute.back().get());
      for (int i = 0; i < n; ++i) N_VGetArrayPointer(pointers.back())[i] = tolerance_of(i) / size_for_tolerance(by);
    }
    CVodeSensSVtolerances(cvode(), options.relative_tolerance, pointers.data());
  }

  bool evaluate(N_Vector at) {
    const std::vector<int>& active = options.active;
    const double* const state = N_VGetArrayPointer(at);
    system.first(FunctionKind::field, field, state, par.data(), active, f.data(), fx.data(), fp.data());
    return all_finite(fx.data(), n * n) && all_finite(fp.data(), n * static_cast<int>(active.size()));
  }

  static Implementation& self(void* user_data) { return *static_cast<Implementation*>(user_data); }

  static int right_hand_side(double, N_Vector at, N_Vector derivative, void* user_data) {
    Implementation& flow = self(user_data);
    double* const out = N_VGetArrayPointer(derivative);
    flow.system.value(FunctionKind::field, flow.field, N_VGetArrayPointer(at), flow.par.data(), out);
    if (all_finite(out, flow.n)) return 0;
    flow.remember_trouble(FunctionKind::field, flow.field, at);
    return not_evaluable;
  }

  static int jacobian(double, N_Vector at, N_Vector, SUNMatrix out, void* user_data, N_Vector, N_Vector, N_Vector) {
    Implementation& flow = self(user_data);
    if (!flow.evaluate(at)) return flow.remember_no_derivatives(at);
    std::copy(flow.fx.data(), flow.fx.data() + flow.fx.size(), SUNDenseMatrix_Data(out));
    return 0;
  }

  static int variational_equations(int, double, N_Vector at, N_Vector, N_Vector* s, N_Vector* derivative,
                                   void* user_data, N_Vector, N_Vector) {
    Implementation& flow = self(user_data);
    if (!flow.evaluate(at)) return flow.remember_no_derivatives(at);
    Eigen::SparseMatrix<double> sparse;
    if (flow.has_few_entries) sparse = flow.fx.sparseView();
    for (int c = 0; c < flow.columns; ++c) {
      const Eigen::Map<const VectorXd> column(N_VGetArrayPointer(s[c]), flow.n);
      Eigen::Map<VectorXd> out(N_VGetArrayPointer(derivative[c]), flow.n);
      if (flow.has_few_entries)
        out = sparse * column;
      else
        out.noalias() = flow.fx * column;
      if (c >= flow.n) out += flow.fp.col(c - flow.n);
    }
    return 0;
  }

  static int root_functions(double, N_Vector at, double* out, void* user_data) {
    Implementation& flow = self(user_data);
    if (flow.watch->roots(N_VGetArrayPointer(at), out)) return 0;
    flow.remember_trouble_of_roots(at);
    return not_evaluable;
  }

  /// The field where it has no value, else the event function that has none.
  void remember_trouble_of_roots(N_Vector at) {
    const double* const state = N_VGetArrayPointer(at);
    system.value(FunctionKind::field, field, state, par.data(), f.data());
    if (!all_finite(f.data(), n)) return remember_trouble(FunctionKind::field, field, at);
    for (const int event : events)
      if (!std::isfinite(watch->value(event, state))) return remember_trouble(FunctionKind::event, event, at);
  }

  void remember_trouble(FunctionKind kind, int index, N_Vector at) {
    not_evaluated = undefined_value(system, kind, index, N_VGetArrayPointer(at));
  }

  int remember_no_derivatives(N_Vector at) {
    const double* const state = N_VGetArrayPointer(at);
    not_evaluated = no_finite_derivatives(system, FunctionKind::field, field, Eigen::Map<const VectorXd>(state, n));
    return not_evaluable;
  }

  const double* dense_output(double t) {
    CVodeGetDky(cvode(), t, 0, dense.get());
    return N_VGetArrayPointer(dense.get());
  }

  double current_time() {
    double current = 0.0;
    CVodeGetCurrentTime(cvode(), &current);
    return current;
  }

  void start_roots() {
    const int count = watch->count();
    CVodeRootInit(cvode(), 2 * count, &Implementation::root_functions);
    std::vector<int> directions(static_cast<std::size_t>(2 * count), -1);
    std::fill(directions.begin() + count, directions.end(), +1);
    CVodeSetRootDirection(cvode(), directions.data());
    CVodeSetNoInactiveRootWarn(cvode());
    is_root.assign(directions.size(), 0);
    finds_roots = true;
  }

  /// One step of CVODES, or the part of it up to the next root. Roots too close to each other (CV_ILL_INPUT) end its
  /// search for roots; that of the watch goes on. False when the integration failed.
  bool step(double end_time) {
    const double begun = reached;
    int flag = CVode(cvode(), end_time, x.get(), &reached, CV_ONE_STEP);
    if (flag == CV_ILL_INPUT && finds_roots) {
      CVodeRootInit(cvode(), 0, nullptr);
      finds_roots = false;
      message.clear();
      const double behind = std::exchange(reached, current_time());
      flag = reached == behind ? CVode(cvode(), end_time, x.get(), &reached, CV_ONE_STEP) : CV_SUCCESS;
    }
    std::fill(is_root.begin(), is_root.end(), 0);
    if (flag == CV_ROOT_RETURN) CVodeGetRootInfo(cvode(), is_root.data());
    if (flag < 0 && message.empty()) message = fmt::format("CVODES gave up with code {}", flag);
    if (flag < 0) return false;
    const double rounding = few_roundings * std::numeric_limits<double>::epsilon() * std::abs(reached);
    stalled = std::abs(reached - begun) <= rounding ? stalled + 1 : 0;
    if (stalled > most_stalled) message = "steps have become too small to change the time";
    if (++steps > options.max_steps) message = fmt::format("more than {} steps", options.max_steps);
    return stalled <= most_stalled && steps <= options.max_steps;
  }

  /// Looks for falls up to where the integrator is.
  bool look() {
    if (!watch) {
      time = reached;
      return false;
    }
    const std::optional<EventWatch::Fall> fall = watch->look(reached, output, finds_roots ? is_root.data() : nullptr);
    time = fall ? fall->time : reached;
    fallen = fall ? fall->event : 0;
    if (fall) polish_fall();
    return fall.has_value();
  }

  /// Newton's method for h = 0 on the dense output: CVODES locates roots to 100 units of rounding in time, which a
  /// small velocity of h turns into much larger errors of what depends on it.
  void polish_fall() {
    double length = 0.0;
    CVodeGetLastStep(cvode(), &length);
    const double current = current_time();
    double h = watch->value(fallen, dense_output(time));
    for (int iteration = 0; iteration < 3; ++iteration) {
      const double moved = time - h / watch->rate(fallen, dense_output(time));
      const bool is_small = std::abs(moved - time) <= level::converged * std::max(std::abs(time), length);
      if (!is_small || moved > current || moved < current - length) break;
      const double h_moved = watch->value(fallen, dense_output(moved));
      if (std::abs(h_moved) >= std::abs(h)) break;
      time = moved;
      h = h_moved;
    }
  }

  Progress fail() {
    message =
        fmt::format("integration of {} failed at time {:.6g}: {}", system.function_name(FunctionKind::field, field),
                    reached, not_evaluated.empty() ? message : not_evaluated);
    return Progress::failed;
  }

  Progress advance(double end_time) {
    CVodeSetStopTime(cvode(), end_time);
    while (time != end_time) {
      const double from = time;
      not_evaluated.clear();
      if (time == reached && !step(end_time)) return fail();
      if (watch && !is_evaluable_at_end()) return fail();
      const bool has_fallen = look();
      const bool goes_on = !observer || observer(from, time);
      if (has_fallen) return Progress::root;
      if (!goes_on) return Progress::stopped;
    }
    return Progress::end_time;
  }

  bool is_evaluable_at_end() {
    const double* const at = dense_output(reached);
    for (const int event : events) {
      const double h = watch->value(event, at);
      if (all_finite(&h, 1)) continue;
      remember_trouble(FunctionKind::event, event, dense.get());
      return false;
    }
    return true;
  }

  static void keep_message(int, const char*, const char*, char* text, void* user_data) {
    self(user_data).message = text;
  }
};

CvodesFlow::CvodesFlow(const HybridSystem& system, int field, const VectorXd& x0, const VectorXd& par,
                       const FlowOptions& options)
    : p_(std::make_unique<Implementation>(system, field, x0, par, options)) {}

CvodesFlow::~CvodesFlow() = default;

void CvodesFlow::watch(const std::vector<int>& events, const std::vector<int>& after) {
  p_->events = events;
  p_->watch.emplace(p_->system, p_->field, events, p_->par, N_VGetArrayPointer(p_->x.get()), p_->options, after);
  p_->start_roots();
}

void CvodesFlow::on_piece(std::function<bool(double, double)> observer) { p_->observer = std::move(observer); }

Progress CvodesFlow::advance(double end_time) {
  if (end_time == p_->time) return Progress::end_time;
  const Progress progress = p_->advance(end_time);
  if (progress != Progress::failed && p_->columns > 0)
    CVodeGetSensDky(p_->cvode(), p_->time, 0, p_->sensitivity_pointers.data());
  return progress;
}

int CvodesFlow::fallen() const { return p_->fallen; }

std::vector<EventWatch::Contact> CvodesFlow::take_contacts() {
  return p_->watch ? p_->watch->take_contacts() : std::vector<EventWatch::Contact>{};
}

bool CvodesFlow::is_armed(int event) const { return p_->watch && p_->watch->is_armed(event); }

const DenseOutput& CvodesFlow::dense_output() const { return p_->output; }

VectorXd CvodesFlow::state_at(double t) const { return Eigen::Map<const VectorXd>(p_->dense_output(t), p_->n); }

double CvodesFlow::time() const { return p_->time; }

VectorXd CvodesFlow::state() const {
  if (p_->time == 0.0) return Eigen::Map<const VectorXd>(N_VGetArrayPointer(p_->x.get()), p_->n);
  return state_at(p_->time);
}

MatrixXd CvodesFlow::jacobian() const {
  if (p_->columns == 0) return {};
  MatrixXd phi(p_->n, p_->n);
  for (int c = 0; c < p_->n; ++c)
    phi.col(c) =
        Eigen::Map<const VectorXd>(N_VGetArrayPointer(p_->sensitivity_pointers[static_cast<std::size_t>(c)]), p_->n);
  return phi;
}

MatrixXd CvodesFlow::parameter_derivative() const {
  if (p_->columns == 0) return {};
  MatrixXd out(p_->n, p_->columns - p_->n);
  for (int c = p_->n; c < p_->columns; ++c)
    out.col(c - p_->n) =
        Eigen::Map<const VectorXd>(N_VGetArrayPointer(p_->sensitivity_pointers[static_cast<std::size_t>(c)]), p_->n);
  return out;
}

const std::string& CvodesFlow::message() const { return p_->message; }

}  // namespace tchat
