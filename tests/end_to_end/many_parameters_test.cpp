// Problems of more than 60 parameters: the linear impact oscillator forced by a Fourier series whose 120 amplitudes are
// parameters, in C++, formulas, C and Fortran, beside the same oscillator with the amplitudes as constants. Every orbit
// lasts one period of the forcing, 2 pi / omega. And a torus in closed form among 70 parameters.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr int harmonics = 120;
constexpr int amplitudes = harmonics - 1;   // a_2, a_3, ...; alpha is that of the first harmonic
constexpr int parameters = amplitudes + 5;  // then alpha, omega, zeta, r, wall
constexpr double whole_turn = 2.0 * 3.14159265358979323846;
constexpr double period_at_start = whole_turn / 1.9;
const std::vector<std::string> own_names{"alpha", "omega", "zeta", "r", "wall"};
const std::vector<std::string> own_values{"2.0", "1.9", "0.05", "0.8", "1.0"};

/// Amplitude of the k-th harmonic, as an expression.
std::string amplitude(int k) { return fmt::format("0.02/{}.0", k * k); }

struct ParameterLists {
  std::vector<std::string> names, values;
};

ParameterLists parameter_lists(bool all) {
  ParameterLists lists;
  for (int k = 2; all && k <= harmonics; ++k) {
    lists.names.push_back(fmt::format("a{}", k));
    lists.values.push_back(amplitude(k));
  }
  lists.names.insert(lists.names.end(), own_names.begin(), own_names.end());
  lists.values.insert(lists.values.end(), own_values.begin(), own_values.end());
  return lists;
}

/// A list in the text of a program.
std::string listed(const std::vector<std::string>& items, const std::string& quote = "") {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + quote + item + quote;
  return text;
}

/// `all`: the amplitudes are parameters.
std::string cpp_source(bool all) {
  const ParameterLists lists = parameter_lists(all);
  const std::size_t first = lists.names.size() - own_names.size();
  return fmt::format(R"(#include <tchat/problem.hpp>
struct Series {{
  static constexpr int dimension = 4, parameters = {0}, fields = 1, events = 2, jumps = 2;
  static constexpr const char* state_names[] = {{"x1", "x2", "y1", "y2"}};
  static constexpr const char* parameter_names[] = {{{1}}};
  static constexpr const char* event_names[] = {{"wall", "top"}};
  static constexpr double initial_parameters[] = {{{2}}};
  static constexpr double initial_state[] = {{0.0, 0.0, 0.0, 1.0}};
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {{
    const T* own = par + {3};
    T force = own[0] * x[3], before = T(1.0), now = x[3];
    for (int k = 2; k <= {4}; ++k) {{
      const T next = 2.0 * x[3] * now - before;
      before = now;
      now = next;
      force = force + {5} * now;
    }}
    const T away = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1];
    f[1] = force - 2.0 * own[2] * x[1] - x[0];
    f[2] = own[1] * x[3] + x[2] * away;
    f[3] = -own[1] * x[2] + x[3] * away;
  }}
  template <class T>
  T event(int j, const T* x, const T* par) const {{
    return j == 1 ? T(par[{3} + 4] - x[0]) : x[1];
  }}
  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {{
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 1) g[1] = -par[{3} + 3] * x[1];
  }}
  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const {{ return {{{{1, 1, 1}}, {{1, 2, 2}}}}; }}
}};
TCHAT_PROBLEM(Series)
)",
                     lists.names.size(), listed(lists.names, "\""), listed(lists.values), first, harmonics,
                     all ? "par[k - 2]" : "T(0.02 / (k * k))");
}

