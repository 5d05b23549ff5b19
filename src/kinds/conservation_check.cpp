#include "kinds/conservation_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/levels.hpp"
#include "model/events.hpp"

namespace tchat {

namespace {

using Eigen::VectorXd;

constexpr double rounding = level::tolerance;

/// The largest relative change, and where it was found.
struct LargestChange {
  double relative = 0.0;
  double change = 0.0;
  VectorXd state;
  int states = 0;

  void add(double new_change, double scale, const VectorXd& x) {
    if (!std::isfinite(new_change)) return;
    ++states;
    if (std::abs(new_change) <= relative * scale && states > 1) return;
    relative = std::abs(new_change) / scale;
    change = new_change;
    state = x;
  }
};

class Conservation {
 public:
  Conservation(const HybridSystem& system, const Quantity& conserved, const VectorXd& par)
      : system_(system), function_(system, conserved, {}), par_(par), n_(system.dimension()) {}

  LargestChange of_field(int field, const std::set<int>& events, const std::vector<VectorXd>& states) const {
    LargestChange largest;
    VectorXd f(n_), gradient(n_);
    std::vector<double> none;
    for (const VectorXd& near : states) {
      const std::optional<VectorXd> admissible = on_admissible_side(events, in_mode(field, near));
      if (!admissible) continue;
      const VectorXd& x = *admissible;
      system_.value(FunctionKind::field, field, x.data(), par_.data(), f.data());
      function_.first(x.data(), par_.data(), gradient.data(), none.data());
      const double scale = gradient.cwiseAbs().dot(f.cwiseAbs());
      largest.add(gradient.dot(f), scale > 0.0 ? scale : 1.0, x);
    }
    return largest;
  }

  LargestChange of_jump(const IndexVector& index, const std::vector<VectorXd>& states) const {
    LargestChange largest;
    VectorXd after(n_), gradient(n_);
    std::vector<double> none;
    for (const VectorXd& near : states) {
      const std::optional<VectorXd> x = on_surface(index.event, in_mode(index.field, near));
      if (!x) continue;
      system_.value(FunctionKind::jump, index.jump, x->data(), par_.data(), after.data());
      const double before = function_.value(x->data(), par_.data());
      function_.first(x->data(), par_.data(), gradient.data(), none.data());
      const double scale = std::abs(before) + gradient.cwiseAbs().dot(x->cwiseAbs());
      largest.add(function_.value(after.data(), par_.data()) - before, scale > 0.0 ? scale : 1.0, *x);
    }
    return largest;
  }

  std::string text(const VectorXd& x) const {
    std::string list;
    for (int k = 1; k <= n_; ++k)
      list += fmt::format("{}{} = {:.4g}", k > 1 ? ", " : "", system_.state_name(k), x(k - 1));
    return list;
  }

 private:
  /// Without what the mode of the field has not.
  VectorXd in_mode(int field, VectorXd x) const {
    x.tail(n_ - system_.dimension_of(field)).setZero();
    return x;
  }

  double event_value(int event, const VectorXd& x) const {
    double h = 0.0;
    system_.value(FunctionKind::event, event, x.data(), par_.data(), &h);
    return h;
  }

  /// A state where none of the event functions is negative: x, mirrored at the surfaces behind which it lies.
  std::optional<VectorXd> on_admissible_side(const std::set<int>& events, VectorXd x) const {
    for (const int event : events) {
      if (event_value(event, x) >= 0.0) continue;
      const std::optional<VectorXd> surface = on_surface(event, x);
      if (!surface) return std::nullopt;
      x = 2.0 * *surface - x;
    }
    for (const int event : events)
      if (!(event_value(event, x) >= 0.0)) return std::nullopt;
    return x;
  }

  std::optional<VectorXd> on_surface(int event, VectorXd x) const {
    if (event == no_function) return x;
    return onto_surface(system_, event, no_function, std::move(x), par_.data());
  }

  const HybridSystem& system_;
  QuantityFunction function_;
  const VectorXd& par_;
  int n_;
};

}  // namespace

ConservationCheck check_conservation(const HybridSystem& system, const Quantity& conserved, const std::string& name,
                                     const std::vector<SegmentSettings>& segments, const std::vector<VectorXd>& states,
                                     const VectorXd& par) {
  const Conservation conservation(system, conserved, par);
  ConservationCheck check;
  const auto report = [&](const LargestChange& largest, const std::string& what, const char* measure) {
    if (largest.states == 0) {
      check.text += fmt::format("{}: {} could not be evaluated at any state\n", name, what);
    } else if (largest.relative <= rounding) {
      check.text += fmt::format("{}: conserved by {}, {} <= {:.1e} at {} states\n", name, what, measure,
                                largest.relative, largest.states);
    } else {
      check.is_conserved = false;
      check.text += fmt::format("{}: NOT conserved by {}: {} = {:.4g} at {}\n", name, what, measure, largest.change,
                                conservation.text(largest.state));
    }
  };
  std::map<int, std::set<int>> fields;  // with the event functions that are not negative on all their segments
  std::map<std::pair<int, int>, IndexVector> jumps;
  for (const SegmentSettings& segment : segments) {
    const IndexVector& index = segment.index;
    std::set<int> events(segment.monitor.begin(), segment.monitor.end());
    if (index.event != no_function) events.insert(index.event);
    const auto [known, is_new] = fields.insert({index.field, events});
    if (!is_new) std::erase_if(known->second, [&](int event) { return !events.contains(event); });
    if (index.jump != no_function) jumps.insert({{index.event, index.jump}, index});
  }
  for (const auto& [field, events] : fields)
    report(conservation.of_field(field, events, states),
           fmt::format("field {} ({})", field, system.function_name(FunctionKind::field, field)), "its rate of change");
  for (const auto& [numbers, index] : jumps)
    report(
        conservation.of_jump(index, states),
        fmt::format("jump {} ({}) at event {} ({})", index.jump, system.function_name(FunctionKind::jump, index.jump),
                    index.event, system.function_name(FunctionKind::event, index.event)),
        "its change");
  return check;
}

}  // namespace tchat
