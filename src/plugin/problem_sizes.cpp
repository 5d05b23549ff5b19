#include "plugin/problem_sizes.hpp"

#include <algorithm>

#include "hybrid/parameter_vector.hpp"

namespace tchat {

namespace {

constexpr int grazing_curve = 150;

void sort_and_unite(std::vector<int>& indices) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

}  // namespace

ProblemSizes problem_sizes(const RunSettings& settings) {
  ProblemSizes sizes;
  sizes.dimension = settings.dimension;
  sizes.segments = static_cast<int>(settings.segments.size());
  sizes.derivative_order = settings.derivative_order;
  for (const int k : settings.free_parameters)
    if (k < first_duration) sizes.parameters = std::max(sizes.parameters, k);
  for (const SegmentSettings& segment : settings.segments) {
    sizes.fields.push_back(segment.index.field);
    sizes.events.push_back(segment.index.event);
    sizes.events.insert(sizes.events.end(), segment.monitor.begin(), segment.monitor.end());
    sizes.jumps.push_back(segment.index.jump);
  }
  if (settings.problem_type == grazing_curve) sizes.jumps.push_back(settings.grazing_jump);
  for (std::vector<int>* const indices : {&sizes.fields, &sizes.events, &sizes.jumps}) sort_and_unite(*indices);
  return sizes;
}

}  // namespace tchat