std::string formulas() {
  const ParameterLists lists = parameter_lists(true);
  std::string text, force = "force = alpha*y2";
  for (std::size_t k = 0; k < lists.names.size(); ++k)
    text += fmt::format("parameter {}={}\n", lists.names[k], lists.values[k]);
  text += "init y2=1\nc2 = 2*y2*y2 - 1\n";
  for (int k = 3; k <= harmonics; ++k)
    text += fmt::format("c{} = 2*y2*c{} - {}\n", k, k - 1, k == 3 ? "y2" : fmt::format("c{}", k - 2));
  for (int k = 2; k <= harmonics; ++k) force += fmt::format(" + a{0}*c{0}", k);
  return text + force + R"(
away = 1 - y1*y1 - y2*y2
x1' = x2
x2' = force - 2*zeta*x2 - x1
y1' = omega*y2 + y1*away
y2' = -omega*y1 + y2*away
event wall = wall - x1
event top = x2
jump impact: x2 -> -r*x2
jump identity: x2 -> x2
after any: wall -> impact, top -> identity
)";
}

/// The table of C, without derivatives.
std::string c_source() {
  const ParameterLists lists = parameter_lists(true);
  return fmt::format(R"(#include <tchat/problem.h>
static void value(const void* self, int32_t kind, int32_t index, const double* x, const double* par, double* out) {{
  const double* own = par + {1};
  double force = own[0] * x[3], before = 1.0, now = x[3];
  const double away = 1.0 - x[2] * x[2] - x[3] * x[3];
  int k;
  (void)self;
  if (kind == TCHAT_EVENT) {{ out[0] = index == 1 ? own[4] - x[0] : x[1]; return; }}
  if (kind == TCHAT_JUMP) {{
    for (k = 0; k < 4; ++k) out[k] = x[k];
    if (index == 1) out[1] = -own[3] * x[1];
    return;
  }}
  for (k = 2; k <= {2}; ++k) {{
    const double next = 2.0 * x[3] * now - before;
    before = now;
    now = next;
    force += par[k - 2] * now;
  }}
  out[0] = x[1];
  out[1] = force - 2.0 * own[2] * x[1] - x[0];
  out[2] = own[1] * x[3] + x[2] * away;
  out[3] = -own[1] * x[2] + x[3] * away;
}}
static const char* const names[] = {{{3}}};
static const double start[] = {{{4}}};
static const double state[] = {{0.0, 0.0, 0.0, 1.0}};
const tchat_problem* tchat_problem_table(void) {{
  static tchat_problem table;
  table.abi_version = TCHAT_PROBLEM_ABI;
  table.struct_size = sizeof table;
  table.dimension = 4;
  table.parameters = {0};
  table.fields = 1;
  table.events = 2;
  table.jumps = 2;
  table.name = "series";
  table.parameter_names = names;
  table.initial_parameters = start;
  table.initial_state = state;
  table.value = value;
  return &table;
}}
)",
                     lists.names.size(), amplitudes, harmonics, listed(lists.names, "\""), listed(lists.values));
}

