/// How things look by default: colours that stay apart in grey, dashes, and symbols of special points.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "files/line_kind.hpp"
#include "plot/figure.hpp"

namespace tchat {

/// Colour of the k-th file or orbit (from 0): black first, then colours that differ for the colour-blind and in grey.
std::string series_colour(std::size_t k);

/// Colour of the k-th cloud of dots (from 0): pale, for curves lie over it.
std::string cloud_colour(std::size_t k);

/// A dot as large as those of clouds.
Marker cloud_marker(const std::string& colour);

/// Symbol of the k-th orbit in one picture, for its jumps.
Symbol series_symbol(std::size_t k);

/// Solid, dashed and thinner, or dotted and paler; `width` is that of a stable line.
Stroke line_stroke(LineKind kind, const std::string& colour, double width);

/// From the state before a jump to that behind it: thin and pale, for nothing moves along it.
Stroke jump_stroke(const std::string& colour);

/// What the dashes of these kinds mean, as lines of the key.
std::vector<KeyEntry> line_kind_entries(const std::set<LineKind>& kinds, const std::string& colour, double width);

/// The marker of a special point by its letters (LP, PD, GR, ...), with the letters as its label.
Marker special_point_marker(const std::string& type, const PicturePoint& at);

/// The types that are labelled when the user says nothing: bifurcations, grazing, codimension two; not UZ, RG, EP, MX.
bool is_labelled_by_default(const std::string& type);

/// All letters that points can have, for messages.
std::vector<std::string> all_point_types();

/// What a two-parameter curve consists of, by the letters of its points ("" where files do not tell), or grazing
/// orbits. It has a colour, and small symbols along it: those of the special points that make the curve.
struct CurveKind {
  std::string name;
  std::string colour;
  Symbol symbol = Symbol::circle;
  bool filled = true;
};
CurveKind curve_kind(const std::string& letters, bool grazing);

/// Several curves in one picture: the first of a kind has the colour of the kind, further ones others; as long as there
/// are colours each has its own.
std::vector<CurveKind> with_own_colours(std::vector<CurveKind> kinds);

/// The k-th (from 0) of the colours that none of these curves has; from the beginning again when there are no more.
std::string unused_colour(const std::vector<CurveKind>& curves, std::size_t k);

}  // namespace tchat
