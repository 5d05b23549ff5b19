/// The commands of an exploration, as jobs: what they have in common, and which one follows what.
///
/// All files are in one folder; every command is one that a user could have typed beside it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "explore/command_job.hpp"
#include "explore/explore_request.hpp"
#include "explore/swept_range.hpp"
#include "model/hybrid_system.hpp"

namespace tchat {

/// A labelled point of a branch that is there.
struct SwitchPoint {
  std::string branch;
  int label = 0;
  std::string type;        ///< GR, PD, ...
  double parameter = 0.0;  ///< the value of the explored one
  std::string command;     ///< run/run_remarks.hpp
};

/// A labelled orbit of a branch, and a label of a known branch from which its orbits at the same value are corrected.
struct OrbitComparison {
  std::string branch;
  int label = 0;
  std::string known;
  int known_label = 0;
  double value = 0.0;  ///< of the explored parameter
  int points = 0;      ///< at most so many from the known label
};

class ExplorationCommands {
 public:
  /// `system` must outlive this; `has_added_section`: tchat has cut it. Throws UserError where the request's range is
  /// none, or not one of a parameter.
  ExplorationCommands(const ExploreRequest& request, const HybridSystem& system, bool has_added_section);

  const SweptRange& range() const { return range_; }
  const std::string& folder() const { return folder_; }
  /// NAME or the path of -p.
  const std::string& problem() const { return problem_; }
  /// Names of the monitors of branches: mean and largest value of each state.
  const std::vector<std::string>& monitors() const { return monitors_; }
  /// The path of a file in the folder; `letter` is p, q, d or r.
  std::string file(char letter, const std::string& name) const { return folder_ + "/" + letter + "." + name; }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  /// "PAR(alpha)=3.05"
  std::string at_value(double value) const;

  CommandJob sweep() const;
  /// From each of these states, as --state takes them, at every value.
  CommandJob sweep_from(const std::vector<std::string>& states) const;
  /// A branch through what a simulation settles on from a state: `words` of `tchat simulate` that give it.
  CommandJob start(const std::string& name, double value, const std::string& words, bool rests) const;
  /// What begins at a labelled point.
  CommandJob switching(const SwitchPoint& at) const;
  /// One direction of a switch that goes in both: with its DS, or with this one, which is for the other direction.
  CommandJob one_direction(const CommandJob& both, std::optional<double> other_ds) const;
  static bool goes_in_both_directions(const CommandJob& job);
  /// The run along the known branch.
  CommandJob correction(const OrbitComparison& at) const;
  /// The equilibrium of a label as that of another field.
  std::string in_other_field(const std::string& branch, int label, int field) const;
  /// Orbits with one impact in so many returns that begin at a grazing point.
  CommandJob born(const SwitchPoint& at, int returns) const;
  /// The same at a label of the files `source`, to those of `name`.
  std::vector<std::string> born_lines(const std::string& source, const std::string& label, int returns,
                                      const std::string& name) const;
  /// "tchat simulate ..." of an attractor, with the `words` that begin on it.
  std::string show(double value, const std::string& words) const;
  /// The p-, q-, d- and r-file of a branch.
  std::vector<std::string> files_of(const std::string& name) const;
  /// KEY=VALUE of the command line for all runs.
  const std::vector<std::string>& constants() const { return constants_; }

 private:
  std::vector<std::string> run_words(bool rests = false) const;
  CommandJob sweep_job(const std::string& name, const std::vector<std::string>& states, const char* options) const;

  const ExploreRequest& request_;
  std::string watched_;  ///< words that watch all events, where none has a jump: a contact changes nothing
  SweptRange range_;
  std::string folder_;
  std::string problem_;
  std::string constants_option_;
  std::vector<std::string> parameters_, constants_;  ///< KEY=VALUE of the command line
  std::vector<std::string> monitors_;
};

/// Words quoted for the shell, with a blank before each.
std::string shell_words(const std::vector<std::string>& words);
/// Does a word of the command line set a parameter?
bool sets_parameter(const std::string& word);

}  // namespace tchat
