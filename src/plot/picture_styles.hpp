/// How things look by default: colours that stay apart in grey, dashes, and symbols of special points.
#pragma once

#include <string>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

/// Colour of the k-th file or orbit (from 0): black first, then colours that differ for the colour-blind and in grey.
std::string series_colour(std::size_t k);

/// Colour of the k-th cloud of dots (from 0): pale, for curves lie over it.
std::string cloud_colour(std::size_t k);

/// A dot as large as those of clouds.
Marker cloud_marker(const std::string& colour);

/// Line of the k-th orbit in one picture.
Stroke series_stroke(std::size_t k, double width);

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

/// Lines of several curves in one picture. The first of a kind has the line of the kind, further ones other dashes of
/// the same character; as long as there are colours each has its own.
std::vector<Stroke> curve_strokes(const std::vector<CurveKind>& kinds);

/// The k-th (from 0) of the colours that none of these lines has; from the beginning again when there are no more.
std::string unused_colour(const std::vector<Stroke>& lines, std::size_t k);

}  // namespace tchat
