#include "explore/exploration_makefile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace tchat {

namespace {

/// A word in a rule.
std::string in_rule(const std::string& word) {
  std::string text;
  for (const char c : word) {
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

std::string rule(const CommandJob& job) {
  std::string text;
  for (const std::string& file : job.outputs) text += file + " ";
  text += "&:";
  for (const std::string& file : job.inputs) text += " " + file;
  text += " | $(FOLDER)\n";
  for (const std::string& line : job.lines)
    text += "\t" + (line.starts_with("tchat ") ? "$(TCHAT)" + in_rule(line.substr(5)) : in_rule(line)) + "\n";
  return text + "\n";
}

/// The first files of the jobs that are joined by what they make and need: those of different trees share no file.
std::vector<std::string> trees(const std::vector<CommandJob>& jobs) {
  std::map<std::string, std::size_t> maker;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (const std::string& output : jobs[i].outputs) maker[output] = i;
  std::vector<std::size_t> tree(jobs.size());
  std::iota(tree.begin(), tree.end(), std::size_t{0});
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (const std::string& input : jobs[i].inputs)
      if (const auto made = maker.find(input); made != maker.end())
        std::replace(tree.begin(), tree.end(), std::size_t{tree[i]}, std::size_t{tree[made->second]});
  std::map<std::size_t, std::string> files;
  for (std::size_t i = 0; i < jobs.size(); ++i) files[tree[i]] += " " + jobs[i].outputs.front();
  std::vector<std::string> result;
  for (const auto& [number, list] : files) result.push_back(list);
  return result;
}

}  // namespace

std::string exploration_makefile(const std::vector<CommandJob>& jobs, const std::vector<CommandJob>& last,
                                 const std::string& folder) {
  const std::vector<std::string> parts = trees(jobs);
  std::string text =
      fmt::format("# Makes the files of {0} with make -f, also with -j.\nTCHAT = tchat\nFOLDER = {0}\n\n", folder);
  std::string branches, numbered, pictures;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    branches += fmt::format(" $(TREE{})", i + 1);
    numbered += fmt::format("TREE{} ={}\n", i + 1, parts[i]);
  }
  text +=
      fmt::format("# What has no file in common. Part PART of PARTS: make -f ... part PART=2 PARTS=8\n{}\n", numbered);
  for (const CommandJob& job : last) pictures += " " + job.outputs.front();
  text += fmt::format("all: branches{}\n\nbranches:{}\n\n", pictures, branches);
  text += fmt::format("PART = 1\nPARTS = 1\npart: $(foreach tree,$(shell seq $(PART) $(PARTS) {}),$(TREE$(tree)))\n\n",
                      parts.size());
  text += ".PHONY: all branches part\n\n$(FOLDER):\n\tmkdir -p $@\n\n";
  for (const CommandJob& job : jobs) text += rule(job);
  for (const CommandJob& job : last) text += rule(job);
  return text;
}

}  // namespace tchat
