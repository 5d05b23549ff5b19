// A plugin's source is compiled when it is needed, once, also when two runs need it at the same time.
#include <catch2/catch.hpp>
#include <filesystem>

#include "end_to_end/workspace.hpp"

using namespace test_support;
namespace fs = std::filesystem;

namespace {

const std::string quick = "-c impacting -d impacting NTST=20 NMX=3 ";

/// Moves a file's time: a source saved after its library was made.
void age(const Workspace& workspace, const std::string& name, std::chrono::seconds by) {
  fs::last_write_time(workspace.file(name), fs::last_write_time(workspace.file(name)) + by);
}

}  // namespace

TEST_CASE("a plugin is compiled at the first run and not again until its source changes") {
  const Workspace workspace(Workspace::Plugin::source);
  CHECK_FALSE(workspace.has("linosc.so"));
  workspace.run(quick + "-o one");
  REQUIRE(workspace.has("linosc.so"));
  const auto made = fs::last_write_time(workspace.file("linosc.so"));
  workspace.run(quick + "-o two");
  CHECK(fs::last_write_time(workspace.file("linosc.so")) == made);
  CHECK(workspace.read("p.one") == workspace.read("p.two"));

  workspace.edit("linosc.cpp", "{3.0, 2.0, 0.05, 0.8}", "{3.0, 2.0, 0.05, 0.7}");
  age(workspace, "linosc.cpp", std::chrono::seconds(2));
  workspace.run("-c nonimpacting_alpha -d nonimpacting NMX=1 -o three");
  CHECK(fs::last_write_time(workspace.file("linosc.so")) != made);
}

TEST_CASE("a copy of a project folder, edited, runs what it holds") {
  const Workspace workspace(Workspace::Plugin::source);
  workspace.run("-c nonimpacting_alpha -d nonimpacting NMX=1 -o one");
  const fs::path copy = workspace.file("copy");
  fs::create_directory(copy);
  for (const char* name : {"linosc.cpp", "linosc.so", "gc.nonimpacting_alpha", "nonimpacting.dat"})
    fs::copy_file(workspace.file(name), copy / name);
  age(workspace, "copy/linosc.so", std::chrono::seconds(5));  // only contents tell
  workspace.edit("copy/linosc.cpp", "static constexpr int dimension = 4, parameters = 4;",
                 "static constexpr int dimension = 4, parameters = 4, user_values = 1;\n"
                 "  void user_value(const double*, const double*, double* out) const { out[0] = 7.5; }");
  const Outcome outcome =
      workspace.tchat("run copy/linosc -c copy/gc.nonimpacting_alpha -d copy/nonimpacting.dat NMX=1 -o two");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(workspace.read("p.two").find("PVLS(1)") != std::string::npos);
  CHECK(workspace.read("p.one").find("PVLS(1)") == std::string::npos);
}

TEST_CASE("two runs that need the same plugin at once") {
  const Workspace workspace(Workspace::Plugin::source);
  const auto one = workspace.start_tchat("run linosc -o one " + quick);
  const auto two = workspace.start_tchat("run linosc -o two " + quick);
  const Outcome first = one->wait(std::chrono::seconds(120));
  const Outcome second = two->wait(std::chrono::seconds(120));
  INFO(first.text() << second.text());
  CHECK(first.status == 0);
  CHECK(second.status == 0);
  CHECK(workspace.read("p.one") == workspace.read("p.two"));
  // Nothing is left over but the library.
  for (const auto& entry : fs::directory_iterator(workspace.file(""))) {
    const std::string name = entry.path().filename().string();
    INFO(name);
    CHECK((name[0] != '.' || name == ".linosc.so.lock"));
  }
}

TEST_CASE("option -p names a source or a library") {
  const Workspace workspace(Workspace::Plugin::source);
  fs::rename(workspace.file("linosc.cpp"), workspace.file("other.cpp"));
  CHECK(workspace.tchat("run linosc " + quick).status == 2);
  workspace.run("-p other.cpp -o one " + quick);
  workspace.run("-p other.so -o two " + quick);
  workspace.run("-p ./other -o three " + quick);
  CHECK(workspace.read("p.one") == workspace.read("p.three"));
  const Outcome check = workspace.tchat("check linosc -p other");
  CHECK(check.status == 0);
}

