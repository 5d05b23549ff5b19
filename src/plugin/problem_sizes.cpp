#include "plugin/problem_sizes.hpp"

#include <algorithm>

#include "model/parameter_layout.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

void insert(std::vector<int>& ascending, int index) {
  if (index == no_function) return;
  const auto place = std::lower_bound(ascending.begin(), ascending.end(), index);
  if (place == ascending.end() || *place != index) ascending.insert(place, index);
}

}  // namespace

void ProblemSizes::add(const IndexVector& index) {
  insert(fields, index.field);
  insert(events, index.event);
  insert(jumps, index.jump);
}

void ProblemSizes::add_jump(int k) { insert(jumps, k); }

ProblemSizes problem_sizes(const RunSettings& settings) {
  ProblemSizes sizes;
  sizes.dimension = settings.dimension;
  sizes.segments = static_cast<int>(settings.segments.size());
  sizes.derivative_order = settings.derivative_order;
  if (signature_rules(settings).counts_conditions) {
    sizes.boundary_conditions = settings.boundary_conditions;
    sizes.integral_conditions = settings.integral_conditions;
  }
  const ParameterLayout few;  // no more parameters are known without the problem
  const bool has_rotation = family_of(settings).facts().has_rotation;
  for (const int k : settings.free_parameters)
    if (k < few.first_duration() && !(has_rotation && k == few.rotation()))
      sizes.parameters = std::max(sizes.parameters, k);
  for (const SegmentSettings& segment : settings.segments) {
    sizes.add(segment.index);
    for (const int event : segment.monitor) insert(sizes.events, event);
  }
  const bool is_given = settings.grazing_jump != RunSettings{}.grazing_jump;
  if (keeps_contact(settings.problem_type) || is_given) sizes.add_jump(settings.grazing_jump);
  return sizes;
}

}  // namespace tchat