/// GCDIFF = 0; the parameters are as many as GCNPAR says.
std::string fortran_source() {
  return fmt::format(R"(subroutine gcnpar(npar)
  integer :: npar
  npar = {0}
end subroutine
subroutine gcstpnt(n, x, par, t, segno)
  integer :: n, segno, k
  double precision :: x(n), par(*), t
  do k = 2, {1}
    par(k - 1) = 0.02d0/(k*k)
  end do
  par({2}) = 2d0
  par({3}) = 1.9d0
  par({4}) = 0.05d0
  par({5}) = 0.8d0
  par({6}) = 1d0
end subroutine
subroutine gcfunc(n, x, par, gcidiff, fi, dfidx, dfidp, dfidxdx, dfidxdp, segno)
  integer :: n, gcidiff, segno, k
  double precision :: x(n), par(*), fi(n), dfidx(n, n), dfidp(n, *), dfidxdx(n, n, n), dfidxdp(n, n, *)
  double precision :: force, before, now, next, away
  force = par({2})*x(4)
  before = 1d0
  now = x(4)
  do k = 2, {1}
    next = 2d0*x(4)*now - before
    before = now
    now = next
    force = force + par(k - 1)*now
  end do
  away = 1d0 - x(3)**2 - x(4)**2
  fi(1) = x(2)
  fi(2) = force - 2d0*par({4})*x(2) - x(1)
  fi(3) = par({3})*x(4) + x(3)*away
  fi(4) = -par({3})*x(3) + x(4)*away
end subroutine
subroutine gcbound(n, x, par, gcidiff, h, dhdx, dhdp, dhdxx, dhdxdp, segno)
  integer :: n, gcidiff, segno
  double precision :: x(n), par(*), h, dhdx(n), dhdp(*), dhdxx(n, n), dhdxdp(n, *)
  if (segno == 1) h = par({6}) - x(1)
  if (segno == 2) h = x(2)
end subroutine
subroutine jumpmap(n, u1, par, ujump, coeffres, ujumpdx, ujumpdp, segno)
  integer :: n, segno
  double precision :: u1(n), par(*), ujump(n), coeffres, ujumpdx(n, n), ujumpdp(n, *)
  ujump = u1
  if (segno == 1) ujump(2) = -par({5})*u1(2)
end subroutine
)",
                     parameters, harmonics, amplitudes + 1, amplitudes + 2, amplitudes + 3, amplitudes + 4,
                     amplitudes + 5);
}

