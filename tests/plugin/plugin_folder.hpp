/// A folder of its own for one test, with plugin sources in it and a compiler that counts its calls.
#pragma once

#include <stdlib.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "plugin/plugin_build.hpp"

class PluginFolder {
 public:
  PluginFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "tchat-plugin-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    chmod(name.c_str(), 0755);
    path_ = name;
  }
  ~PluginFolder() { std::filesystem::remove_all(path_); }
  PluginFolder(const PluginFolder&) = delete;
  PluginFolder& operator=(const PluginFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name) << text;
    return *this / name;
  }

  std::string read(const std::string& name) const {
    std::ifstream in(path_ / name);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  /// Number of directory entries in a folder, hidden ones too.
  long entries(const std::string& name = ".") const {
    return std::distance(std::filesystem::directory_iterator(path_ / name), {});
  }

  /// A compiler script that notes the options of each compilation in the file `log`, then is c++.
  tchat::PluginBuildOptions counting_compiler(const std::string& script = "counting-c++") const {
    const std::string file = write(script, "#!/bin/sh\ncase \"$*\" in *-shared*) echo \"$*\" >> '" + *this / "log" +
                                               "';; esac\nexec c++ \"$@\"\n");
    chmod(file.c_str(), 0755);
    return {file, TCHAT_TEST_INCLUDE};
  }
  long compilations() const {
    const std::string text = read("log");
    return std::count(text.begin(), text.end(), '\n');
  }

 private:
  std::filesystem::path path_;
};

/// A small sound problem in C, quick to compile; `spoil` is put where the table is complete.
inline std::string small_plugin(const std::string& spoil = "") {
  return R"(#include <tchat/problem.h>
static void value(const void*, int32_t kind, int32_t, const double* x, const double* par, double* out) {
  out[0] = par[0] * x[0];
  if (kind != TCHAT_EVENT) out[1] = x[1];
}
static tchat_problem table;
extern "C" __attribute__((visibility("default"))) const tchat_problem* tchat_problem_table(void) {
  table.abi_version = TCHAT_PROBLEM_ABI;
  table.struct_size = sizeof(tchat_problem);
  table.dimension = 2;
  table.parameters = 1;
  table.fields = table.events = table.jumps = 1;
  table.name = "small";
  table.value = value;
)" + spoil +
         R"(
  return &table;
}
)";
}
