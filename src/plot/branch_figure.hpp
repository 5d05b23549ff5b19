/// Bifurcation diagrams: branches of one or several p-files in one picture.
///
/// A branch against one parameter is solid where the orbits are stable and dashed where they are not (sign of PT); the
/// line from a point to the next is that of the next point, for at a located bifurcation the sign of the point before
/// is written. Inadmissible orbits are thin and dotted and leave the ranges of the axes to the others. A curve in two
/// parameters is solid and has the colour of its kind (grazing, fold, period doubling, torus); several of them have
/// symbols along them, too. Lines end at the bounds of their runs.
#pragma once

#include <string>
#include <vector>

#include "files/branch_file.hpp"
#include "plot/figure.hpp"
#include "plot/picture_styles.hpp"
#include "plot/underlay.hpp"

namespace tchat {

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

}  // namespace tchat
