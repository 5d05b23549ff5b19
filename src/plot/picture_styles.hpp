/// How things look by default: colours that stay apart in grey, dashes, and symbols of special points.
#pragma once

#include <string>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

/// Colour of the k-th file or orbit (from 0): black first, then colours that differ for the colour-blind and in grey.
std::string series_colour(std::size_t k);

/// Dashes of the k-th orbit in one picture.
Dash series_dash(std::size_t k);

/// The marker of a special point by its letters (LP, PD, GR, ...), with the letters as its label.
Marker special_point_marker(const std::string& type, const PicturePoint& at);

/// The types that are labelled when the user says nothing: bifurcations, grazing, codimension two; not UZ, RG, EP, MX.
bool is_labelled_by_default(const std::string& type);

/// All letters that points can have, for messages.
std::vector<std::string> all_point_types();

/// What a two-parameter curve consists of, by the type number of its points (5, 7, 8), or 0 for grazing orbits.
struct CurveKind {
  std::string name;
  Stroke stroke;
};
CurveKind curve_kind(int curve_type, bool grazing);

}  // namespace tchat
