#include "model/mode_dimensions.hpp"

#include <fmt/format.h>

#include "model/identity_jump.hpp"

namespace tchat {

void clear_absent(const HybridSystem& system, int field, Eigen::VectorXd& states) {
  states.tail(system.dimension() - system.dimension_of(field)).setZero();
}

std::string mode_fault(const HybridSystem& system, const IndexVector& segment, int next) {
  if (!system.has_modes()) return "";
  const int states = system.dimension_of(next);
  const std::string name = system.function_name(FunctionKind::field, next);
  const int set = segment.jump == no_function ? 0 : system.table().jump_dimensions[segment.jump - 1];
  if (set == states) return "";
  if (segment.jump == no_function || is_identity_jump(system, segment)) {
    if (system.dimension_of(segment.field) <= states) return "";
    return fmt::format(
        "the identity cannot lead from field {} ({}) with {} states to field {} ({}) with {}; use a jump "
        "that sets {} states (dimension_after, or `jump NAME to {}`)",
        segment.field, system.function_name(FunctionKind::field, segment.field), system.dimension_of(segment.field),
        next, name, states, states, name);
  }
  return fmt::format(
      "jump {} ({}) sets {} states, and field {} ({}) after it has {}; use a jump that sets {} "
      "(dimension_after, or `jump NAME to {}`)",
      segment.jump, system.function_name(FunctionKind::jump, segment.jump), set, next, name, states, states, name);
}

}  // namespace tchat
