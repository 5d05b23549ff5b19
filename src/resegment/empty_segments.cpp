#include "resegment/empty_segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/user_error.hpp"
#include "model/identity_jump.hpp"
#include "model/relevant_events.hpp"

namespace tchat {

namespace {

constexpr double fit_tolerance = 1e-4;

std::vector<IndexVector> successors(const HybridSystem& system, const IndexVector& from, const Eigen::VectorXd& x,
                                    const ParameterVector& par) {
  return system.successors(from, x.data(), par.data()).value_or(std::vector<IndexVector>{});
}

bool has_field(const std::vector<IndexVector>& list, int field) {
  return std::any_of(list.begin(), list.end(), [&](const IndexVector& v) { return v.field == field; });
}

struct Following {
  Eigen::VectorXd at;
  std::vector<IndexVector> list;  ///< empty where nothing was found
};

/// At x or beside it, in the direction of one state.
Following successors_with_field(const HybridSystem& system, const IndexVector& before, const Eigen::VectorXd& x,
                                const ParameterVector& par, int field) {
  constexpr double beside = 1e-3;
  for (Eigen::Index k = -1; k < 2 * x.size(); ++k) {
    Eigen::VectorXd at = x;
    if (k >= 0) at(k / 2) += (k % 2 == 0 ? beside : -beside) * (1.0 + std::abs(x(k / 2)));
    std::vector<IndexVector> list = successors(system, before, at, par);
    if (has_field(list, field)) return {at, std::move(list)};
  }
  return {x, {}};
}

std::string event_text(const HybridSystem& system, int event) {
  return fmt::format("event {} ({})", event, system.function_name(FunctionKind::event, event));
}

}  // namespace

Signature segments_after_impact(const HybridSystem& system, const IndexVector& after, const Eigen::VectorXd& x,
                                const ParameterVector& par, int next_field) {
  if (!system.has_successors()) return {};
  const std::vector<IndexVector> following = successors(system, after, x, par);
  if (following.empty() || has_field(following, next_field)) return {};
  Eigen::VectorXd start(x.size());
  system.value(FunctionKind::jump, after.jump, x.data(), par.data(), start.data());
  Signature candidates;
  for (const IndexVector& v : following)
    if (std::abs(system.event(v.event, start.data(), par.data())) < fit_tolerance &&
        has_field(successors(system, v, start, par), next_field))
      candidates.push_back(v);
  if (candidates.size() == 1) return candidates;
  throw UserError(fmt::format(
      "after {} the index jump function of problem {} allows {}, and {} of these can last no time and be followed by "
      "field {} ({}); give the whole signature, for example --signature \"1,1,1;2,2,2\", where two events come at once "
      "with --to signature",
      to_string({after}), system.name(), to_string(following), candidates.empty() ? "none" : to_string(candidates),
      next_field, system.function_name(FunctionKind::field, next_field)));
}

std::vector<int> watched_after(const HybridSystem& system, const IndexVector& before, const Eigen::VectorXd& x,
                               const ParameterVector& par, const IndexVector& own, int next_field) {
  const auto [at, following] = successors_with_field(system, before, x, par, own.field);
  Eigen::VectorXd start(x.size());
  system.value(FunctionKind::jump, before.jump, at.data(), par.data(), start.data());
  std::vector<int> events = relevant_events(system, following, own.field, start.data(), par.data());
  std::erase(events, own.event);
  const bool ends_in_section = is_identity_jump(system, own) && next_field == own.field;
  const bool is_listed = std::find(following.begin(), following.end(), own) != following.end();
  if (is_listed && !ends_in_section) events.push_back(own.event);
  std::sort(events.begin(), events.end());
  return events;
}

void require_fit(const HybridSystem& system, const Signature& signature, const Orbit& x) {
  const int m = x.shape.segments;
  const double* par = x.par.data();
  for (int s = 0; s < m; ++s) {
    const IndexVector& v = signature[static_cast<std::size_t>(s)];
    const Eigen::Map<const Eigen::VectorXd> end(x.end(s), x.shape.dimension);
    const Eigen::Map<const Eigen::VectorXd> next(x.start((s + 1) % m), x.shape.dimension);
    const double scale = fit_tolerance * (1.0 + end.lpNorm<Eigen::Infinity>());
    const double h = system.event(v.event, end.data(), par);
    if (!(std::abs(h) <= scale))
      throw UserError(
          fmt::format("signature {} does not fit the orbit: {} is {:.4g}, not 0, at the end of segment {}; constants "
                      "or problem are not those of the run that wrote the label, or the signature is wrong",
                      to_string(signature), event_text(system, v.event), h, s + 1));
    Eigen::VectorXd after(end.size());
    system.value(FunctionKind::jump, v.jump, end.data(), par, after.data());
    Eigen::Index worst = 0;
    const double gap = (after - next).cwiseAbs().maxCoeff(&worst);
    if (!(gap <= scale))
      throw UserError(fmt::format(
          "signature {} does not fit the orbit: jump {} ({}) at the end of segment {} leads to {} = {:.6g}, segment {} "
          "starts with {:.6g}",
          to_string(signature), v.jump, system.function_name(FunctionKind::jump, v.jump), s + 1,
          system.state_name(static_cast<int>(worst) + 1), after(worst), (s + 1) % m + 1, next(worst)));
  }
}

}  // namespace tchat
