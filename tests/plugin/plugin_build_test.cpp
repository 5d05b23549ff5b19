#include "plugin/plugin_build.hpp"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdlib>
#include <vector>

#include "base/messages.hpp"
#include "plugin/build_stamp.hpp"
#include "plugin/problem_library.hpp"
#include "plugin_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// An environment variable changed for one test.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    const char* const before = std::getenv(name);
    had_ = before != nullptr;
    if (had_) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Environment() { had_ ? setenv(name_, before_.c_str(), 1) : unsetenv(name_); }

 private:
  const char* name_;
  bool had_ = false;
  std::string before_;
};

void make_older(const std::string& file, std::chrono::seconds by) {
  fs::last_write_time(file, fs::last_write_time(file) - by);
}

int dimension_of(const std::string& library) { return ProblemLibrary(library).system().dimension(); }

/// Runs `action` in a process of its own: 0, or 1 when it throws.
template <class Action>
pid_t start_process(const Action& action) {
  const pid_t child = fork();
  if (child != 0) return child;
  int status = 0;
  try {
    action();
  } catch (...) {
    status = 1;
  }
  _exit(status);
}

int wait_for(pid_t child) {
  int status = -1;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Takes from root the right to write everywhere; others lack it already.
void become_nobody() {
  if (geteuid() != 0) return;
  if (setresgid(65534, 65534, 65534) != 0 || setresuid(65534, 65534, 65534) != 0) _exit(98);
}

}  // namespace

TEST_CASE("tchat's header is read once for the plugins of a compiler", "[compiles]") {
  const PluginFolder folder;
  const Environment cache("XDG_CACHE_HOME", folder / "cache");
  fs::copy(TCHAT_TEST_INCLUDE, folder / "include", fs::copy_options::recursive);
  PluginBuildOptions options = folder.counting_compiler();
  options.include_folder = folder / "include";
  const auto made = [&]() -> std::string {
    for (const auto& one : fs::directory_iterator(folder / "cache/tchat"))
      if (fs::exists(one.path() / "tchat/problem.hpp.gch")) return one.path() / "tchat/problem.hpp.gch";
    return "";
  };
  const auto dimension = [&](const std::string& name) {
    folder.write(name + ".cpp", R"(#include <tchat/problem.hpp>
struct Oscillator {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  template <class T> void field(int, const T* x, const T* par, T* f) const { f[0] = x[1]; f[1] = -par[0] * x[0]; }
};
TCHAT_PROBLEM(Oscillator)
)");
    return dimension_of(resolve_plugin(folder / name, options));
  };
  CHECK(dimension("first") == 2);
  CHECK(made().empty());  // a header that is asked for once is not worth its time
  CHECK(dimension("second") == 2);
  REQUIRE_FALSE(made().empty());
  CHECK(dimension("third") == 2);
  CHECK(folder.compilations() == 3);

  // The headers behind it decide whether a plugin is up to date.
  resolve_plugin(folder / "third", options);
  CHECK(folder.compilations() == 3);
  folder.write("include/tchat/sliding.hpp", folder.read("include/tchat/sliding.hpp") + "// changed\n");
  resolve_plugin(folder / "third", options);
  CHECK(folder.compilations() == 4);
  CHECK(dimension("fourth") == 2);

  // Another header before it.
  folder.write("seventh.cpp", "#include <cmath>\n" + folder.read("third.cpp"));
  CHECK(dimension_of(resolve_plugin(folder / "seventh", options)) == 2);
  const std::string log = folder.read("log");
  CHECK_THAT(log.substr(log.rfind('\n', log.size() - 2)), Contains("-include") && Contains("seventh.cpp"));

  // A second include beside it, in a header of the user's.
  folder.write("own.hpp", "#include <tchat/problem.hpp>\nconstexpr double stiffness = 2.0;\n");
  folder.write("sixth.cpp", R"(#include <tchat/problem.hpp>
#include "own.hpp"
struct Oscillator {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  template <class T> void field(int, const T* x, const T*, T* f) const { f[0] = x[1]; f[1] = -stiffness * x[0]; }
};
TCHAT_PROBLEM(Oscillator)
)");
  CHECK(dimension_of(resolve_plugin(folder / "sixth", options)) == 2);

  // One that was not written to its end does no harm.
  for (const auto& one : fs::directory_iterator(folder / "cache/tchat"))
    if (fs::exists(one.path() / "tchat/problem.hpp.gch")) fs::resize_file(one.path() / "tchat/problem.hpp.gch", 100000);
  CHECK(dimension("fifth") == 2);
}

