#include "benchmark/auto_problem.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "benchmark/branch_walk.hpp"
#include "benchmark/impacting_orbit.hpp"

namespace tchat::benchmark {

namespace {

// Routines that AUTO-07p calls, too, in every problem.
constexpr const char* unused_functions = R"(
subroutine ICND
end subroutine ICND

subroutine FOPT
end subroutine FOPT

subroutine PVLS
end subroutine PVLS
)";

constexpr const char* functions = R"(
subroutine FUNC(NDIM, U, ICP, PAR, IJAC, F, DFDU, DFDP)
  use orbit
  implicit none
  integer, intent(in) :: NDIM, ICP(*), IJAC
  double precision, intent(in) :: U(NDIM), PAR(*)
  double precision, intent(out) :: F(NDIM)
  double precision, intent(inout) :: DFDU(NDIM, NDIM), DFDP(NDIM, *)
  double precision :: x1, x2, y1, y2, square, t, g(4)
  integer :: s, o
  if (IJAC > 0) DFDU = 0
  if (IJAC > 1) then
    DFDP(:, 1) = 0
    DFDP(:, duration:duration + segments - 1) = 0
  end if
  do s = 1, segments
    o = 4 * (s - 1)
    t = PAR(duration - 1 + s)
    x1 = U(o + 1)
    x2 = U(o + 2)
    y1 = U(o + 3)
    y2 = U(o + 4)
    square = y1 * y1 + y2 * y2
    g(1) = x2
    g(2) = PAR(1) * y2 - 2 * zeta * x2 - x1
    g(3) = y1 + omega * y2 - y1 * square
    g(4) = y2 - omega * y1 - y2 * square
    F(o + 1:o + 4) = t * g
    if (IJAC == 0) cycle
    DFDU(o + 1, o + 2) = t
    DFDU(o + 2, o + 1) = -t
    DFDU(o + 2, o + 2) = -2 * zeta * t
    DFDU(o + 2, o + 4) = t * PAR(1)
    DFDU(o + 3, o + 3) = t * (1 - square - 2 * y1 * y1)
    DFDU(o + 3, o + 4) = t * (omega - 2 * y1 * y2)
    DFDU(o + 4, o + 3) = -t * (omega + 2 * y1 * y2)
    DFDU(o + 4, o + 4) = t * (1 - square - 2 * y2 * y2)
    if (IJAC == 1) cycle
    DFDP(o + 2, 1) = t * y2
    DFDP(o + 1:o + 4, duration - 1 + s) = g
  end do
end subroutine FUNC

subroutine BCND(NDIM, PAR, ICP, NBC, U0, U1, FB, IJAC, DBC)
  use orbit
  implicit none
  integer, intent(in) :: NDIM, ICP(*), NBC, IJAC
  double precision, intent(in) :: PAR(*), U0(NDIM), U1(NDIM)
  double precision, intent(out) :: FB(NBC)
  double precision, intent(inout) :: DBC(NBC, *)
  double precision, parameter :: jump(4) = (/ 1.0d0, -restitution, 1.0d0, 1.0d0 /)
  integer :: s, o, next, i
  if (IJAC > 0) DBC(:, 1:2 * NDIM) = 0
  if (IJAC > 1) then
    DBC(:, 2 * NDIM + 1) = 0
    DBC(:, 2 * NDIM + duration:2 * NDIM + duration + segments - 1) = 0
  end if
  do s = 1, segments
    o = 4 * (s - 1)
    next = 4 * mod(s, segments)
    FB(s) = 1 - U1(o + 1)
    do i = 1, 4
      FB(segments + o + i) = U0(next + i) - jump(i) * U1(o + i)
    end do
    if (IJAC == 0) cycle
    DBC(s, NDIM + o + 1) = -1
    do i = 1, 4
      DBC(segments + o + i, next + i) = 1
      DBC(segments + o + i, NDIM + o + i) = -jump(i)
    end do
  end do
end subroutine BCND

subroutine STPNT(NDIM, U, PAR, TAU)
  use orbit
  implicit none
  integer, intent(in) :: NDIM
  double precision, intent(inout) :: U(NDIM), PAR(*)
  double precision, intent(in) :: TAU
  double precision :: detuning, damping, a, b, natural, c, d, t, y1, y2, period, free, state(4)
  integer :: s
  detuning = 1 - omega ** 2
  damping = 2 * zeta * omega
  a = alpha * detuning / (detuning ** 2 + damping ** 2)
  b = alpha * damping / (detuning ** 2 + damping ** 2)
  natural = sqrt(1 - zeta ** 2)
  c = 1 - (a * phase2 + b * phase1)
  d = (-restitution * velocity - omega * (b * phase2 - a * phase1) + zeta * c) / natural
  period = 2 * acos(-1.0d0) / omega
  t = TAU * period
  y1 = phase1 * cos(omega * t) + phase2 * sin(omega * t)
  y2 = phase2 * cos(omega * t) - phase1 * sin(omega * t)
  free = exp(-zeta * t) * (c * cos(natural * t) + d * sin(natural * t))
  state(1) = a * y2 + b * y1 + free
  state(2) = omega * (b * y2 - a * y1) - zeta * free &
             + exp(-zeta * t) * natural * (d * cos(natural * t) - c * sin(natural * t))
  state(3) = y1
  state(4) = y2
  PAR(1) = alpha
  do s = 1, segments
    U(4 * s - 3:4 * s) = state
    PAR(duration - 1 + s) = period
  end do
end subroutine STPNT
)";

