// Fortran sources: compiled when something changed, with TC-HAT's includes, with gfortran's own messages.
#include <catch2/catch.hpp>
#include <filesystem>

#include "base/messages.hpp"
#include "fortran_sources.hpp"
#include "plugin/problem_library.hpp"
#include "plugin_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

const PluginBuildOptions build_options = {"", TCHAT_TEST_INCLUDE};

/// a of GCSTPNT, as the library has it.
double first_parameter(const std::string& path) {
  const ProblemLibrary library(path, [] { return fortran_sizes(1); });
  return library.system().table().initial_parameters[0];
}

std::string with_includes() {
  return spoilt("      DIMENSION X(GCNDIM),PAR(*)\n      PAR(1)=2.0D0\n",
                "      include \"gccont.h\"\n"
                "      DIMENSION X(GCNDIM),PAR(*)\n"
                "      START=2.0D0\n"
                "      INCLUDE 'pend.h'\n"
                "      IF (DEBUG.AND.DBGLEV.GE.DBGL2) START=0.0D0\n"
                "      PAR(1)=START\n");
}

}  // namespace

TEST_CASE("Fortran sources by every name, in fixed and free form") {
  const PluginFolder folder;
  folder.write("pend.f", fortran_source());
  CHECK(resolve_plugin(folder / "pend", build_options) == folder / "pend.so");
  CHECK(folder.entries() == 2);
  const auto made = fs::last_write_time(folder / "pend.so");
  CHECK(resolve_plugin(folder / "pend.f", build_options) == folder / "pend.so");
  CHECK(fs::last_write_time(folder / "pend.so") == made);

  std::string free_form = fortran_source();
  for (std::size_t at = 0; (at = free_form.find("\n     +", at)) != std::string::npos;)
    free_form.replace(at, 7, " &\n ");
  folder.write("free.f90", "module constants\n  double precision :: a = 3d0\nend module\n" + free_form);
  CHECK(first_parameter(resolve_plugin(folder / "free", build_options)) == 2.0);
  CHECK(folder.entries() == 4);  // no module file is left
}

TEST_CASE("a missing header NAME.h is empty, when it appears or changes, the source is compiled again") {
  const PluginFolder folder;
  folder.write("pend.f", with_includes());
  const auto value = [&] { return first_parameter(resolve_plugin(folder / "pend", build_options)); };
  CHECK(value() == 2.0);
  const auto made = fs::last_write_time(folder / "pend.so");
  CHECK(value() == 2.0);
  CHECK(fs::last_write_time(folder / "pend.so") == made);
  folder.write("pend.h", "      START=5.0D0\n");
  CHECK(value() == 5.0);
  folder.write("pend.h", "      START=6.0D0\n");
  CHECK(value() == 6.0);
  fs::remove(folder / "pend.h");
  CHECK(value() == 2.0);

  folder.write("other.f", with_includes());
  CHECK_THROWS_WITH(resolve_plugin(folder / "other", build_options), Contains("pend.h"));
}

TEST_CASE("the library of NAME.cpp is not taken for that of NAME.f") {
  const PluginFolder folder;
  folder.write("pend.cpp", small_plugin());
  resolve_plugin(folder / "pend", build_options);
  fs::remove(folder / "pend.cpp");
  folder.write("pend.f", fortran_source());
  fs::last_write_time(folder / "pend.f", fs::last_write_time(folder / "pend.so") - std::chrono::hours(1));
  CHECK(first_parameter(resolve_plugin(folder / "pend", build_options)) == 2.0);
}

TEST_CASE("lines of fixed form longer than 72 columns are not cut") {
  const PluginFolder folder;
  folder.write("pend.f", spoilt("PAR(1)=2.0D0", "PAR(1)=0.1D0+0.2D0+0.3D0+0.4D0+0.5D0+0.6D0+0.7D0+0.8D0+0.9D0+1.0D0"));
  CHECK(first_parameter(resolve_plugin(folder / "pend", build_options)) == Approx(5.5));
}

TEST_CASE("a Fortran source that does not compile, and no Fortran compiler") {
  const PluginFolder folder;
  folder.write("pend.f", spoilt("FI(1)=X(2)", "FI(1)=X(2"));
  CHECK_THROWS_WITH(resolve_plugin(folder / "pend", build_options),
                    Contains("pend.f:10") && Contains("FI(1)=X(2") && Contains("Error") && Contains("gfortran"));
  CHECK_THROWS_AS(resolve_plugin(folder / "pend", build_options), UserError);
  CHECK(folder.entries() == 1);
  CHECK_THROWS_WITH(resolve_plugin(folder / "pend", {"", TCHAT_TEST_INCLUDE, "no-such-fortran"}),
                    Contains("no Fortran compiler") && Contains("no-such-fortran") && Contains("FC"));
}