TEST_CASE("a precompiled header comes before comments and system headers, not before what may change its meaning") {
  const PluginFolder folder;
  const auto comes_first = [&](const std::string& begin) {
    return can_come_first(folder.write("source.cpp", begin + "\n#include \"tchat/problem.hpp\"  // a comment\n"));
  };
  CHECK(comes_first(""));
  CHECK(comes_first("// one\n/* two\n#define THREE\n*/\r\n#include <cmath>\n/* four */\n  #include <array>"));
  CHECK(can_come_first(folder.write("source.cpp", "#include <tchat/problem.hpp>")));
  CHECK_FALSE(comes_first("#define THREE"));
  CHECK_FALSE(comes_first("#include \"own.hpp\""));
  CHECK_FALSE(comes_first("/* one */ int two();"));
  CHECK_FALSE(comes_first("/* one\n two */ int three();"));
  CHECK_FALSE(comes_first("#if 0"));
  CHECK_FALSE(can_come_first(folder.write("source.cpp", "// #include <tchat/problem.hpp>\n")));
  CHECK_FALSE(can_come_first(folder / "nothing.cpp"));
}

TEST_CASE("every way to name a plugin") {
  const PluginFolder folder;
  const PluginBuildOptions options = folder.counting_compiler();
  folder.write("dir/small.cpp", small_plugin());
  const std::string library = folder / "dir/small.so";
  CHECK(resolve_plugin(folder / "dir/small", options) == library);
  CHECK(resolve_plugin(folder / "dir/small.cpp", options) == library);
  CHECK(resolve_plugin(folder / "dir/small.so", options) == library);
  CHECK(folder.compilations() == 1);
  CHECK(folder.entries("dir") == 2);  // no lock, temporary or dependency file left

  const fs::path before = fs::current_path();
  fs::current_path(folder / "dir");
  CHECK(fs::equivalent(resolve_plugin("small", options), library));
  CHECK(dimension_of(resolve_plugin("small.so", options)) == 2);
  fs::current_path(before);

  fs::rename(library, folder / "alone.so");
  CHECK(resolve_plugin(folder / "alone", options) == folder / "alone.so");
  folder.write("other.cc", small_plugin());
  CHECK(resolve_plugin(folder / "other", options) == folder / "other.so");
  folder.write("with space/it's (1).cpp", small_plugin());
  CHECK(dimension_of(resolve_plugin(folder / "with space/it's (1)", options)) == 2);
}

TEST_CASE("what a killed compilation left is removed by the next one") {
  const PluginFolder folder;
  folder.write("dir/.small.so.aB3dE6/small.so", "half a library");
  folder.write("dir/.other.so.aB3dE6/other.so", "another name's");
  folder.write("dir/small.cpp", small_plugin());
  CHECK(dimension_of(resolve_plugin(folder / "dir/small.cpp", folder.counting_compiler())) == 2);
  CHECK_FALSE(fs::exists(folder / "dir/.small.so.aB3dE6"));
  CHECK(fs::exists(folder / "dir/.other.so.aB3dE6"));
}

TEST_CASE("names of nothing") {
  const PluginFolder folder;
  CHECK_THROWS_WITH(resolve_plugin(folder / "none"), Contains("none.cpp") && Contains("none.so"));
  CHECK_THROWS_WITH(resolve_plugin(folder / "none.cpp"), Contains("no plugin file"));
  CHECK_THROWS_WITH(resolve_plugin(folder / "none.so"), Contains("no plugin file"));
  CHECK_THROWS_WITH(resolve_plugin(""), Contains("empty"));
  fs::create_directory(folder / "linosc");
  CHECK_THROWS_WITH(resolve_plugin(folder / "linosc"), Contains("is a folder") && Contains("linosc/linosc"));
  CHECK_THROWS_AS(resolve_plugin(folder / "none"), UserError);
}

