// When the power fails a disk has lost what was not synced: contents of files, and the last changes of names. The calls
// of a run are recorded and replayed up to every instant.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

using Names = std::map<std::string, int>;  // file names and what they name

/// What is on the disk for sure, and what may be.
class Disk {
 public:
  /// Takes the files that are there for synced ones.
  explicit Disk(const Workspace& workspace) {
    for (const auto& entry : std::filesystem::directory_iterator(workspace.file("")))
      names_[entry.path().filename().string()] = ++last_;
    on_disk_ = {names_};
  }

  void replay(const std::string& call) {
    std::istringstream words(call);
    std::string what, one, two;
    words >> what >> one >> two;
    one = std::filesystem::path(one).filename().string();
    two = std::filesystem::path(two).filename().string();
    if (what == "sync" && names_.count(one) == 0) {  // the folder
      on_disk_ = {names_};
    } else if (what == "sync") {
      unsynced_.erase(names_.at(one));
    } else if (what == "open") {
      names_[one] = ++last_;
      on_disk_.push_back(names_);
    } else if (what == "write" || what == "cut") {
      if (names_.count(one) == 0) names_[one] = ++last_;
      unsynced_.insert(names_.at(one));
    } else {
      change_names(what, one, two);
    }
  }

  Names names() const { return names_; }

  /// Of p, q, d with these contents, under their first or second names, after every change that may be the last one.
  bool holds(const Names& set) const {
    return std::all_of(on_disk_.begin(), on_disk_.end(),
                       [&](const Names& names) { return holds(names, set, "") || holds(names, set, "~"); });
  }

  /// These files have reached the disk, contents and names.
  bool has_all_of(const std::vector<std::string>& files) const {
    return std::all_of(files.begin(), files.end(), [this](const std::string& file) {
      const auto found = names_.find(file);
      if (found == names_.end() || unsynced_.count(found->second) > 0) return false;
      return std::all_of(on_disk_.begin(), on_disk_.end(), [&](const Names& names) {
        const auto there = names.find(file);
        return there != names.end() && there->second == found->second;
      });
    });
  }

 private:
  void change_names(const std::string& what, const std::string& one, const std::string& two) {
    if (what != "remove") {
      if (names_.count(one) == 0) names_[one] = ++last_;  // created without contents
      INFO(what << " " << one << " " << two);
      CHECK(unsynced_.count(names_[one]) == 0);  // contents before the name
      names_[two] = names_[one];
    }
    if (what != "link") names_.erase(one);
    on_disk_.push_back(names_);
  }

  bool holds(const Names& names, const Names& set, const std::string& suffix) const {
    return std::all_of(set.begin(), set.end(), [&](const Names::value_type& one) {
      const auto found = names.find(one.first + suffix);
      return found != names.end() && found->second == one.second;
    });
  }

  Names names_;
  std::vector<Names> on_disk_;  // the last synced state of the folder and those after it: one of them
  std::set<int> unsynced_;
  int last_ = 0;
};

std::vector<std::string> calls_of(const Workspace& workspace, const std::string& arguments) {
  const std::string record = workspace.file("calls");
  REQUIRE(workspace.tchat_preloaded(RECORDED_CALLS_LIBRARY, record, arguments).status == 0);
  std::istringstream text(workspace.read("calls"));
  std::filesystem::remove(record);
  std::vector<std::string> calls;
  for (std::string call; std::getline(text, call);) calls.push_back(call);
  REQUIRE(calls.size() > 3);
  return calls;
}

const std::vector<std::string> set_of_run = {"p.branch", "q.branch", "d.branch", "r.branch"};

Names complete_set(const Disk& disk) {
  Names set;
  for (const char* file : {"p.branch", "q.branch", "d.branch"}) set[file] = disk.names().at(file);
  return set;
}

}  // namespace

TEST_CASE("a power failure at any instant leaves the last complete set") {
  for (const std::string again : {"", " --append"}) {
    const Workspace workspace;
    const std::string run = "run linosc -q -c impacting -d impacting -o branch NMX=6 NPR=2";
    workspace.tchat(run);
    Disk disk(workspace);
    const Names complete = complete_set(disk);
    for (const std::string& call : calls_of(workspace, run + again)) {
      disk.replay(call);
      INFO(call);
      CHECK(disk.holds(complete));
    }
    CHECK(disk.has_all_of(set_of_run));
  }
}

TEST_CASE("what one command makes is on the disk at its end") {
  const Workspace workspace;
  workspace.tchat("run linosc -q -c impacting -d impacting -o branch NMX=6 NPR=2");
  struct Made {
    std::string arguments;
    std::vector<std::string> files;
  };
  for (const Made& made : {Made{"dat linosc -c impacting -d impacting -o start", {"q.start"}},
                           Made{"resegment q.branch 1 --to rotate -o turned -p linosc", {"q.turned", "gc.turned"}},
                           Made{"dat linosc -c impacting -d impacting -o start", {"q.start", "q.start~"}}}) {
    Disk disk(workspace);
    for (const std::string& call : calls_of(workspace, made.arguments)) disk.replay(call);
    INFO(made.arguments);
    CHECK(disk.has_all_of(made.files));
  }
}