// What the chain's module has besides its numbers, and its functions.
constexpr const char* chain_functions = R"(
  double precision :: states(n, nodes), start_alpha, start_period
  logical :: is_read = .false.
contains
  subroutine read_start()
    integer :: k
    if (is_read) return
    open(31, file='start', status='old')
    read(31, *) start_alpha, start_period
    do k = 1, nodes
      read(31, *) states(:, k)
    end do
    close(31)
    is_read = .true.
  end subroutine read_start
end module orbit

subroutine FUNC(NDIM, U, ICP, PAR, IJAC, F, DFDU, DFDP)
  use orbit
  implicit none
  integer, intent(in) :: NDIM, ICP(*), IJAC
  double precision, intent(in) :: U(NDIM), PAR(*)
  double precision, intent(out) :: F(NDIM)
  double precision, intent(inout) :: DFDU(NDIM, NDIM), DFDP(NDIM, *)
  double precision :: t, y1, y2, square, g(n)
  integer :: i, q, v
  t = PAR(duration)
  y1 = U(n - 1)
  y2 = U(n)
  square = y1 * y1 + y2 * y2
  do i = 1, masses
    q = 2 * i - 1
    v = 2 * i
    g(q) = U(v)
    g(v) = -U(q) - 2 * zeta * U(v)
    if (i > 1) g(v) = g(v) + kappa * (U(q - 2) - U(q))
    if (i < masses) g(v) = g(v) + kappa * (U(q + 2) - U(q))
  end do
  g(2) = g(2) + PAR(1) * y2
  g(n - 1) = y1 + omega * y2 - y1 * square
  g(n) = y2 - omega * y1 - y2 * square
  F = t * g
  if (IJAC == 0) return
  DFDU = 0
  do i = 1, masses
    q = 2 * i - 1
    v = 2 * i
    DFDU(q, v) = t
    DFDU(v, q) = -t
    DFDU(v, v) = -2 * zeta * t
    if (i > 1) then
      DFDU(v, q) = DFDU(v, q) - kappa * t
      DFDU(v, q - 2) = kappa * t
    end if
    if (i < masses) then
      DFDU(v, q) = DFDU(v, q) - kappa * t
      DFDU(v, q + 2) = kappa * t
    end if
  end do
  DFDU(2, n) = t * PAR(1)
  DFDU(n - 1, n - 1) = t * (1 - square - 2 * y1 * y1)
  DFDU(n - 1, n) = t * (omega - 2 * y1 * y2)
  DFDU(n, n - 1) = -t * (omega + 2 * y1 * y2)
  DFDU(n, n) = t * (1 - square - 2 * y2 * y2)
  if (IJAC == 1) return
  DFDP(:, 1) = 0
  DFDP(2, 1) = t * y2
  DFDP(:, duration) = g
end subroutine FUNC

