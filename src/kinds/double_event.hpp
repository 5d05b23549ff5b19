/// Periodic orbits at which two events come at once (orbit/curve_conditions.hpp): where sliding begins or ends
/// (crossing- and switching-sliding), or where an impact meets another surface.
#pragma once

#include <memory>

namespace tchat {

class DefiningSystem;
class OrbitCondition;
struct SelectedStart;

/// The second event function vanishes where the GR label of the start says. Throws UserError where no such curve
/// starts.
std::unique_ptr<OrbitCondition> double_event_condition(const DefiningSystem& defining, const SelectedStart& start);

}  // namespace tchat
