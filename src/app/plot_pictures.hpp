/// From files and options to a figure: which kind of picture is meant, and the data for it.
#pragma once

#include <string>
#include <vector>

#include "app/plot_arguments.hpp"
#include "plot/figure.hpp"
#include "plot/page.hpp"

namespace tchat {

struct NamedFigure {
  Figure figure;
  std::string name;  ///< for a file that the user did not name
  std::vector<std::string> warnings;
  FigureFiles files = {};  ///< of its computed points and of its dots
};

/// Throws UserError for files and labels that do not fit the kind of picture.
NamedFigure make_figure(const std::vector<PlotItem>& items, const PlotArguments& arguments);

}  // namespace tchat