TEST_CASE("tchat check passes the oscillator and finds a wrong derivative") {
  const Workspace workspace(Workspace::Plugin::source);
  const Outcome fine = workspace.tchat("check linosc PAR(omega)=2.5 --state 0.3,-0.5,0.6,0.8");
  INFO(fine.text());
  CHECK(fine.status == 0);

  workspace.edit("linosc.cpp", "  template <class T>\n  T event",
                 "  void event_derivatives(int j, const double*, const double*, double* dhdx, double*) const {\n"
                 "    if (j == 1) dhdx[0] = -1.0;\n    if (j == 2) dhdx[1] = 1.0;\n"
                 "    if (j == 3) dhdx[1] = 1.0;  // should be -1\n  }\n\n"
                 "  template <class T>\n  T event");
  age(workspace, "linosc.cpp", std::chrono::seconds(2));
  const Outcome wrong = workspace.tchat("check linosc");
  INFO(wrong.text());
  CHECK(wrong.status == 1);
  CHECK(wrong.out.find("minimum of x1") != std::string::npos);
  CHECK(wrong.out.find("x2") != std::string::npos);
}

TEST_CASE("completion names parameters and runs nothing of the folder") {
  const Workspace workspace(Workspace::Plugin::source);
  CHECK(workspace.tchat({"complete", "--", "run", "linosc", "PAR(a"}).out == "PAR(alpha)=\n");
  CHECK_FALSE(workspace.has("linosc.so"));
  workspace.write("ball.tch", "par Gamma = 1, r = 0.8\nx' = v\nv' = -Gamma\n");
  CHECK(workspace.tchat({"complete", "--", "check", "ball", "PAR("}).out == "PAR(Gamma)=\nPAR(r)=\n");

  workspace.write("stranger.c",
                  "#include <stdio.h>\n"
                  "__attribute__((constructor)) static void run(void) { fclose(fopen(\"has_run\", \"w\")); }\n");
  const Outcome compiled = Process({"/usr/bin/cc", "-shared", "-fPIC", "-o", "stranger.so", "stranger.c"},
                                   workspace.file(""), workspace.file("log"))
                               .wait(std::chrono::seconds(60));
  REQUIRE(compiled.status == 0);
  for (const char* command : {"run", "simulate", "check", "dat", "constants"})
    CHECK(workspace.tchat({"complete", "--", command, "stranger", "PAR("}).out.empty());
  CHECK(workspace.tchat({"complete", "--", "run", "linosc", "-p", "stranger", "PAR("}).out.empty());
  for (const char* command : {"help", "--help", "--version", "constants"}) workspace.tchat(command);
  CHECK_FALSE(workspace.has("has_run"));
  workspace.tchat("check stranger");  // which is asked to load it
  CHECK(workspace.has("has_run"));
}

TEST_CASE("a plugin beside a q-file of another folder is named before it is compiled and loaded") {
  const Workspace workspace(Workspace::Plugin::source);
  workspace.run(quick + "-o linosc");
  const fs::path folder = workspace.file("theirs");
  fs::create_directory(folder);
  for (const char* name : {"linosc.cpp", "q.linosc", "p.linosc", "d.linosc", "r.linosc"})
    fs::copy_file(workspace.file(name), folder / name);
  const std::string notice = "plugin: theirs/linosc.cpp is compiled where its library is not up to date, loaded";
  for (const char* command : {"verify theirs/q.linosc", "resegment theirs/q.linosc EP1 --to double -o twice",
                              "dat theirs/linosc -c impacting -d impacting -o data"}) {
    INFO(command);
    CHECK(workspace.tchat(command).err.starts_with(notice));
    CHECK(workspace.tchat(std::string(command) + " -p linosc").err.find("plugin: ") == std::string::npos);
  }
  CHECK(workspace.tchat("grazing theirs/linosc --state 0,0,0,1 --mode 1,1,1").err.starts_with(notice));
  CHECK(workspace.tchat("verify q.linosc").err.find("plugin: ") == std::string::npos);
  // Where it cannot be compiled, the notice has already been given.
  fs::remove(folder / "linosc.so");
  workspace.write("theirs/linosc.cpp", "#error not today\n");
  const std::string said = workspace.tchat("verify theirs/q.linosc").err;
  CHECK(said.starts_with(notice));
  CHECK(said.find("not today") != std::string::npos);
}
