#include "simulation/cvodes_flow.hpp"

#include <cvodes/cvodes.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hybrid/parameter_vector.hpp"

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

constexpr int not_evaluable = 1;  // tells CVODES to try a smaller step

}  // namespace

struct CvodesFlow::Implementation {
  const HybridSystem& system;
  int field;
  int event = 0;  // watched, 0 for none
  bool look_for_minima = true;
  int n;
  int columns;  // of [Phi, X]
  VectorXd par;
  FlowOptions options;
  std::string message;
  double time = 0.0;

  // Values of the field and its derivatives at the point last asked for.
  VectorXd f;
  MatrixXd fx, fp;
  Eigen::RowVectorXd hx;

  Context context = make_context();
  Vector x;
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
        hx(n),
        x(N_VNew_Serial(n, context.get()), &N_VDestroy),
        matrix(SUNDenseMatrix(n, n, context.get()), &SUNMatDestroy),
        linear_solver(SUNLinSol_Dense(x.get(), matrix.get(), context.get()), &SUNLinSolFree),
        integrator(CVodeCreate(o.method == IntegrationMethod::adams ? CV_ADAMS : CV_BDF, context.get())) {
    Eigen::Map<VectorXd>(N_VGetArrayPointer(x.get()), n) = x0;
    start();
    if (columns > 0) start_sensitivities();
  }

  void* cvode() { return integrator.get(); }

  void start() {
    CVodeSetErrHandlerFn(cvode(), &keep_message, this);
    CVodeInit(cvode(), &right_hand_side, 0.0, x.get());
    CVodeSStolerances(cvode(), options.relative_tolerance, options.absolute_tolerance);
    CVodeSetUserData(cvode(), this);
    CVodeSetLinearSolver(cvode(), linear_solver.get(), matrix.get());
    CVodeSetJacFn(cvode(), &jacobian);
    CVodeSetMaxNumSteps(cvode(), options.max_steps);
  }

  void start_sensitivities() {
    for (int c = 0; c < columns; ++c) {
      sensitivities.emplace_back(N_VNew_Serial(n, context.get()), &N_VDestroy);
      sensitivity_pointers.push_back(sensitivities.back().get());
      N_VConst(0.0, sensitivity_pointers.back());
      if (c < n) N_VGetArrayPointer(sensitivity_pointers.back())[c] = 1.0;
    }
    CVodeSensInit(cvode(), columns, CV_STAGGERED, &variational_equations, sensitivity_pointers.data());
    std::vector<double> absolute(static_cast<std::size_t>(columns), options.absolute_tolerance);
    CVodeSensSStolerances(cvode(), options.relative_tolerance, absolute.data());
    CVodeSetSensErrCon(cvode(), SUNTRUE);
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
    return all_finite(out, flow.n) ? 0 : not_evaluable;
  }

  static int jacobian(double, N_Vector at, N_Vector, SUNMatrix out, void* user_data, N_Vector, N_Vector, N_Vector) {
    Implementation& flow = self(user_data);
    if (!flow.evaluate(at)) return not_evaluable;
    std::copy(flow.fx.data(), flow.fx.data() + flow.fx.size(), SUNDenseMatrix_Data(out));
    return 0;
  }

  static int variational_equations(int, double, N_Vector at, N_Vector, N_Vector* s, N_Vector* derivative,
                                   void* user_data, N_Vector, N_Vector) {
    Implementation& flow = self(user_data);
    if (!flow.evaluate(at)) return not_evaluable;
    for (int c = 0; c < flow.columns; ++c) {
      const Eigen::Map<const VectorXd> column(N_VGetArrayPointer(s[c]), flow.n);
      Eigen::Map<VectorXd> out(N_VGetArrayPointer(derivative[c]), flow.n);
      out.noalias() = flow.fx * column;
      if (c >= flow.n) out += flow.fp.col(c - flow.n);
    }
    return 0;
  }

  double event_at(const double* at) const { return system.event(event, at, par.data()); }

  /// h_P = h_x f: zero where h is least. 1 where it is not looked for, or cannot be evaluated.
  double event_velocity(const double* at) {
    if (!look_for_minima) return 1.0;
    double h = 0.0;
    system.value(FunctionKind::field, field, at, par.data(), f.data());
    system.first(FunctionKind::event, event, at, par.data(), {}, &h, hx.data(), nullptr);
    const double velocity = hx.dot(f);
    return all_finite(&velocity, 1) ? velocity : 1.0;
  }

