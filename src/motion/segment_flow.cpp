#include "motion/segment_flow.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/user_error.hpp"
#include "model/event_at.hpp"
#include "model/parameter_vector.hpp"
#include "motion/cvodes_flow.hpp"

namespace tchat {

namespace {

using Eigen::RowVectorXd;
using Eigen::VectorXd;

void require(bool condition, const std::string& what) {
  if (!condition) throw UserError("integration: " + what);
}

void require_index(const HybridSystem& system, FunctionKind kind, int index, const char* what) {
  const int count = system.count(kind);
  require(index >= 1 && index <= count,
          fmt::format("{} {} does not exist, {} has 1..{}.", what, index, system.name(), count));
}

VectorXd checked_parameters(const HybridSystem& system, int field, const VectorXd& x0, const VectorXd& par,
                            const FlowOptions& options) {
  require_index(system, FunctionKind::field, field, "field");
  require(x0.size() == system.dimension(),
          fmt::format("the state has {} entries, {} has dimension {}.", x0.size(), system.name(), system.dimension()));
  require(x0.allFinite(), "the state at the start is not finite.");
  for (const int k : options.active)
    require(k >= 1 && k < system.layout().first_duration(),
            fmt::format("PAR({}) is no parameter, allowed are 1..{}.", k, system.layout().first_duration() - 1));
  return full_parameters(system, par);
}

SegmentFlow result_at(const CvodesFlow& flow, FlowStatus status) {
  SegmentFlow result;
  result.status = status;
  if (status == FlowStatus::failed) result.message = flow.message();
  result.duration = flow.time();
  result.end_state = flow.state();
  result.jacobian = flow.jacobian();
  result.parameter_derivative = flow.parameter_derivative();
  return result;
}

}  // namespace

VectorXd full_parameters(const HybridSystem& system, const VectorXd& par) {
  require(par.size() >= system.parameters(),
          fmt::format("{} parameter values given, {} needs {}.", par.size(), system.name(), system.parameters()));
  require(par.allFinite(), "a parameter value is not finite.");
  VectorXd full = VectorXd::Zero(std::max<Eigen::Index>(par.size(), system.layout().room()));
  full.head(par.size()) = par;
  return full;
}

SegmentFlow integrate_segment(const HybridSystem& system, const IndexVector& index, const VectorXd& x0,
                              const VectorXd& par_given, const FlowOptions& options) {
  const VectorXd par = checked_parameters(system, index.field, x0, par_given, options);
  require_index(system, FunctionKind::event, index.event, "event function");
  CvodesFlow flow(system, index.field, x0, par, options);
  flow.watch({index.event});
  const Progress progress = flow.advance(options.max_duration);
  if (progress == Progress::failed) return result_at(flow, FlowStatus::failed);
  SegmentFlow result =
      result_at(flow, progress == Progress::root ? FlowStatus::event_reached : FlowStatus::time_reached);
  result.event_velocity = event_at(system, index.event, index.field, result.end_state.data(), par.data()).rate();
  if (result.status == FlowStatus::time_reached)
    result.message = fmt::format("{} did not fall to zero within time {:g}",
                                 system.function_name(FunctionKind::event, index.event), options.max_duration);
  return result;
}

SegmentFlow integrate_for(const HybridSystem& system, int field, const VectorXd& x0, const VectorXd& par_given,
                          double duration, const FlowOptions& options) {
  const VectorXd par = checked_parameters(system, field, x0, par_given, options);
  require(std::isfinite(duration), "the duration is not finite.");
  CvodesFlow flow(system, field, x0, par, options);
  const Progress progress = flow.advance(duration);
  return result_at(flow, progress == Progress::failed ? FlowStatus::failed : FlowStatus::time_reached);
}

}  // namespace tchat
