#include "maps/return_path.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/user_error.hpp"
#include "motion/cvodes_flow.hpp"
#include "motion/mode_rule.hpp"

namespace tchat {

namespace {

std::vector<IndexVector> following(const HybridSystem& system, const IndexVector& from, const Eigen::VectorXd& z,
                                   const Eigen::VectorXd& par) {
  return system.successors(from, z.data(), par.data()).value_or(std::vector<IndexVector>{});
}

}  // namespace

Signature return_path(const HybridSystem& system, const Eigen::VectorXd& z, const Eigen::VectorXd& par, int section,
                      int field, const FlowOptions& given, int most) {
  FlowOptions options = given;
  options.variational = false;
  Signature path;
  Eigen::VectorXd x = z;
  std::vector<IndexVector> mode = following(system, {0, 0, 0}, x, par);
  while (static_cast<int>(path.size()) < most) {
    if (!mode.empty()) field = mode.front().field;
    std::vector<int> events{section};
    for (const IndexVector& index : mode)
      if (std::find(events.begin(), events.end(), index.event) == events.end()) events.push_back(index.event);
    CvodesFlow flow(system, field, x, par, options);
    flow.watch(events);
    const Progress progress = flow.advance(options.max_duration);
    if (progress == Progress::failed) throw ComputationError(flow.message());
    if (progress != Progress::root)
      throw ComputationError(fmt::format("the flow from {} does not come back to the section within time {:g}",
                                         state_text(z), options.max_duration));
    if (flow.fallen() == section) {
      path.push_back({field, section, no_function});
      return path;
    }
    const Mode watched{mode, {}};
    const IndexVector index = watched.ended_by(flow.fallen());
    path.push_back(index);
    const Eigen::VectorXd before = flow.state();
    system.value(FunctionKind::jump, index.jump, before.data(), par.data(), x.data());
    mode = following(system, index, before, par);
  }
  throw ComputationError(
      fmt::format("the flow from {} does not come back to the section within {} events", state_text(z), most));
}

}  // namespace tchat