  static int root_functions(double, N_Vector at, double* out, void* user_data) {
    Implementation& flow = self(user_data);
    out[0] = flow.event_at(N_VGetArrayPointer(at));
    out[1] = flow.event_velocity(N_VGetArrayPointer(at));
    return all_finite(out, 1) ? 0 : not_evaluable;
  }

  /// One call of CVODES; goes on without minima where it finds a root of h_P too close to another.
  int step_to(double end_time) {
    int flag = CVode(cvode(), end_time, x.get(), &time, CV_NORMAL);
    if (flag == CV_ILL_INPUT && event > 0 && look_for_minima) {  // what CVODES returns for roots too close
      look_for_minima = false;
      flag = CVode(cvode(), end_time, x.get(), &time, CV_NORMAL);
    }
    return flag;
  }

  double event_on_step(double at_time) {
    CVodeGetDky(cvode(), at_time, 0, x.get());
    return event_at(N_VGetArrayPointer(x.get()));
  }

  /// At a root of h or h_P: whether h fell through zero, at `time` or inside the step before it. Then time and x are
  /// those of the crossing.
  bool find_crossing() {
    int found[2] = {0, 0};
    CVodeGetRootInfo(cvode(), found);
    if (found[0] != 0) return true;
    double current = 0.0;
    double length = 0.0;
    CVodeGetCurrentTime(cvode(), &current);
    CVodeGetLastStep(cvode(), &length);
    double above = current - length;
    double below = time;
    const double at_minimum = event_on_step(below);
    if (!(at_minimum < 0.0 && event_on_step(above) > 0.0)) return false;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (above + below);
      (event_on_step(middle) > 0.0 ? above : below) = middle;
    }
    time = below;
    event_on_step(below);
    return true;
  }

  /// Newton's method for h = 0 on the dense output: CVODES locates roots to 100 units of rounding in time, which a
  /// small velocity of h turns into much larger errors of what depends on it.
  void polish_crossing() {
    double current = 0.0;
    double length = 0.0;
    CVodeGetCurrentTime(cvode(), &current);
    CVodeGetLastStep(cvode(), &length);
    double h = event_on_step(time);
    for (int iteration = 0; iteration < 3; ++iteration) {
      const double moved = time - h / event_velocity(N_VGetArrayPointer(x.get()));
      const bool is_small = std::abs(moved - time) <= 1e-10 * (1.0 + std::abs(time));
      if (!is_small || moved > current || moved < current - length) break;
      const double h_moved = event_on_step(moved);
      if (std::abs(h_moved) >= std::abs(h)) break;
      time = moved;
      h = h_moved;
    }
    event_on_step(time);
  }

  static void keep_message(int, const char*, const char*, char* text, void* user_data) {
    self(user_data).message = text;
  }
};

CvodesFlow::CvodesFlow(const HybridSystem& system, int field, const VectorXd& x0, const VectorXd& par,
                       const FlowOptions& options)
    : p_(std::make_unique<Implementation>(system, field, x0, par, options)) {}

CvodesFlow::~CvodesFlow() = default;

void CvodesFlow::watch(int event) {
  p_->event = event;
  CVodeRootInit(p_->cvode(), 2, &Implementation::root_functions);
  int directions[2] = {-1, +1};
  CVodeSetRootDirection(p_->cvode(), directions);
  CVodeSetNoInactiveRootWarn(p_->cvode());
}

Progress CvodesFlow::advance(double end_time) {
  if (end_time == p_->time) return Progress::end_time;
  CVodeSetStopTime(p_->cvode(), end_time);
  int flag = p_->step_to(end_time);
  while (flag == CV_ROOT_RETURN && !p_->find_crossing()) flag = p_->step_to(end_time);
  if (flag < 0) {
    p_->message = fmt::format("integration of {} failed at time {:.6g}: {}",
                              p_->system.function_name(FunctionKind::field, p_->field), p_->time, p_->message);
    return Progress::failed;
  }
  if (flag == CV_ROOT_RETURN) p_->polish_crossing();
  if (p_->columns > 0) CVodeGetSensDky(p_->cvode(), p_->time, 0, p_->sensitivity_pointers.data());
  return flag == CV_ROOT_RETURN ? Progress::root : Progress::end_time;
}

double CvodesFlow::time() const { return p_->time; }

VectorXd CvodesFlow::state() const { return Eigen::Map<const VectorXd>(N_VGetArrayPointer(p_->x.get()), p_->n); }

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
