#include "motion/mode_rule.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/user_error.hpp"
#include "model/relevant_events.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

void add_once(std::vector<int>& events, int event) {
  if (std::find(events.begin(), events.end(), event) == events.end()) events.push_back(event);
}

std::string one(const IndexVector& v) { return fmt::format("({},{},{})", v.field, v.event, v.jump); }

}  // namespace

std::string state_text(const VectorXd& x) {
  constexpr Eigen::Index most_shown = 12;
  const Eigen::Index shown = std::min(x.size(), most_shown);
  const std::string more = x.size() > shown ? fmt::format(", and {} more", x.size() - shown) : "";
  return fmt::format("({:.6g}{})", fmt::join(x.begin(), x.begin() + shown, ", "), more);
}

std::vector<int> Mode::terminal_events() const {
  std::vector<int> events;
  for (const IndexVector& v : index_vectors) add_once(events, v.event);
  return events;
}

std::vector<int> Mode::all_events() const {
  std::vector<int> events = terminal_events();
  for (const int event : monitored) add_once(events, event);
  return events;
}

const IndexVector& Mode::ended_by(int event) const {
  return *std::find_if(index_vectors.begin(), index_vectors.end(), [&](const auto& v) { return v.event == event; });
}

std::string fault_of(const HybridSystem& system, const std::vector<IndexVector>& index_vectors) {
  if (index_vectors.empty()) return "no index vector at all";
  const auto limit = [&](const char* what, int index, FunctionKind kind, const IndexVector& v) -> std::string {
    if (index >= 1 && index <= system.count(kind)) return "";
    return fmt::format("{}: {} {} does not exist, {} has 1..{}", one(v), what, index, system.name(),
                       system.count(kind));
  };
  for (const IndexVector& v : index_vectors) {
    for (const std::string& fault :
         {limit("field", v.field, FunctionKind::field, v), limit("event function", v.event, FunctionKind::event, v),
          limit("jump", v.jump, FunctionKind::jump, v)})
      if (!fault.empty()) return fault;
    if (v.field != index_vectors.front().field)
      return fmt::format("{} and {}: index vectors watched together must have the same field",
                         one(index_vectors.front()), one(v));
  }
  return "";
}

Mode ModeRule::of_cycle(const IndexVector& from, const VectorXd& x, const VectorXd& par) const {
  Mode mode = cycle_[position_];
  if (monitor_ == Monitor::as_given) return mode;
  const auto following = system_.successors(from, x.data(), par.data()).value_or(std::vector<IndexVector>{});
  const bool goes_on =
      std::any_of(following.begin(), following.end(), [&](const IndexVector& v) { return v.field == mode.field(); });
  if (!goes_on) return mode;
  mode.monitored = relevant_events(system_, following, mode.field(), x.data(), par.data());
  std::erase(mode.monitored, mode.index_vectors.front().event);
  return mode;
}

Mode ModeRule::first(const VectorXd& x, const VectorXd& par) {
  position_ = 0;
  if (is_cyclic()) return of_cycle(cycle_.back().index_vectors.front(), x, par);
  if (start_) return *start_;
  const auto start = system_.successors({0, 0, 0}, x.data(), par.data());
  if (!start || start->empty())
    throw UserError(
        fmt::format("{} does not say in which mode a simulation starts (its successors of (0,0,0) at the start); say "
                    "which index vectors to watch, as in --mode 1,2,1 or --mode '1,2,1;1,3,2'",
                    system_.name()));
  if (const std::string fault = fault_of(system_, *start); !fault.empty())
    throw UserError(
        fmt::format("the successors that {} gives for a start, (0,0,0), cannot be watched: {}", system_.name(), fault));
  return {*start, {}};
}

Mode ModeRule::next(const IndexVector& from, const VectorXd& x, const VectorXd& par) {
  if (is_cyclic()) {
    position_ = (position_ + 1) % cycle_.size();
    return of_cycle(from, x, par);
  }
  const auto next = system_.successors(from, x.data(), par.data());
  const std::string fault = next ? fault_of(system_, *next) : "it cannot be evaluated";
  if (fault.empty()) return {*next, {}};
  fault_ = fmt::format("the index jump function (successors) of {} at the end of {}, x = {}: {}", system_.name(),
                       one(from), state_text(x), fault);
  return {};
}

}  // namespace tchat
