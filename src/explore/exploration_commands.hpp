/// An exploration as jobs: its request and its commands.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "explore/command_jobs.hpp"
#include "model/hybrid_system.hpp"
#include "run/run_remarks.hpp"

namespace tchat {

// One `tchat explore`: what the command line says, before any file is read.

struct ExploreRequest {
  std::string name;
  std::optional<std::string> constants;  ///< -c
  std::optional<std::string> problem;    ///< -p
  std::optional<std::string> output;     ///< -o: the folder O of all files
  std::string over;                      ///< "P=a:b" or "P=a:b:COUNT"
  std::optional<std::string> second;     ///< --and "Q=c:d": the curves of special points in two parameters
  std::vector<std::string> states;       ///< --state of the sweep
  std::vector<std::string> overrides;    ///< KEY=VALUE: parameters for all commands, constants for runs
  std::string quantity;                  ///< -y of the picture; empty: chosen
  int workers = 1;
  int starts = 2;     ///< further initial states at every value
  int doublings = 4;  ///< of the period, from an attractor on
  int segments = 32;  ///< most of them in a signature that is followed
  int branches = 50;  ///< at most so many are kept
  /// At grazing, orbits with one impact in up to so many returns are followed: 1, and 4 from points with xi_n = 0 of
  /// grazing curves, where nothing else is asked for.
  std::optional<int> returns;
  double seconds = 0.0;  ///< wall time after which no command is begun; 0: any
  bool tori = false;     ///< are followed where they are born
  bool quiet = false;
};

// A parameter and the values that it takes, as the command line has them.

/// "alpha=2.9:3.3:201" in its parts.
struct SweptRange {
  std::string parameter;
  double from = 0.0, to = 0.0;
  int count = 201;
};

/// `option` is named in messages. Throws UserError, for a number of values too where there is to be none.
SweptRange read_swept_range(const std::string& option, const std::string& text, bool may_have_count = true);

/// The number in PAR of the parameter, which the command line gives by its name or number, also as PAR(name); `range`
/// then has the name, where it is one. Throws UserError where there is none.
int find_parameter(const std::string& option, const HybridSystem& system, SweptRange& range);

// The commands of an exploration, as jobs: what they have in common, and which one follows what.
//
// All files are in one folder; every command is one that a user could have typed beside it.

/// A labelled point of a branch that is there.
struct SwitchPoint {
  std::string branch;
  int label = 0;
  std::string type;   ///< GR, PD, ...
  Commands commands;  ///< that follow what begins there (run/run_remarks.hpp)
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

/// The files of the user that all commands, or those of simulations, read.
struct GivenFiles {
  std::vector<std::string> problem;
  std::vector<std::string> constants;
};

/// NMX of runs where nothing else is said.
inline constexpr int usual_points = 400;

class ExplorationCommands {
 public:
  /// `system` must outlive this; `has_added_section`: tchat has cut it. Throws UserError where the request's range is
  /// none, or not one of a parameter, and where its folder cannot be one of files that a Makefile names.
  ExplorationCommands(const ExploreRequest& request, const HybridSystem& system, bool has_added_section,
                      GivenFiles given);

  const SweptRange& range() const { return range_; }
  const std::string& folder() const { return folder_; }
  /// NAME or the path of -p.
  const std::string& problem() const { return problem_; }
  /// Names of the monitors of branches: mean and largest value of each state.
  const std::vector<std::string>& monitors() const { return monitors_; }
  /// The path of a file in the folder; `letter` is p, q, d or r.
  std::string file(char letter, const std::string& name) const { return folder_ + "/" + letter + "." + name; }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  /// The p-, q-, d- and r-file of a branch.
  std::vector<std::string> files_of(const std::string& name) const;
  /// What the commands at a label make for the branch of a name.
  NextNames names_of(const std::string& name) const { return {path(name), path(name + "_start"), path(name)}; }

  CommandJob sweep() const;
  /// From each of these states, as --state takes them, at every value.
  CommandJob sweep_from(const std::vector<std::string>& states) const;
  /// A branch through what a simulation settles on from a state: `words` of `tchat simulate` that give it.
  CommandJob start(const std::string& name, double value, const Command& words, bool rests) const;
  /// What begins at a labelled point, whose commands make the files of names_of(name).
  CommandJob switching(const std::string& name, const SwitchPoint& at) const;
  /// One direction of a switch that goes in both: with its DS, or with this one, which is for the other direction.
  static CommandJob one_direction(CommandJob both, std::optional<double> other_ds);
  static bool goes_in_both_directions(const CommandJob& job);
  /// The same job with at most so many points.
  static CommandJob with_points(CommandJob job, int points);
  /// Does the command line limit the points of runs?
  bool limits_points() const;
  /// The run along the known branch.
  CommandJob correction(const OrbitComparison& at) const;
  /// The equilibrium of a label as that of another field.
  Command in_other_field(const std::string& name, const std::string& branch, int label, int field) const;
  /// Orbits with one impact in so many returns that begin at a grazing point.
  CommandJob born(const std::string& name, const SwitchPoint& at, int returns) const;
  /// The same at a label of the files `source`, to those of `name`.
  Commands born_commands(const std::string& source, const std::string& label, int returns,
                         const std::string& name) const;
  /// `tchat simulate` of an attractor, with the `words` that begin on it.
  Command show(double value, const Command& words) const;
  /// A job of runs from the files of `source`.
  CommandJob job_from(const std::string& source, const std::string& name, Commands commands) const;
  /// KEY=VALUE of the command line for all runs.
  const Command& constants() const { return constants_; }

 private:
  Command run_words(bool rests = false) const;
  /// The same without DS: its sign has been chosen.
  Command run_words_without_step() const;
  CommandJob sweep_job(const std::string& name, const std::vector<std::string>& states, const Command& options) const;
  CommandJob job(const std::string& name, Commands commands, std::vector<std::string> inputs) const;
  std::string at_value(double value) const;

  const ExploreRequest& request_;
  std::string watched_;  ///< "[1,2]", all events, where none has a jump: a contact changes nothing
  SweptRange range_;
  std::string folder_;
  std::string problem_;
  GivenFiles given_;
  Command parameters_, constants_;  ///< KEY=VALUE of the command line
  std::vector<std::string> monitors_;
};

/// Does a word of the command line set a parameter?
bool sets_parameter(const std::string& word);

}  // namespace tchat
