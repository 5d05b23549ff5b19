// The Fortran interface as a problem: values, derivatives of every order against closed forms, starting values, faults.
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "base/messages.hpp"
#include "fortran_sources.hpp"
#include "model/derivative_check.hpp"
#include "plugin/exit_guard.hpp"
#include "plugin/problem_library.hpp"
#include "plugin_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;

namespace {

const PluginBuildOptions build_options = {"", TCHAT_TEST_INCLUDE};

std::string compiled(const PluginFolder& folder, const std::string& source, const std::string& name = "pend.f") {
  return resolve_plugin(folder.write(name, source), build_options);
}

ProblemLibrary::Sizes sizes_of(int order, int dimension = 2) {
  return [=] { return fortran_sizes(order, dimension); };
}

constexpr double a = 1.9, b = 0.6, r = 0.7;
const double x[] = {0.4, -0.3};

std::vector<double> parameters() {
  std::vector<double> par(TCHAT_PAR_LENGTH, 0.0);
  par[0] = a, par[1] = b, par[2] = r;
  return par;
}

}  // namespace

TEST_CASE("a Fortran plugin: values, first and second derivatives for every GCIDIFF") {
  const PluginFolder folder;
  const std::string path = compiled(folder, fortran_source());
  const int order = GENERATE(0, 1, 2);
  const ProblemLibrary library(path, sizes_of(order));
  const HybridSystem& system = library.system();
  REQUIRE(system.name() == "pend");
  REQUIRE(system.dimension() == 2);
  REQUIRE(system.parameters() == 3);  // GCSTPNT sets three
  REQUIRE(system.count(FunctionKind::event) == 2);
  const std::vector<double> par = parameters();
  const std::vector<int> active = {1, 3, 2};
  double out[2], dx[4], dp[6];
  const double first_error = order == 0 ? 1e-12 : 1e-15;
  const double second_error = order == 0 ? 1e-9 : order == 1 ? 1e-12 : 1e-14;

  const double twice[] = {-1.5, 2.0, x[0], x[1]};  // the second of two points
  double outs[4], dxs[8], dps[12];
  system.first_at_points(FunctionKind::field, 1, 2, twice, par.data(), active, outs, dxs, dps);
  system.first(FunctionKind::field, 1, x, par.data(), active, out, dx, dp);
  CHECK(std::equal(out, out + 2, outs + 2));
  CHECK(std::equal(dx, dx + 4, dxs + 4));
  CHECK(std::equal(dp, dp + 6, dps + 6));
  CHECK(out[1] == Approx(-a * std::sin(0.4) - b * 0.09).epsilon(1e-15));
  CHECK(std::abs(dx[0]) < first_error);
  CHECK(std::abs(dx[2] - 1.0) < first_error);
  CHECK(std::abs(dx[1] + a * std::cos(0.4)) < first_error);
  CHECK(std::abs(dx[3] - 2.0 * b * 0.3) < first_error);
  CHECK(std::abs(dp[1] + std::sin(0.4)) < first_error);  // by PAR(1)
  CHECK(std::abs(dp[3]) < first_error);                  // by PAR(3)
  CHECK(std::abs(dp[5] + 0.09) < first_error);           // by PAR(2)

  // Along (v, w): D = f_x v + f_p w.
  const double direction[] = {0.7, -1.1, 0.4, 0.2, -0.5};
  system.second(FunctionKind::field, 1, x, par.data(), active, direction, out, dx, dp);
  CHECK(std::abs(out[1] - (-a * std::cos(0.4) * 0.7 + 0.6 * b * -1.1 - std::sin(0.4) * 0.4 + 0.09 * 0.5)) < 1e-11);
  CHECK(std::abs(dx[1] - (a * std::sin(0.4) * 0.7 - std::cos(0.4) * 0.4)) < second_error);
  CHECK(std::abs(dx[3] - (-2.0 * b * -1.1 + 0.6 * -0.5)) < second_error);
  CHECK(std::abs(dp[1] + std::cos(0.4) * 0.7) < std::max(second_error, 1e-12));
  CHECK(std::abs(dp[5] - 0.6 * -1.1) < std::max(second_error, 1e-12));

  // The jump: JUMPMAP leaves UJUMPDP at zero.
  system.first(FunctionKind::jump, 1, x, par.data(), active, out, dx, dp);
  CHECK(out[1] == Approx(0.3 * r));
  CHECK(std::abs(dx[3] + r) < first_error);
  CHECK(dp[2] == 0.0);
  CHECK(std::abs(dp[3] - 0.3) < 1e-12);
  system.second(FunctionKind::jump, 1, x, par.data(), active, direction, out, dx, dp);
  CHECK(std::abs(dx[3] + 0.2) < 1e-9);

  const double event_direction[] = {0.7, -1.1, 0.0, 0.0, 0.0};
  system.second(FunctionKind::event, 2, x, par.data(), active, event_direction, out, dx, dp);
  CHECK(std::abs(out[0] - (-0.3 * 0.7 - 0.4 * 1.1)) < 1e-12);
  CHECK(std::abs(dx[0] + 1.1) < second_error);
  CHECK(std::abs(dx[1] - 0.7) < second_error);

  CHECK(check_derivatives(system).fine());
  const std::vector<std::string> notes = library.derivative_notes();
  REQUIRE_FALSE(notes.empty());
  CHECK_THAT(notes.front(), Contains("central differences"));
}