subroutine BCND(NDIM, PAR, ICP, NBC, U0, U1, FB, IJAC, DBC)
  use orbit
  implicit none
  integer, intent(in) :: NDIM, ICP(*), NBC, IJAC
  double precision, intent(in) :: PAR(*), U0(NDIM), U1(NDIM)
  double precision, intent(out) :: FB(NBC)
  double precision, intent(inout) :: DBC(NBC, *)
  double precision :: jump
  integer :: i
  if (IJAC > 0) DBC(:, 1:2 * NDIM) = 0
  if (IJAC > 1) then
    DBC(:, 2 * NDIM + 1) = 0
    DBC(:, 2 * NDIM + duration) = 0
  end if
  FB(1) = 1 - U1(1)
  if (IJAC > 0) DBC(1, NDIM + 1) = -1
  do i = 1, n
    jump = 1
    if (i == 2) jump = -restitution
    FB(1 + i) = U0(i) - jump * U1(i)
    if (IJAC == 0) cycle
    DBC(1 + i, i) = 1
    DBC(1 + i, NDIM + i) = -jump
  end do
end subroutine BCND

subroutine STPNT(NDIM, U, PAR, TAU)
  use orbit
  implicit none
  integer, intent(in) :: NDIM
  double precision, intent(inout) :: U(NDIM), PAR(*)
  double precision, intent(in) :: TAU
  call read_start()
  PAR(1) = start_alpha
  PAR(duration) = start_period
  U = states(:, 1 + nint(TAU * (nodes - 1)))
end subroutine STPNT
)";

std::string constant(const char* name, double value) {
  return fmt::format("  double precision, parameter :: {} = {:.16f}d0\n", name, value);
}

}  // namespace

std::string auto_chain_source(int n, int intervals) {
  const ImpactData data;
  return fmt::format(
             "module orbit\n  implicit none\n  integer, parameter :: masses = {}, n = {}, nodes = {}, duration = {}\n",
             (n - 2) / 2, n, intervals * collocation_points + 1, auto_first_duration) +
         constant("omega", data.omega) + constant("zeta", data.zeta) + constant("restitution", data.restitution) +
         constant("kappa", chain_coupling) + chain_functions + unused_functions;
}

std::string auto_chain_start(const Orbit& x) {
  std::string text = fmt::format("{:.17e} {:.17e}\n", x.par(0), x.duration(0));
  for (int k = 0; k < x.shape.nodes(); ++k) {
    for (int i = 0; i < x.shape.dimension; ++i) text += fmt::format(" {:.17e}", x.node(0, k)[i]);
    text += '\n';
  }
  return text;
}

std::string auto_source(int segments) {
  const ImpactData data;
  return fmt::format("module orbit\n  implicit none\n  integer, parameter :: segments = {}, duration = {}\n", segments,
                     auto_first_duration) +
         constant("alpha", data.alpha) + constant("omega", data.omega) + constant("zeta", data.zeta) +
         constant("restitution", data.restitution) + constant("velocity", data.velocity) + constant("phase1", data.y1) +
         constant("phase2", data.y2) + "end module orbit\n" + functions + unused_functions;
}

std::string auto_constants(const OrbitShape& shape, const AutoRequest& request) {
  const int k = shape.segments;
  std::string free_parameters = "1";
  for (int s = 0; s < k; ++s) free_parameters += fmt::format(", {}", auto_first_duration + s);
  return fmt::format("NDIM = {}, IPS = 4, IRS = 0, ILP = 0\nICP = [{}]\n", shape.dimension * k, free_parameters) +
         fmt::format("NTST = {}, NCOL = {}, IAD = {}, ISP = 0, ISW = 1, IPLT = 0, NBC = {}, NINT = 0\n",
                     shape.intervals, shape.collocation, request.adapt_every, (shape.dimension + 1) * k) +
         fmt::format("NMX = {}, NPR = 0, MXBF = 0, IID = {}, ITMX = 9, ITNW = {}, NWTN = {}, JAC = 1\n", request.points,
                     request.diagnostics, newton_settings.max_iterations, newton_settings.full_iterations) +
         fmt::format("RL0 = -1e6, RL1 = 1e6, A0 = -1e6, A1 = 1e6\nEPSL = {}, EPSU = {}, EPSS = 1e-5\n",
                     newton_settings.tolerance_parameters, newton_settings.tolerance_states) +
         fmt::format("DS = {}, DSMIN = {}, DSMAX = {}, IADS = 0\nNPAR = {}\n", request.step, request.step / 2,
                     2 * request.step, std::max(36, auto_first_duration + k));
}

}  // namespace tchat::benchmark
