/// A fresh folder with the linear oscillator (plugin, constants, data), in which the executable is run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "end_to_end/point_file_reader.hpp"
#include "end_to_end/process.hpp"
#include "end_to_end/solution_entry_reader.hpp"
#include "support/temporary_folder.hpp"

namespace test_support {

class Workspace {
 public:
  enum class Plugin { compiled, source };
  explicit Workspace(Plugin plugin = Plugin::compiled);

  /// tchat with these arguments (separated by blanks: none of ours contains one, but see `words`), to its end.
  Outcome tchat(const std::string& arguments) const;
  Outcome tchat(const std::vector<std::string>& words) const;
  /// The same; fails the test unless the exit status is 0.
  Outcome succeed(const std::string& arguments) const;
  Outcome succeed(const std::vector<std::string>& words) const;
  std::unique_ptr<Process> start_tchat(const std::string& arguments) const;
  /// As tchat(), with a redirection of the shell, such as ">&-".
  Outcome tchat_redirected(const std::string& arguments, const std::string& redirection) const;
  /// As tchat(), with files of at most so many blocks of 512 bytes, as on a full disk.
  Outcome tchat_on_small_disk(int blocks, const std::string& arguments) const;
  /// As tchat(), with at most so many kB of address space.
  Outcome tchat_in_memory(int kilobytes, const std::string& arguments) const;

  /// As tchat(), with a library in it that writes to the file `record`, whose name it finds in RECORDED_CALLS.
  Outcome tchat_preloaded(const std::string& library, const std::string& record, const std::string& arguments) const;

  /// A line for the shell, in which `tchat` is this one.
  Outcome shell(const std::string& line) const;

  /// make -C FOLDER TARGETS, with this tchat.
  Outcome make(const std::string& folder, const std::string& targets) const;

  /// tchat run linosc ...; fails the test unless the exit status is 0.
  Outcome run(const std::string& arguments) const;
  Outcome run(const std::vector<std::string>& words) const;

  /// p.NAME, q.NAME read strictly: a file that breaks the format fails the test.
  std::vector<PointSection> points(const std::string& name) const;
  std::vector<SolutionEntry> solutions(const std::string& name) const;

  std::string file(const std::string& name) const { return folder_.file(name); }
  std::string read(const std::string& name) const { return folder_.read(name); }
  bool has(const std::string& name) const { return folder_.has(name); }
  /// Is there a file .NAME.XXXXXX.new that has not been put in its place?
  bool has_unfinished() const;
  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  /// Replaces the one place where `old` stands in a file.
  void edit(const std::string& name, const std::string& old, const std::string& text) const;

 private:
  TemporaryFolder folder_;
  TemporaryFolder logs_;
  mutable int runs_ = 0;
};

/// "a b  c" -> {"a", "b", "c"}
std::vector<std::string> words_of(const std::string& text);

/// "... = NUMBER" after `key`, which the text must have.
double number_after(const std::string& text, const std::string& key);

/// All rows of all sections.
std::vector<PointRow> rows_of(const std::vector<PointSection>& sections);
std::vector<int> labels_of(const std::vector<PointSection>& sections);
std::vector<int> labels_of(const std::vector<SolutionEntry>& entries);
const SolutionEntry& with_label(const std::vector<SolutionEntry>& entries, int label);
const PointRow& with_label(const std::vector<PointSection>& sections, int label);

}  // namespace test_support
