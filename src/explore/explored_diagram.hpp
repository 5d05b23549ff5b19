/// What `tchat explore` finds: branches with what each came from, orbits that lead to branches that are there, what is
/// left, and how much of a sweep lies on branches.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "explore/command_job.hpp"
#include "explore/swept_range.hpp"
#include "files/point_file_reader.hpp"

namespace tchat {

/// A labelled point of a branch.
struct ExploredLabel {
  int label = 0;
  std::string type;  ///< GR, PD, ...
  double parameter = 0.0;
  std::string leads_to;  ///< the branch that the switch there follows; "" without one
  std::string remark;    ///< why there is none, where one was tried or left out
  std::string curve;     ///< the curve in two parameters through it; "" without one
};

struct ExploredBranch {
  std::string name;    ///< of its files in the folder
  std::string parent;  ///< "" for an attractor
  std::string origin;  ///< "attractor 2 at alpha = 3.05", "PD 4"
  int doublings = 0;
  bool has_returns = false;     ///< one impact in several returns to grazing, or from such a branch
  double from = 0.0, to = 0.0;  ///< range of the parameter
  std::vector<std::string> signatures;
  std::vector<std::string> ends;  ///< why each direction ended
  std::vector<ExploredLabel> labels;
  CommandJob job;
};

/// An attractor of the sweep that lies on no branch.
struct UnexplainedAttractor {
  std::string attractor;  ///< "a3": attractor 3 of the sweep; "b2": of the further starts
  std::string kind;
  double first = 0.0, last = 0.0;  ///< values at which it is
  int count = 0;
  std::string command;   ///< that shows it at the first value
  int segments = 0;      ///< of a periodic one: more than --segments are not followed
  std::string leads_to;  ///< the branch that a start on it has led to nevertheless
};

struct ExploredDiagram {
  std::string parameter;
  std::vector<CommandJob> first_jobs;  ///< the sweep
  std::string quantity;                ///< along the picture's y-axis; "": that of tchat plot
  std::vector<CommandJob> last_jobs;   ///< picture and page
  std::vector<ExploredBranch> branches;
  std::vector<std::string> joins;     ///< "a1_PD3: a2 again"
  std::vector<std::string> failures;  ///< commands that failed, with their messages
  std::vector<UnexplainedAttractor> unexplained;
  int periodic = 0, at_rest = 0, on_branches = 0;  ///< attractors over all values and starts
  int on_several = 0;                              ///< periodic ones that more than one branch may have
  std::map<std::string, int> others;               ///< motions of other kinds: chaotic, ...
  bool complete = true;                            ///< false: interrupted
  std::map<std::string, int> left;  ///< what a budget left: how many labels and attractors were not followed
};

/// The signatures of the sections of a p-file, each once.
std::vector<std::string> signatures_of(const PointFile& points);
/// Sets signatures and range of a branch from its p-file. Points that a clipped run has beyond `range` do not count.
void describe_points(const PointFile& points, const SweptRange& range, ExploredBranch& branch);

/// "GR 2 at 3.035 -> a2"
std::string label_text(const ExploredLabel& label);
std::string branch_json(const ExploredBranch& branch);

/// The tree of branches, coverage and what is left, for people.
std::string tree_text(const ExploredDiagram& diagram);
/// The same as JSON. `further`: members of the object, each with a comma and a newline before it.
std::string tree_json(const ExploredDiagram& diagram, const std::string& further = "");
/// All that make its files, each after those that make its inputs.
std::vector<CommandJob> jobs_of(const ExploredDiagram& diagram);

}  // namespace tchat
