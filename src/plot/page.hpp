/// Pages (HTML) that show a sheet in a browser, and sweeps as JSON for their script.
#pragma once

#include <string>
#include <vector>

#include "files/branch_file.hpp"
#include "plot/page_branch.hpp"
#include "plot/picture_sheet.hpp"
#include "plot/underlay.hpp"

namespace tchat {

// A page (HTML) that shows a sheet in a browser: with zoom, the values of points, and the orbits of labels.
//
// It is one file without dates and needs no network: D3 and our own script and style are in it, the data are JSON.

/// What the points of a figure are from, as its computed points and dots count them.
struct FigureFiles {
  std::vector<BranchFile> branches;
  std::vector<SweepFile> sweeps;
};

/// What a page shows besides the sheet.
struct PageContents {
  std::vector<FigureFiles> files;  ///< of each figure
  PageBranchOptions options;
  std::string name;  ///< title of the window where the sheet has none
};

/// Throws UserError for a figure in space.
std::string page_html(const SheetLayout& sheet, const PageContents& contents);

/// Columns by name, among them `kind` in words; of a sweep with more than 400,000 numbers the names alone, so that a
/// page stays small.
std::string sweep_json(const SweepFile& file);

}  // namespace tchat
