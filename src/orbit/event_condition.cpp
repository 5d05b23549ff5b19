#include "orbit/event_condition.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"

#include <cmath>
#include <utility>

namespace tchat {

EventCondition::EventCondition(const DefiningSystem& system, const OrbitShape& shape, int segment, int event,
                               bool at_end)
    : system_(system), segment_(segment), event_(event), at_end_(at_end), gradient_(shape, system.free_count()) {
  gradient_.set_zero();
}

bool EventCondition::evaluate(CondensedSystem&, const Orbit& x) {
  const int column = at_end_ ? x.shape.last_node(segment_) : x.shape.first_node(segment_);
  if (column != column_) gradient_.states.col(std::exchange(column_, column)).setZero();
  double* const by_state = gradient_.states.col(column).data();
  system_.system().first(FunctionKind::event, event_, x.states.col(column).data(), x.par.data(),
                         system_.free_parameters(), &value_, by_state, gradient_.globals.data());
  return std::isfinite(value_) && all_finite(by_state, x.shape.dimension) &&
         all_finite(gradient_.globals.data(), system_.free_count());
}

}  // namespace tchat