TEST_CASE("a plugin is compiled when something changed, and only then") {
  const PluginFolder folder;
  const PluginBuildOptions options = folder.counting_compiler();
  folder.write("size.h", "enum { size = 2 };\n");
  const std::string source =
      folder.write("small.cpp", "#include \"size.h\"\n" + small_plugin("table.dimension = size;"));
  const auto resolve = [&] { return resolve_plugin(folder / "small", options); };
  CHECK(dimension_of(resolve()) == 2);
  CHECK(dimension_of(resolve()) == 2);
  CHECK(folder.compilations() == 1);

  SECTION("the source") {
    folder.write("small.cpp", small_plugin("table.dimension = 3;"));
    CHECK(dimension_of(resolve()) == 3);
    CHECK(folder.compilations() == 2);
  }
  SECTION("the source, with an older time") {
    folder.write("small.cpp", small_plugin("table.dimension = 4;"));
    make_older(source, std::chrono::hours(24));
    CHECK(dimension_of(resolve()) == 4);
  }
  SECTION("the time of the source alone") {
    fs::last_write_time(source, fs::file_time_type::clock::now() + std::chrono::seconds(1));
    resolve();
    CHECK(folder.compilations() == 2);
  }
  SECTION("a header of the user's") {
    folder.write("size.h", "enum { size = 5 };\n");
    CHECK(dimension_of(resolve()) == 5);
    CHECK(folder.compilations() == 2);
  }
  SECTION("the interface") {
    fs::copy(TCHAT_TEST_INCLUDE, folder / "include", fs::copy_options::recursive);
    const PluginBuildOptions copied = {options.compiler, folder / "include"};
    folder.write("other.cpp", small_plugin());
    resolve_plugin(folder / "other", copied);
    resolve_plugin(folder / "other", copied);
    CHECK(folder.compilations() == 2);
    std::ofstream(folder / "include/tchat/problem.h", std::ios::app) << "// a new version\n";
    make_older(folder / "include/tchat/problem.h", std::chrono::hours(24));
    resolve_plugin(folder / "other", copied);
    CHECK(folder.compilations() == 3);
  }
  SECTION("the compiler") {
    const PluginBuildOptions other = folder.counting_compiler("other-c++");
    resolve_plugin(folder / "small", other);
    resolve_plugin(folder / "small", other);
    CHECK(folder.compilations() == 2);
  }
  SECTION("nothing, but the compiler is gone") {
    CHECK(resolve_plugin(folder / "small", {"no-such-compiler", TCHAT_TEST_INCLUDE}) == folder / "small.so");
  }
}

TEST_CASE("a copy of a folder has sources of its own", "[slow]") {
  const PluginFolder folder;
  const PluginBuildOptions options = folder.counting_compiler();
  folder.write("work/first/own.h", "enum { more = 0 };\n");
  folder.write("work/common/size.h", "enum { size = 2 };\n");
  folder.write("work/first/small.cpp",
               "#include \"own.h\"\n#include \"../common/size.h\"\n" + small_plugin("table.dimension = size + more;"));
  const bool relative = GENERATE(false, true);  // the path as it is given, from the parent folder
  const fs::path before = fs::current_path();
  fs::current_path(folder / "work");
  const auto dimension_in = [&](const std::string& name) {
    const std::string path = (relative ? fs::path() : fs::current_path()) / name;
    return dimension_of(resolve_plugin(path, options));
  };
  CHECK(dimension_in("first/small") == 2);
  fs::copy("first", "second", fs::copy_options::recursive);
  fs::last_write_time("second/small.so", fs::file_time_type::clock::now());

  SECTION("the library is taken as long as they are the same") {
    CHECK(dimension_in("second/small") == 2);
    folder.write("work/first/small.cpp", small_plugin("table.dimension = 9;"));
    CHECK(dimension_in("second/small") == 2);
    CHECK(folder.compilations() == 1);
    CHECK(dimension_in("first/small") == 9);
  }
  SECTION("the source changes") {
    folder.write("work/second/small.cpp", small_plugin("table.dimension = 5;"));
    CHECK(dimension_in("second/small") == 5);
    CHECK(dimension_in("first/small") == 2);
  }
  SECTION("the source changes to one with an older time") {
    folder.write("work/second/small.cpp", small_plugin("table.dimension = 5;"));
    make_older(folder / "work/second/small.cpp", std::chrono::hours(24));
    CHECK(dimension_in("second/small") == 5);
  }
  SECTION("a header changes") {
    folder.write("work/second/own.h", "enum { more = 5 };\n");
    CHECK(dimension_in("second/small") == 7);
  }
  SECTION("a header that both share changes") {
    folder.write("work/common/size.h", "enum { size = 4 };\n");
    CHECK(dimension_in("second/small") == 4);
    CHECK(dimension_in("first/small") == 4);
  }
  SECTION("it is copied to where a header is missing") {
    fs::create_directories("deep/down");
    fs::copy("first", "deep/down/third", fs::copy_options::recursive);
    CHECK_THROWS_WITH(dimension_in("deep/down/third/small"), Contains("common/size.h"));
  }
  SECTION("the original is gone") {
    fs::remove_all("first");
    CHECK(dimension_in("second/small") == 2);
    folder.write("work/second/own.h", "enum { more = 1 };\n");
    CHECK(dimension_in("second/small") == 3);
  }
  fs::current_path(before);
}

