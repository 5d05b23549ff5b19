/// A page (HTML) that shows a sheet in a browser: with zoom, the values of points, and the orbits of labels.
///
/// It is one file without dates and needs no network: D3 and our own script and style are in it, the data are JSON.
#pragma once

#include <string>
#include <vector>

#include "files/branch_file.hpp"
#include "plot/page_branch.hpp"
#include "plot/picture_sheet.hpp"

namespace tchat {

/// What a page shows besides the sheet.
struct PageContents {
  std::vector<std::vector<BranchFile>> branches;  ///< of each figure, as its computed points count them
  PageBranchOptions options;
  std::string name;  ///< title of the window where the sheet has none
};

/// Throws UserError for a figure in space.
std::string page_html(const SheetLayout& sheet, const PageContents& contents);

}  // namespace tchat
