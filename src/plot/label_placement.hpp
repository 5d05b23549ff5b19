/// Where labels of points stand on the paper: beside their points, clear of one another, of markers and of curves.
///
/// Each label is tried in directions all around its point at a few distances. A place costs what it covers: other
/// labels and what is outside the frame much, markers less, curves by the length covered, distance and an unusual
/// direction a little. The labels take the cheapest places one after the other and are then moved in turn while that
/// helps. A label that finds no place free of other labels is left out.
#pragma once

#include <optional>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

/// Pixels, y upwards.
struct Box {
  double left = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  double top = 0.0;

  double width() const { return right - left; }
  double height() const { return top - bottom; }
  PicturePoint centre() const { return {0.5 * (left + right), 0.5 * (bottom + top)}; }
  bool contains(const PicturePoint& p) const { return p.x >= left && p.x <= right && p.y >= bottom && p.y <= top; }
  Box grown(double by) const { return {left - by, right + by, bottom - by, top + by}; }
};

/// The area that two boxes share.
double shared_area(const Box& a, const Box& b);

/// How much of the line from a to b is inside the box.
double length_inside(const Box& box, const PicturePoint& a, const PicturePoint& b);

/// What labels keep clear of.
struct Obstacles {
  Box frame;                                      ///< labels stay inside
  std::vector<std::vector<PicturePoint>> curves;  ///< polylines, interrupted by points that are not finite
  std::vector<Box> markers;
  std::vector<Box> forbidden;           ///< the key
  std::vector<PicturePoint> dots = {};  ///< of clouds: only the key keeps clear of them

  /// Length of curves in the box.
  double curve_length(const Box& box) const;
};

struct LabelRequest {
  PicturePoint at;
  double width = 0.0;
  double height = 0.0;
  double clearance = 0.0;    ///< from the point to the label, the marker's radius included
  bool only_beside = false;  ///< one of many: rather none than one far away or on a marker
};

struct PlacedLabel {
  Box box;
  bool far = false;  ///< a thin line from the point shows what it belongs to
};

/// One place for each request; nothing for a label that must be left out.
std::vector<std::optional<PlacedLabel>> place_labels(const std::vector<LabelRequest>& requests,
                                                     const Obstacles& obstacles);

}  // namespace tchat
