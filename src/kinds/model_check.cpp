#include "kinds/model_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"

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

ModelCheck check_conservation(const HybridSystem& system, const Quantity& conserved, const std::string& name,
                              const std::vector<SegmentSettings>& segments, const std::vector<VectorXd>& states,
                              const VectorXd& par) {
  const Conservation conservation(system, conserved, par);
  ModelCheck check;
  const auto report = [&](const LargestChange& largest, const std::string& what, const char* measure) {
    if (largest.states == 0) {
      check.text += fmt::format("{}: {} could not be evaluated at any state\n", name, what);
    } else if (largest.relative <= rounding) {
      check.text += fmt::format("{}: conserved by {}, {} <= {:.1e} at {} states\n", name, what, measure,
                                largest.relative, largest.states);
    } else {
      check.is_fine = false;
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

namespace {

/// The impacts of one chatter mode at states next to given ones.
class ImpactsInContact {
 public:
  ImpactsInContact(const HybridSystem& system, const tchat_chatter& mode, const VectorXd& par)
      : system_(system), mode_(mode), par_(par) {}

  void look_at(const VectorXd& near) {
    const VectorXd sizes = sizes_at(system_, mode_.field, near, par_).unaryExpr(&size_for_tolerance);
    if (const auto x = onto_surface(system_, mode_.event, mode_.field, near, par_.data(), sizes)) {
      const EventAt after = event_at(system_, mode_.event, jump(*x).data(), par_.data());
      leaves_surface_.add(after.h, after.scale(jump(*x).data(), sizes), *x);
    }
    const std::optional<VectorXd> x = in_contact(near, sizes);
    if (!x) return;
    Eigen::Index worst = 0;
    const VectorXd change = jump(*x) - *x;
    change.cwiseQuotient(sizes).cwiseAbs().maxCoeff(&worst);
    const double before = moves_.relative;
    moves_.add(change(worst), sizes(worst), *x);
    if (moves_.relative != before || moves_.states == 1) state_ = static_cast<int>(worst) + 1;
    add_restitution(*x, sizes);
  }

  void report(ModelCheck& check) const {
    const auto name = [&](FunctionKind kind, int index) { return system_.function_name(kind, index); };
    const std::string what =
        fmt::format("chatter of jump {} ({}) at event {} ({})", mode_.impact, name(FunctionKind::jump, mode_.impact),
                    mode_.event, name(FunctionKind::event, mode_.event));
    const auto fault = [&](const std::string& text) {
      check.is_fine = false;
      check.text += fmt::format("fault: {}: {}: impacts cannot accumulate\n", what, text);
    };
    if (leaves_surface_.relative > small)
      return fault(fmt::format("states on the surface are moved off it, to h = {:.3g}", leaves_surface_.change));
    if (moves_.relative > small)
      return fault(
          fmt::format("states with h = h' = 0 are moved by {:.2g} (state {}); does the jump use the velocity "
                      "with which the event function moves?",
                      moves_.change, system_.state_name(state_)));
    if (moves_.states == 0) {
      check.text += fmt::format("  {}: no states with h = h' = 0 were found\n", what);
      return;
    }
    const std::string range = largest_ - least_ <= small * largest_ ? fmt::format("{:.6g}", least_)
                                                                    : fmt::format("{:.6g} to {:.6g}", least_, largest_);
    const bool accumulates = least_ > 0.0 && largest_ < 1.0;
    check.text += fmt::format("  {}: restitution {} at {} states in contact{}\n", what, range, moves_.states,
                              accumulates ? "" : "; impacts accumulate only where it is between 0 and 1");
  }

 private:
  static constexpr double small = level::tolerance;

  VectorXd jump(const VectorXd& x) const {
    VectorXd after(x.size());
    system_.value(FunctionKind::jump, mode_.impact, x.data(), par_.data(), after.data());
    return after;
  }

  /// Rows h_x and v_x, in sizes of states, and h and v.
  struct Contact {
    Eigen::MatrixXd rows;
    Eigen::Vector2d rest;
  };
  Contact contact_at(const VectorXd& x, const VectorXd& sizes) const {
    const EventAt at = event_at(system_, mode_.event, mode_.field, x.data(), par_.data());
    Contact contact{Eigen::MatrixXd(2, x.size()), {at.h, at.rate()}};
    contact.rows.row(0) = at.gradient.cwiseProduct(sizes).transpose();
    contact.rows.row(1) =
        rate_gradient(system_, at, mode_.event, mode_.field, x.data(), par_.data()).cwiseProduct(sizes).transpose();
    return contact;
  }

  /// With h = v = 0, by Newton's method with the shortest steps.
  std::optional<VectorXd> in_contact(VectorXd x, const VectorXd& sizes) const {
    constexpr int most_steps = 30;
    for (int k = 0; k < most_steps; ++k) {
      const Contact contact = contact_at(x, sizes);
      if (!contact.rows.allFinite() || !contact.rest.allFinite()) return std::nullopt;
      const VectorXd step = least_squares(contact.rows, contact.rest);
      x -= sizes.cwiseProduct(step);
      if (step.lpNorm<Eigen::Infinity>() <= level::rounding_of_sums) return x;
    }
    return std::nullopt;
  }

  /// -v_x g_x d with h_x d = 0 and v_x d = 1.
  void add_restitution(const VectorXd& x, const VectorXd& sizes) {
    const Contact contact = contact_at(x, sizes);
    const VectorXd d = sizes.cwiseProduct(VectorXd(least_squares(contact.rows, Eigen::Vector2d(0.0, 1.0))));
    const VectorXd after = jump_at(system_, mode_.impact, x.data(), par_.data()).derivative * d;
    const double r = -contact.rows.row(1).dot(after.cwiseQuotient(sizes));
    if (!std::isfinite(r)) return;
    least_ = std::min(least_, r + 0.0);  // no -0
    largest_ = std::max(largest_, r + 0.0);
  }

  const HybridSystem& system_;
  const tchat_chatter& mode_;
  const VectorXd& par_;
  LargestChange leaves_surface_, moves_;
  int state_ = 1;  // that is moved most
  double least_ = INFINITY, largest_ = -INFINITY;
};

}  // namespace

ModelCheck check_chatter(const HybridSystem& system, const DerivativeCheckOptions& options) {
  ModelCheck check;
  const VectorXd par = checked_parameters(system, options);
  for (int k = 0; k < system.table().chatter_modes; ++k) {
    ImpactsInContact impacts(system, system.table().chatter[k], par);
    for (const VectorXd& x : checked_states(system, options)) impacts.look_at(x);
    impacts.report(check);
  }
  return check;
}

}  // namespace tchat
