/// The picture of an explored diagram and its page: one `tchat plot` of all branches, with the attractors of the sweep
/// beneath.
///
/// Both show max(X), the largest value of a state over one period: branches have it as a monitor, the sweep as a column
/// of --max.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "explore/explored_diagram.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

/// What is drawn, and from which files.
struct DiagramFiles {
  std::string folder;                 ///< O, of the branches
  std::vector<std::string> sweeps;    ///< of attractors
  std::vector<std::string> monitors;  ///< columns of the branches, among them max(X)
  std::string quantity;               ///< along y; empty: chosen_quantity
};

/// The max(X) whose graphs over the parameter differ most from a horizontal line: those of all branches and attractors
/// pass through the largest number of cells of a grid over the picture. The first among equal ones; "" if there is
/// none that is known of all branches.
std::string chosen_quantity(const ExploredDiagram& diagram, const DiagramFiles& files, const SweepTable& sweep);

/// Adds the commands that make O.png, O.svg and O.html, and what they show; nothing to a diagram without branches.
void add_pictures(const DiagramFiles& files, const SweepTable& sweep, ExploredDiagram& diagram);

/// Adds the command that makes O_curves.png of these p-files of curves in two parameters, `second` along y; nothing for
/// none.
void add_curve_picture(const std::string& folder, const std::vector<std::string>& files, const std::string& second,
                       ExploredDiagram& diagram);

/// Runs them, also if they have been run before. Returns a warning for each that failed, whose files are then missing.
std::vector<std::string> draw_pictures(const std::vector<CommandJob>& jobs, const std::string& folder,
                                       const std::function<bool()>& interrupted);

}  // namespace tchat
