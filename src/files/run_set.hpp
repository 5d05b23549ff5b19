/// The files p.O, q.O, d.O and r.O of one run as a set, and how a set is kept when a new one takes its place.
///
/// At every instant, whatever is killed, a complete set that there was is complete as p.O, q.O, d.O or as p.O~, q.O~,
/// d.O~: the old set gets its second names while it still stands, its d-file last, and only then are its files replaced
/// one by one, the d-file first. A set whose d-file does not close a run is never taken for a complete one. The same
/// holds when the power fails: a set is on the disk before its d-file closes it, and its second names are there before
/// the first ones go.
#pragma once

#include <string>
#include <string_view>

namespace tchat {

/// "p.O" in the folder of O: letter 'p', name "results/mems" -> "results/p.mems".
std::string output_path(char letter, const std::string& name);

enum class RunSetState {
  absent,       ///< none of p, q, d
  complete,     ///< holds a complete run: the d-file closes one, and p and q have its last point. More may follow
  interrupted,  ///< a run that has not closed its d-file
  foreign       ///< anything else, such as a q-file from elsewhere: no run of ours would leave these together
};

/// Of p.O, q.O, d.O with `suffix` after their names ("" or "~"). Reads the files, but not the numbers of solutions.
RunSetState run_set_state(const std::string& name, const std::string& suffix = "");

/// Before p.O, q.O, d.O or r.O is replaced: keeps what is there under second names, as p.O~ and so on. A set that is
/// not complete never replaces a complete p.O~: an interrupted one is not kept then, a foreign one is kept as p.O~~.
/// Throws ComputationError.
void keep_run_set(const std::string& name);

/// Writes q.O alone, as a start for runs, under the lock of the name; the set that it replaces a file of is kept.
/// Throws UserError when that cannot be done there, ComputationError.
void replace_solution_file(const std::string& name, std::string_view solutions);

}  // namespace tchat