TEST_CASE("a Fortran plugin's starting values: parameters, durations, PVLS") {
  const PluginFolder folder;
  const std::string path = compiled(folder, fortran_source() + R"(      SUBROUTINE GCPVLS(GCNDIM,X,PAR,SEGNO)
      IMPLICIT DOUBLE PRECISION (A-H,O-Z)
      INTEGER GCNDIM,SEGNO
      DIMENSION X(GCNDIM),PAR(*)
      PAR(10+SEGNO)=X(1)+X(2)
      X(1)=99.0D0
      END
)");
  const ProblemLibrary library(path, sizes_of(1));
  const tchat_problem& table = library.system().table();
  CHECK(table.initial_parameters[1] == 0.5);
  REQUIRE(table.durations == 2);
  CHECK(table.initial_durations[0] == 1.5);
  CHECK(std::isnan(table.initial_durations[1]));  // GCSTPNT does not set PAR(62)
  REQUIRE(table.output_parameters != nullptr);
  std::vector<double> par = parameters();
  table.output_parameters(table.self, 2, x, par.data());
  CHECK(par[11] == Approx(0.1));
  CHECK(x[0] == 0.4);
}

TEST_CASE("Fortran plugins that do not fit the constants, or forget an output") {
  const PluginFolder folder;
  const std::string path = compiled(folder, fortran_source());
  CHECK_THROWS_WITH(ProblemLibrary(path), Contains("Fortran plugin") && Contains("constants file"));
  CHECK_THROWS_WITH(ProblemLibrary(path, sizes_of(1, 1)), Contains("more than GCNDIM = 1") && Contains("NDIM"));
  CHECK_THROWS_WITH(ProblemLibrary(path, sizes_of(1, 3)), Contains("FI(3) unset") && Contains("NDIM = 3"));
  const auto with_third_event = [] {
    ProblemSizes sizes = fortran_sizes(1);
    sizes.events = {1, 3};
    return sizes;
  };
  CHECK_THROWS_WITH(ProblemLibrary(path, with_third_event),
                    Contains("GCBOUND") && Contains("SEGNO = 3") && Contains("GCHIND"));

  const std::string forgets = compiled(folder, spoilt("FI(2)=", "FI2="), "forgets.f");
  CHECK_THROWS_WITH(ProblemLibrary(forgets, sizes_of(1)), Contains("SEGNO = 1 leaves FI(2) unset"));
  const std::string infinite = compiled(folder, spoilt("PAR(2)=0.5D0", "PAR(2)=1.0D0/PAR(9)"), "infinite.f");
  CHECK_THROWS_WITH(ProblemLibrary(infinite, sizes_of(1)), Contains("GCSTPNT sets PAR(2)"));
  const std::string missing = compiled(folder, spoilt("SUBROUTINE JUMPMAP", "SUBROUTINE JUMPMAPS"), "missing.f");
  CHECK_THROWS_WITH(ProblemLibrary(missing, sizes_of(1)), Contains("SUBROUTINE JUMPMAP is missing"));
  CHECK_THROWS_AS(ProblemLibrary(missing, sizes_of(1)), UserError);
}

TEST_CASE("every wrong derivative of a Fortran plugin is named") {
  const PluginFolder folder;
  std::string source = spoilt("DFIDX(2,2)=-2.0D0", "DFIDX(2,2)=-3.0D0");
  source.replace(source.find("DFIDP(2,2)="), 11, "DFIDP(1,2)=");
  const std::string path = compiled(folder, source);
  const ProblemLibrary library(path, sizes_of(1));
  DerivativeCheckOptions options;
  options.states = {Eigen::Vector2d(0.4, -0.3)};
  options.parameters = Eigen::Vector3d(a, b, r);
  options.random_states = 0;
  const DerivativeCheck check = check_derivatives(library.system(), options);
  REQUIRE_FALSE(check.fine());
  const std::vector<std::string>& faults = check.functions.front().faults;
  REQUIRE(faults.size() == 3);
  CHECK_THAT(faults[0], Contains("f_1[U(1)] / d PAR(2) is -0.09, differences give 0"));
  CHECK_THAT(faults[1], Contains("f_1[U(2)] / d U(2) is 0.54, differences give 0.36"));
  CHECK_THAT(faults[2], Contains("f_1[U(2)] / d PAR(2) is 0, differences give -0.09"));
}

TEST_CASE("STOP in a Fortran plugin ends the process with status 2, named") {
  const PluginFolder folder;
  const std::string path = compiled(folder, fortran_source());
  const pid_t child = fork();
  if (child == 0) {
    if (freopen((folder / "stderr").c_str(), "w", stderr) == nullptr) _exit(99);
    const ExitGuard guard(path);
    const ProblemLibrary library(path, [] {
      ProblemSizes sizes = fortran_sizes(1);
      sizes.fields = {2};
      return sizes;
    });
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(WEXITSTATUS(status) == 2);
  CHECK_THAT(folder.read("stderr"), Contains("pend.so ended the process"));
}
