/// A chain of problems/NAME from a copy of its sources and constants, as a user runs it: `make -j2` with the results in
/// a folder elsewhere. All tests share what a chain has computed: each gets a copy of what make finds missing once, so
/// that the folder may have results besides the wanted ones.
#pragma once

#include <string>
#include <vector>

#include "published/chain.hpp"

namespace test_support {

class MakefileRun {
 public:
  /// `targets`: of the Makefile, or results by their names, as in q.NAME. Fails the test unless make succeeds.
  explicit MakefileRun(const std::string& problem, const std::string& targets = "all");

  /// Once more there is nothing to do; without -j2 every file that it makes is the same to the byte; `make clean`
  /// leaves nothing. Of chains that take long (Chain::is_long) the files are compared only where all tests are wanted.
  enum class Chain { is_short, is_long };
  void check_repeatable(Chain length = Chain::is_short) const;

  /// `make verify`: forward integration agrees with every labelled orbit of the chain.
  void check_verified() const;

  /// tchat in the folder of the results.
  Outcome tchat(std::vector<std::string> words) const;
  /// tchat run NAME with the plugin of the chain; fails the test unless the exit status is 0.
  void run(const std::string& arguments) const;

  std::string plugin() const { return folder_.file("problems/" + problem_ + "/" + problem_); }
  std::string constants(const std::string& name) const { return folder_.file("constants/" + problem_ + "/gc." + name); }

  bool has(const std::string& name) const { return folder_.has("out/" + name); }
  std::string read(const std::string& name) const { return folder_.read("out/" + name); }
  void write(const std::string& name, const std::string& text) const { folder_.write("out/" + name, text); }
  /// q.NAME, p.NAME, d.NAME
  std::vector<SolutionEntry> solutions(const std::string& name) const { return read_solutions(read("q." + name)); }
  std::vector<PointSection> points(const std::string& name) const { return read_points(read("p." + name)); }
  std::vector<DiagnosticPoint> diagnostics(const std::string& name) const {
    return read_diagnostics(read("d." + name));
  }

  /// The n-th solution (from 1) of a type in the d-file's terms.
  SolutionEntry solution(const std::string& name, const std::string& type, std::size_t n = 1) const;
  DiagnosticPoint point(const std::string& name, const std::string& type, std::size_t n = 1) const;
  /// Of the only point of that type; fails the test when there are none or several.
  SolutionEntry only(const std::string& name, const std::string& type) const;

 private:
  Outcome make(const std::string& folder, const std::vector<std::string>& words, const std::string& out) const;

  std::string problem_, targets_, kept_;
  TemporaryFolder folder_, logs_;
  mutable int runs_ = 0;
};

/// |found - expected| <= tolerance; both are shown when it fails.
void check_near(double found, double expected, double tolerance = 1e-9);

}  // namespace test_support