TEST_CASE("a copy of a folder whose library is a link to the original's", "[slow]") {
  const PluginFolder folder;
  const PluginBuildOptions options = folder.counting_compiler();
  folder.write("first/small.cpp", small_plugin());
  CHECK(dimension_of(resolve_plugin(folder / "first/small", options)) == 2);
  folder.write("second/small.cpp", small_plugin("table.dimension = 5;"));
  fs::create_symlink(folder / "first/small.so", folder / "second/small.so");
  CHECK(dimension_of(resolve_plugin(folder / "second/small", options)) == 5);
  CHECK(dimension_of(resolve_plugin(folder / "first/small", options)) == 2);
  CHECK(folder.compilations() == 2);
}

TEST_CASE("a library of another tchat, or stamped by one, is compiled again", "[slow]") {
  const PluginFolder folder;
  const PluginBuildOptions options = folder.counting_compiler();
  folder.write("small.cpp", small_plugin());
  SECTION("other headers") {
    fs::copy(TCHAT_TEST_INCLUDE, folder / "include", fs::copy_options::recursive);
    std::ofstream(folder / "include/tchat/problem.h", std::ios::app) << "// another version\n";
    make_older(folder / "include/tchat/problem.h", std::chrono::hours(24));
    resolve_plugin(folder / "small", {options.compiler, folder / "include"});
    resolve_plugin(folder / "small", options);
    CHECK(folder.compilations() == 2);
  }
  SECTION("a stamp that lists paths") {
    resolve_plugin(folder / "small", options);
    std::ofstream(folder / "small.so", std::ios::app) << "\n#tchat-plugin-stamp 1\nabc\ndef\n"
                                                      << folder / "small.cpp"
                                                      << "\n#tchat-plugin-stamp-end\n";
    resolve_plugin(folder / "small", options);
    CHECK(folder.compilations() == 2);
  }
}

TEST_CASE("a library compiled by the user is taken unless its source is newer") {
  const PluginFolder folder;
  const PluginBuildOptions options = folder.counting_compiler();
  const std::string source = folder.write("small.cpp", small_plugin());
  const std::string by_hand =
      "c++ -shared -fPIC -I'" TCHAT_TEST_INCLUDE "' -o '" + folder / "small.so" + "' '" + source + "'";
  REQUIRE(std::system(by_hand.c_str()) == 0);
  CHECK(dimension_of(resolve_plugin(folder / "small", options)) == 2);
  CHECK(folder.compilations() == 0);
  make_older(folder / "small.so", std::chrono::hours(1));
  resolve_plugin(folder / "small", options);
  CHECK(folder.compilations() == 1);
}

TEST_CASE("several processes that want one plugin compile it once") {
  const PluginFolder folder;
  const PluginBuildOptions options = folder.counting_compiler();
  folder.write("dir/small.cpp", small_plugin());
  std::vector<pid_t> children;
  for (int k = 0; k < 5; ++k)
    children.push_back(start_process([&] { dimension_of(resolve_plugin(folder / "dir/small", options)); }));
  for (const pid_t child : children) CHECK(wait_for(child) == 0);
  CHECK(folder.compilations() == 1);
  CHECK(folder.entries("dir") == 2);
}

TEST_CASE("a source that does not compile: the compiler's message, and the old library stays") {
  const PluginFolder folder;
  const PluginBuildOptions options = {"", TCHAT_TEST_INCLUDE};
  folder.write("dir/small.cpp", small_plugin());
  const std::string library = resolve_plugin(folder / "dir/small", options);
  folder.write("dir/small.cpp", small_plugin("table.dimensoin = 3;"));
  CHECK_THROWS_WITH(resolve_plugin(folder / "dir/small", options),
                    Contains("small.cpp") && Contains("dimensoin") && Contains("-fsyntax-only"));
  CHECK_THROWS_AS(resolve_plugin(folder / "dir/small", options), UserError);
  CHECK(dimension_of(library) == 2);
  CHECK(folder.entries("dir") == 2);

  folder.write("forgot.cpp", R"(#include <tchat/problem.hpp>
struct Forgot {
  static constexpr int dimension = 1, parameters = 0, events = 1, jumps = 1;
};
TCHAT_PROBLEM(Forgot)
)");
  CHECK_THROWS_WITH(resolve_plugin(folder / "forgot", options), Contains("fields"));
}

