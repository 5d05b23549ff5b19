/// Bifurcation diagrams: branches as smooth lines, cut where they leave their bounds.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "files/branch_file.hpp"
#include "plot/figure.hpp"
#include "plot/underlay.hpp"

namespace tchat {

// Bifurcation diagrams: branches of one or several p-files in one picture.
//
// A branch against one parameter is solid where the orbits are stable and dashed where they are not (sign of PT); the
// line from a point to the next is that of the next point, for at a located bifurcation the sign of the point before
// is written. Inadmissible orbits are thin and dotted and leave the ranges of the axes to the others. A curve in two
// parameters is solid and has the colour of its kind (grazing, fold, period doubling, torus); several of them have
// symbols along them, too. Lines end at the bounds of their runs.

struct LabelSelection {
  bool all = false;
  bool defaults = true;            ///< the types that are labelled when the user says nothing
  std::vector<std::string> types;  ///< these types, when neither
  bool numbers = false;            ///< with the number of the label

  bool includes(const std::string& type) const;
};

/// Dots beneath the branches.
struct NamedCloud {
  std::string name;            ///< in the key
  std::string x_name, y_name;  ///< of the axes when there are no branches
  std::vector<PicturePoint> points;
};

struct BranchFigureOptions {
  std::string x, y;  ///< what read_quantity takes; empty: default_columns
  LabelSelection labels;
  std::vector<std::string> legend = {};  ///< a text for each file; empty: chosen here
  std::vector<NamedCloud> clouds = {};
  Underlay underlay = {};
  /// Branches in one parameter, which then have no line in the key; curves have one for each kind.
  bool black = false;
};

/// `files` may be empty when there are clouds or an underlay. Throws UserError for columns and expressions that a file
/// does not have. A quantity that is not known at every point gives a warning.
Figure branch_figure(const std::vector<BranchFile>& files, const BranchFigureOptions& options,
                     std::vector<std::string>* warnings = nullptr);

/// How the line from point k - 1 to point k of a branch is drawn.
LineKind line_kind(const BranchFile& file, std::size_t section, std::size_t row);

// Where a branch that has left its bounds is cut in a picture.

/// A run without --clip ends at the first point beyond RL0, RL1 (of the first column) or A0, A1 (of the second). The
/// part of the way from the point before to row `row` that is within the bounds: 1 for every other point. The bounds
/// are those of the header of the p-file, with all digits where r.NAME beside it has the same.
double part_within_bounds(const BranchFile& file, std::size_t section, std::size_t row);

// A smooth line through the computed points of a branch, for the eye only: it passes through every point.

/// Points between consecutive points: element k holds what lies from points[k] to points[k + 1], both ends included.
/// Catmull-Rom splines with the distances (in the units `scale`) as parameters; a straight line where the branch has a
/// corner or a point that cannot be shown, and where points are close already.
std::vector<std::vector<PicturePoint>> smooth_intervals(const std::vector<PicturePoint>& points,
                                                        const PicturePoint& scale);

}  // namespace tchat