Outcome succeed(const Workspace& workspace, const std::vector<std::string>& words) {
  const Outcome outcome = workspace.tchat(words);
  INFO(listed(words) << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome;
}
Outcome succeed(const Workspace& workspace, const std::string& arguments) {
  return succeed(workspace, words_of(arguments));
}

/// The message of a command that fails.
std::string refusal(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat(arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 2);
  return outcome.err;
}

/// PAR indices in the problem with all parameters.
constexpr int alpha = amplitudes + 1, omega = amplitudes + 2, duration = parameters + 1;

/// From a start to grazing, over to the impacting orbit, to its fold, and along the curve of folds in two parameters:
/// files X_smooth, X_impacting and X_folds.
void compute(const Workspace& workspace, const std::string& x, const std::string& first, const std::string& second) {
  succeed(workspace, fmt::format("run {0} -q -d {0} -c {0} -o {0}_smooth ICP=[{1},T1] DS=0.05 RL0=1 RL1=4", x, first));
  succeed(workspace,
          fmt::format("resegment q.{0}_smooth GR1 --to impacting --jump 1 -o {0}_born NMX=60 RL0=1 RL1=3.2", x));
  succeed(workspace, fmt::format("run {0} -q -c {0}_born -s {0}_born -o {0}_impacting EPSS=1e-9 NTST=100", x));
  succeed(workspace, fmt::format("run {0} -q -c r.{0}_impacting -s {0}_impacting -o {0}_folds IRS=LP1 ISW=2 "
                                 "ICP=[{1},{2}] RL0=1 RL1=5 NMX=12",
                                 x, first, second));
}

/// The reference `few`, whose amplitudes are constants.
void compute_reference(const Workspace& workspace) {
  workspace.write("few.cpp", cpp_source(false));
  succeed(workspace, "simulate few -q --dat few");
  compute(workspace, "few", "alpha", "omega");
}

/// Start and constants of `few` for `series`, which has other parameters.
void take_start_of_reference(const Workspace& workspace) {
  std::string constants = workspace.read("gc.few");
  const auto replace = [&constants](const std::string& old, const std::string& text) {
    REQUIRE(constants.find(old) != std::string::npos);
    constants.replace(constants.find(old), old.size(), text);
  };
  replace("ICP = [1, 61]", fmt::format("ICP = [{}, {}]", alpha, duration));
  replace("THL = {61: 0}", fmt::format("THL = {{{}: 0}}", duration));
  replace("PROBLEM = few", "PROBLEM = series");
  replace("GCIDIFF = 2", "GCIDIFF = 0");
  workspace.write("gc.series", constants);
  const std::string data = workspace.read("few.dat");
  workspace.write("series.dat",
                  fmt::format("# PAR({}) = {:.17g}\n", duration, period_at_start) + data.substr(data.find("# tau")));
}

/// Points and labels of a run of `series` are those of the reference.
void check_same(const Workspace& workspace, const std::string& run, double tolerance) {
  CAPTURE(run);
  const PointSection few = workspace.points("few_" + run).front(), many = workspace.points("series_" + run).front();
  const auto near = [tolerance](double value) { return Approx(value).epsilon(tolerance).margin(tolerance); };
  CHECK(many.integer("PARAMETERS") == parameters);
  CHECK(few.constants.count("PARAMETERS") == 0);
  REQUIRE(many.rows.size() == few.rows.size());
  for (std::size_t k = 0; k < few.rows.size(); ++k) {
    CAPTURE(k);
    CHECK(many.rows[k].point == few.rows[k].point);
    CHECK(many.rows[k].type == few.rows[k].type);
    CHECK(many.rows[k].label == few.rows[k].label);
    REQUIRE(many.rows[k].values.size() == few.rows[k].values.size());
    for (std::size_t c = 0; c < few.rows[k].values.size(); ++c)
      CHECK(many.rows[k].values[c] == near(few.rows[k].values[c]));
  }
  const auto expected = workspace.solutions("few_" + run), labels = workspace.solutions("series_" + run);
  REQUIRE(labels.size() == expected.size());
  for (std::size_t k = 0; k < labels.size(); ++k) {
    CAPTURE(k);
    CHECK(labels[k].type == expected[k].type);
    CHECK(labels[k].free_parameters.back() == duration);
    CHECK(labels[k].problem_parameters == parameters);
    CHECK(expected[k].problem_parameters == 0);
    for (int a = 2; a <= harmonics; ++a) CHECK(labels[k].parameter(a - 1) == Approx(0.02 / (a * a)).epsilon(1e-15));
    for (int own = 1; own <= 5; ++own) CHECK(labels[k].parameter(amplitudes + own) == near(expected[k].parameter(own)));
    CHECK(labels[k].parameter(duration) == near(expected[k].parameter(61)));
    CHECK(labels[k].parameter(duration) * labels[k].parameter(omega) == Approx(whole_turn).epsilon(1e-8));
  }
}

void check_all(const Workspace& workspace, double tolerance) {
  for (const char* run : {"smooth", "impacting", "folds"}) check_same(workspace, run, tolerance);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("120 amplitudes as parameters of a C++ class give the branches that constant amplitudes give") {
  const Workspace workspace;
  compute_reference(workspace);
  workspace.write("series.cpp", cpp_source(true));
  succeed(workspace, "check series");
  succeed(workspace, "simulate series -q --dat series");
  CHECK(contains(workspace.read("series.dat"), fmt::format("# PAR({}) = ", duration)));
  compute(workspace, "series", "alpha", "omega");
  check_all(workspace, 1e-8);

  CHECK(contains(succeed(workspace, "verify q.series_impacting LP1 -p series").out,
                 "1 label agrees with forward integration"));
  const std::string labels = succeed(workspace, "labels series_impacting").out;
  CHECK(contains(labels, "alpha = 2.07430"));
  CHECK_FALSE(contains(labels, fmt::format("PAR({})", duration)));
  const std::string table = succeed(workspace, "table series_impacting --column a100 --column T1 --column zeta").out;
  CHECK(contains(table, "2e-06"));
  CHECK(contains(table, "3.30693"));
  succeed(workspace, "plot p.series_impacting -x alpha -y T1 -o branch.svg");
  succeed(workspace, "plot q.series_impacting LP1 -p series -o orbit.svg");
  CHECK(contains(workspace.read("orbit.svg"), "2.0743"));

  // A restart on the same branch meets the same points again; a period of two forcing periods has two durations.
  succeed(workspace, "run series -q -c r.series_impacting -s series_impacting -o again IRS=LP1 DS=-0.05 NMX=4");
  CHECK(workspace.solutions("again").back().parameter(duration) == Approx(period_at_start).epsilon(1e-9));
  succeed(workspace, "resegment q.series_impacting LP1 --to double -o twice");
  CHECK(contains(workspace.read("gc.twice"), fmt::format("{}, {}]", duration, duration + 1)));
  succeed(workspace, "run series -q -c twice -s twice -o doubled NMX=3");
  CHECK(workspace.solutions("doubled").back().parameter(duration + 1) == Approx(period_at_start).epsilon(1e-9));

  // An amplitude beyond PAR(60) moves the orbit; its name, its number, bounds, user values and monitors.
  succeed(workspace,
          std::vector<std::string>{"run", "series", "-q", "-c", "r.series_smooth", "-s", "series_smooth", "-o", "user",
                                   "IRS=1", "ICP=[a70,velocity(1)]", "UZR={69: 0.001}", "BOUNDS={a70: [0, 0.004]}",
                                   "THL={a70: 2, T1: 0}", "NMX=30", "DS=0.001", "RL0=-1", "RL1=1"});
  const auto moved = workspace.solutions("user");
  CHECK(std::any_of(moved.begin(), moved.end(), [](const SolutionEntry& label) {
    return label.type == -4 && std::abs(label.parameter(69) - 0.001) < 1e-9;
  }));
}

TEST_CASE("120 amplitudes as parameters of formulas") {
  const Workspace workspace;
  compute_reference(workspace);
  workspace.write("series.tch", formulas());
  succeed(workspace, "simulate series -q --dat series");
  compute(workspace, "series", "alpha", "omega");
  check_all(workspace, 1e-7);
}

TEST_CASE("120 amplitudes as parameters of a table of C, which gives no derivatives") {
  const Workspace workspace;
  compute_reference(workspace);
  take_start_of_reference(workspace);
  workspace.write("series.c", c_source());
  const Outcome compiled =
      workspace.shell("cc -std=c99 -O2 -shared -fPIC -I'" CONTRACT_INCLUDE "' -o series.so series.c -lm");
  INFO(compiled.text());
  REQUIRE(compiled.status == 0);
  compute(workspace, "series", "alpha", "omega");
  check_all(workspace, 1e-5);
}

TEST_CASE("120 amplitudes as parameters of Fortran's GCNPAR") {
  const Workspace workspace;
  if (workspace.shell("gfortran --version").status != 0) return;
  compute_reference(workspace);
  take_start_of_reference(workspace);
  workspace.write("series.f90", fortran_source());
  compute(workspace, "series", fmt::format("{}", alpha), fmt::format("{}", omega));
  check_all(workspace, 1e-5);
}

TEST_CASE("numbers that are neither parameters nor durations, where durations begin behind 124 parameters") {
  const Workspace workspace;
  workspace.write("series.cpp", cpp_source(true));
  succeed(workspace, "simulate series -q --dat series");
  const std::string run = "run series -q -c series -d series -o wrong NMX=2 ";
  const std::string allowed = "1 to 124 (parameters of the problem) or 125 (the duration of the segment)";
  CHECK(contains(refusal(workspace, run + "ICP=[alpha,126]"), "ICP(2)"));
  CHECK(contains(refusal(workspace, run + "ICP=[alpha,126]"), allowed));
  CHECK(contains(refusal(workspace, run + "THL={200:0}"), allowed));
  CHECK(contains(refusal(workspace, run + "ICP=[alpha,T2]"), allowed));
  CHECK(contains(refusal(workspace, run + "PAR(130)=1"), "PAR(130)"));
  CHECK(contains(refusal(workspace, run + "ICP=[125]"), "0 parameters that are not durations"));
  CHECK(contains(refusal(workspace, run + "ICP=[rho]"), "rotation number of a torus"));
  CHECK(contains(refusal(workspace, run + "PAR(beta)=1"), "PAR(125), ... are the durations"));
  workspace.write("series.dat", "# PAR(5000) = 1\n" + workspace.read("series.dat"));
  CHECK(contains(refusal(workspace, run), "PAR(5000) is neither a parameter of problem Series, which has 124, nor"));
}

TEST_CASE("a curve of grazing in two parameters beyond the 60th, and a held monitor") {
  const Workspace workspace;
  compute_reference(workspace);
  workspace.write("series.cpp", cpp_source(true));
  succeed(workspace, "simulate series -q --dat series");
  succeed(workspace, "run series -q -d series -c series -o series_smooth ICP=[alpha,T1] DS=0.05 RL0=1 RL1=4");
  for (const std::string x : {"few", "series"}) {
    succeed(workspace, fmt::format("resegment q.{0}_smooth GR1 --to grazing-curve -o {0}_from ICP=[alpha,omega]", x));
    succeed(workspace, fmt::format("run {0} -q -c {0}_from -s {0}_from -o {0}_grazing NMX=8", x));
    succeed(workspace, fmt::format("run {0} -q -c r.{0}_smooth -s {0}_smooth -o {0}_held IRS=1 ICP=[alpha,zeta] "
                                   "HOLD=[max(x1)] NMX=6 DS=0.01",
                                   x));
  }
  check_same(workspace, "grazing", 1e-8);
  check_same(workspace, "held", 1e-8);
}

TEST_CASE("a boundary value problem of 1000 parameters gives what it gives with two") {
  // A quarter period of the pendulum, cut at half the amplitude, and an integral of its square.
  const Workspace workspace;
  for (const int count : {2, 1000}) {
    const std::string name = fmt::format("pendulum{}", count);
    workspace.write(name + ".cpp", fmt::format(R"(#include <tchat/problem.hpp>
struct Pendulum {{
  static constexpr int dimension = 2, parameters = {0}, fields = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {{ f[0] = x[1], f[1] = -sin(x[0]); }}
  static constexpr int boundary_conditions = 6;
  template <class T>
  void boundary(const tchat::Ends<T>& x, const T* par, T* b) const {{
    b[0] = x.start(1)[0] - par[{0} - 2];
    b[1] = x.start(1)[1];
    b[2] = x.end(1)[0] - 0.5 * par[{0} - 2];
    for (int i = 0; i < 2; ++i) b[3 + i] = x.start(2)[i] - x.end(1)[i];
    b[5] = x.end(2)[0];
  }}
  static constexpr int integral_conditions = 1;
  template <class T>
  void integrand(int, const T* x, const T* par, const T* durations, T* q) const {{
    q[0] = x[0] * x[0] - par[{0} - 1] * durations[0];
  }}
}};
TCHAT_PROBLEM(Pendulum)
)",
                                               count));
    const int durations = std::max(count, 60);
    std::string data = fmt::format("# PAR({}) = 0.1, PAR({}) = 0.008, PAR({}) = 1.0472, PAR({}) = 0.5236\n", count - 1,
                                   count, durations + 1, durations + 2);
    for (int k = 0; k <= 20; ++k) {
      const double first = 1.0472 * k / 20, second = 1.0472 + 0.5236 * k / 20;
      data += fmt::format("{} {} {} {} {}\n", k / 20.0, 0.1 * std::cos(first), -0.1 * std::sin(first),
                          0.1 * std::cos(second), -0.1 * std::sin(second));
    }
    workspace.write(name + ".dat", data);
    workspace.write("gc." + name, fmt::format("NDIM=2, IPS=4, NBC=6, NINT=1, GCFIND=[1,1], ICP=[{},{},T1,T2], NTST=20, "
                                              "NMX=10, DS=0.05, EPSL=1e-10, EPSU=1e-10\n",
                                              count - 1, count));
    succeed(workspace, fmt::format("run {} -q", name));
  }
  // The check knows no durations, on which this integrand depends; the conditions and the field are sound.
  const std::string checked = workspace.tchat("check pendulum1000").text();
  CHECK(contains(checked, "boundary conditions 1 to 6"));
  CHECK_FALSE(contains(checked, "d b_"));
  CHECK_FALSE(contains(checked, "d f_"));
  const PointSection few = workspace.points("pendulum2").front(), many = workspace.points("pendulum1000").front();
  REQUIRE(many.rows.size() == few.rows.size());
  for (std::size_t k = 0; k < few.rows.size(); ++k)
    for (std::size_t c = 0; c < few.rows[k].values.size(); ++c)
      CHECK(many.rows[k].values[c] == Approx(few.rows[k].values[c]).epsilon(1e-9).margin(1e-9));
  const SolutionEntry last = workspace.solutions("pendulum1000").back();
  CHECK(last.parameter(1001) + last.parameter(1002) ==
        Approx(std::comp_ellint_1(std::sin(0.5 * last.parameter(999)))).epsilon(1e-7));
}

TEST_CASE("a conservative family among 100 further parameters") {
  const Workspace workspace;
  std::string text = "par q1=1";
  for (int k = 2; k <= 100; ++k) text += fmt::format(", q{}=1", k);
  workspace.write("ball.tch", text + "\nx' = v\nv' = -1\nevent wall = x\njump bounce: v -> -v\naux energy = v^2/2+x\n");
  workspace.write("gc.ball", "NDIM=2 IPS=180 CONSERVED=energy ICP=[energy,period] NTST=5 NMX=6 DS=0.1 IAD=0\n");
  text = "# PAR(101) = 2\n";
  for (const double tau : {0.0, 0.25, 0.5, 0.75, 1.0})
    text += fmt::format("{} {} {}\n", tau, 2.0 * tau * (1.0 - tau), 1.0 - 2.0 * tau);
  workspace.write("ball.dat", text);
  succeed(workspace, "run ball -q");
  const PointSection section = workspace.points("ball").front();
  for (const PointRow& row : section.rows)
    CHECK(row.values[section.column("energy")] ==
          Approx(std::pow(row.values[section.column("period")], 2) / 8.0).epsilon(1e-9));
  CHECK(section.rows.back().values[section.column("energy")] > 0.7);
}

TEST_CASE("a line # PAR(100) = v of the data sets the 100th parameter") {
  const Workspace workspace;
  workspace.write("series.cpp", cpp_source(true));
  succeed(workspace, "simulate series -q --dat series");
  workspace.edit("series.dat", "# PAR(100) = ", "# PAR(100) = 0.00025\n# was ");
  succeed(workspace, "run series -q -c series -d series -o data NMX=2 ICP=[alpha,T1]");
  CHECK(workspace.solutions("data").front().parameter(100) == 0.00025);
  CHECK(workspace.solutions("data").front().parameter(99) == Approx(0.02 / (100 * 100)));
}

TEST_CASE("a problem that gets further parameters restarts from the labels of the smaller one") {
  const Workspace workspace;
  compute_reference(workspace);
  // The same class with 120 more parameters, behind its own.
  std::string source = cpp_source(false);
  source.replace(source.find("parameters = 5"), 14, "parameters = 125");
  source.erase(source.find("  static constexpr const char* parameter_names"),
               source.find("  static constexpr const char* event_names") -
                   source.find("  static constexpr const char* parameter_names"));
  source.erase(source.find("  static constexpr double initial_parameters"),
               source.find("  static constexpr double initial_state") -
                   source.find("  static constexpr double initial_parameters"));
  workspace.write("grown.cpp", source);
  succeed(workspace, "run grown -q -c r.few_impacting -s few_impacting -o grown ICP=[1,T1] THL={T1:0} IRS=LP1 NMX=3");
  const SolutionEntry label = workspace.solutions("grown").back();
  CHECK(label.parameter(126) == Approx(period_at_start).epsilon(1e-9));
  CHECK(label.parameter(61) == 0.0);
  CHECK(label.parameter(2) == 1.9);
}

namespace {

/// The torus of problems/torus with `more` parameters before its own, which do nothing.
std::string torus_source(const Workspace& workspace, int more) {
  workspace.shell("cp '" TORUS_SOURCE "' torus_of_problem.txt");
  std::string source = workspace.read("torus_of_problem.txt");
  const auto replace = [&source](const std::string& old, const std::string& text) {
    REQUIRE(source.find(old) != std::string::npos);
    source.replace(source.find(old), old.size(), text);
  };
  std::string names, values;
  for (int k = 1; k <= more; ++k) {
    names += fmt::format("\"q{}\", ", k);
    values += "0.5, ";
  }
  replace("parameters = 3", fmt::format("parameters = {}", 3 + more));
  replace("{\"omega\"", "{" + names + "\"omega\"");
  replace("{1.0, 1.618", "{" + values + "1.0, 1.618");
  replace("&omega = par[0], &Omega = par[1]", fmt::format("&omega = par[{}], &Omega = par[{}]", more, more + 1));
  replace("par[2] - u[0]", fmt::format("par[{}] - u[0]", more + 2));
  return source;
}

}  // namespace

TEST_CASE("tori of problems of 60 and more parameters have rho behind their durations") {
  const Workspace workspace;
  const std::vector<std::pair<std::string, int>> problems{{"few", 0}, {"sixty", 57}, {"many", 67}};
  for (const auto& [name, more] : problems) {
    CAPTURE(name);
    workspace.write(name + ".cpp", torus_source(workspace, more));
    workspace.shell(fmt::format("cp '{}' gc.{}", TORUS_CONSTANTS, name));
    succeed(workspace, fmt::format("simulate {0} -q -c {0} --torus {0}_found NTST=12 NCOL=4", name));
    succeed(workspace,
            fmt::format("run {0} -q -c {0} -s {0}_found -o {0} NTST=12 NCOL=4 NMX=6 UZR={{rho:0.3512345}}", name));
    CHECK(contains(succeed(workspace, fmt::format("labels {}", name)).out, "rho = "));
    const PointSection section = workspace.points(name).front(), few = workspace.points("few").front();
    REQUIRE(section.rows.size() == few.rows.size());
    for (std::size_t k = 0; k < few.rows.size(); ++k) {
      CHECK(section.rows[k].values[section.column("rho")] ==
            Approx(few.rows[k].values[few.column("rho")]).epsilon(1e-9));
      // Closed form: the angle turns with Omega, once a return, and the phase of the forcing by omega / Omega.
      const double rate = section.rows[k].values[section.column("omega")] / 1.618033988749895;
      CHECK(section.rows[k].values[section.column("rho")] == Approx(std::ceil(rate) - rate).epsilon(1e-8));
    }
    const SolutionEntry last = workspace.solutions(name).back();
    const int durations = std::max(60, 3 + more);
    const int rho = more == 0 ? 60 : durations + 257;
    CHECK(last.parameter(rho) == Approx(few.rows.back().values[few.column("rho")]).epsilon(1e-9));
    // A restart, and two other parameters with rho fixed.
    succeed(workspace,
            fmt::format("run {0} -q -c r.{0} -s {0} -o {0}_fixed IRS=UZ1 ICP=[omega,Omega] UZR={{}} NMX=3", name));
    CHECK(workspace.solutions(name + "_fixed").back().parameter(rho) == Approx(0.3512345).epsilon(1e-8));
    CHECK(succeed(workspace, fmt::format("verify q.{0}_fixed -p {0}", name)).status == 0);
  }
}