TEST_CASE("a local variable of type double that depends on the state: the message says what to do", "[slow]") {
  const PluginFolder folder;
  folder.write("narrow.cpp", R"(#include <tchat/problem.hpp>
struct Narrow {
  static constexpr int dimension = 1, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T> void field(int, const T* x, const T* par, T* f) const {
    const double spring = par[0] * x[0];
    f[0] = -spring;
  }
  template <class T> T event(int, const T* x, const T*) const { return x[0]; }
  template <class T> void jump(int, const T* x, const T*, T* g) const { g[0] = x[0]; }
};
TCHAT_PROBLEM(Narrow)
)");
  CHECK_THROWS_WITH(resolve_plugin(folder / "narrow", {"", TCHAT_TEST_INCLUDE}), Contains("of type T"));
}

TEST_CASE("a long list of errors is cut", "[slow]") {
  const PluginFolder folder;
  std::string source;
  for (int k = 0; k < 500; ++k) source += "int f" + std::to_string(k) + "() { return nothing; }\n";
  folder.write("many.cpp", source);
  try {
    resolve_plugin(folder / "many", {"", TCHAT_TEST_INCLUDE});
    FAIL("a source with 500 errors was compiled");
  } catch (const UserError& error) {
    const std::string text = error.what();
    CHECK(std::count(text.begin(), text.end(), '\n') < 12);
    CHECK_THAT(text, Contains("and 495 errors more"));
  }
}

TEST_CASE("no compiler") {
  const PluginFolder folder;
  folder.write("small.cpp", small_plugin());
  CHECK_THROWS_WITH(resolve_plugin(folder / "small", {"no-such-compiler -x", TCHAT_TEST_INCLUDE}),
                    Contains("no C++ compiler") && Contains("no-such-compiler") && Contains("CXX"));
  const Environment cxx("CXX", "not-installed-c++");
  CHECK_THROWS_WITH(resolve_plugin(folder / "small", {"", TCHAT_TEST_INCLUDE}), Contains("not-installed-c++"));
  CHECK(folder.entries() == 1);
}

TEST_CASE("the compiler of CXX, with arguments") {
  const PluginFolder folder;
  const Environment cxx("CXX", "c++ -DDIMENSION=6");
  folder.write("small.cpp", small_plugin("table.dimension = DIMENSION;"));
  CHECK(dimension_of(resolve_plugin(folder / "small", {"", TCHAT_TEST_INCLUDE})) == 6);
}

TEST_CASE("the folder of the interface") {
  const PluginFolder folder;
  CHECK(fs::exists(find_include_folder({}) + "/tchat/problem.hpp"));  // this program runs from a build tree
  const Environment include("TCHAT_INCLUDE", folder / ".");
  CHECK_THROWS_WITH(find_include_folder({}), Contains("TCHAT_INCLUDE"));
  folder.write("tchat/problem.hpp", "");
  CHECK(find_include_folder({}) == folder / ".");
}

TEST_CASE("a source in a folder that cannot be written is compiled to the cache folder", "[slow]") {
  const PluginFolder folder;
  const PluginBuildOptions options = {"c++", TCHAT_TEST_INCLUDE};
  folder.write("dir/small.cpp", small_plugin());
  folder.write("again/small.cpp", small_plugin("table.dimension = 9;"));
  fs::create_directories(folder / "cache");
  chmod((folder / "cache").c_str(), 0777);
  chmod((folder / "dir").c_str(), 0555);
  chmod((folder / "again").c_str(), 0555);

  const auto resolves_to_cache = [&](const char* name, int dimension) {
    const std::string library = resolve_plugin(folder / name, options);
    const bool cached = library.starts_with(folder / "cache/tchat/small-");
    const bool same = resolve_plugin(folder / name, options) == library;
    if (!cached || !same || dimension_of(library) != dimension) throw std::runtime_error(library);
  };
  const auto refused = [&](const char* part) {
    try {
      resolve_plugin(folder / "dir/small", options);
    } catch (const UserError& error) {
      if (std::string(error.what()).find(part) != std::string::npos) return;
    }
    throw std::runtime_error("not refused as expected");
  };
  CHECK(wait_for(start_process([&] {
          become_nobody();
          setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
          resolves_to_cache("dir/small", 2);
          resolves_to_cache("again/small", 9);
        })) == 0);
  CHECK(folder.entries("cache/tchat") == 3);  // two libraries and the folder of the header read before
  CHECK(folder.entries("dir") == 1);
  CHECK(wait_for(start_process([&] {
          become_nobody();
          setenv("XDG_CACHE_HOME", (folder / "dir").c_str(), 1);
          refused("XDG_CACHE_HOME");
        })) == 0);
  CHECK(wait_for(start_process([&] {
          become_nobody();
          unsetenv("XDG_CACHE_HOME");
          unsetenv("HOME");
          refused("no cache folder");
        })) == 0);
}
