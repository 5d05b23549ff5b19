#include "orbit/monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "orbit/collocation_rule.hpp"

namespace tchat {

namespace {

using Kind = MonitorName::Kind;

struct MonitorForm {
  const char* word;
  Kind kind;
  bool has_quantity;
  bool needs_number;
  const char* shown;
};

constexpr std::array<MonitorForm, 9> forms{{{"period", Kind::period, false, false, "period"},
                                            {"velocity", Kind::velocity, false, true, "velocity(S)"},
                                            {"start", Kind::start, true, false, "start(X, S)"},
                                            {"end", Kind::end, true, false, "end(X, S)"},
                                            {"max", Kind::maximum, true, false, "max(X)"},
                                            {"min", Kind::minimum, true, false, "min(X)"},
                                            {"mean", Kind::mean, true, false, "mean(X)"},
                                            {"integral", Kind::integral, true, false, "integral(X)"},
                                            {"multiplier", Kind::multiplier, false, true, "multiplier(K)"}}};

std::string trimmed(std::string text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.erase(text.begin());
  while (!text.empty() && blank(text.back())) text.pop_back();
  return text;
}

/// "max(x, 2)" in its parts: word, and what stands between the commas outside of inner parentheses.
struct Call {
  std::string word;
  std::vector<std::string> arguments;
  bool closed = true;
};

Call split(const std::string& text) {
  Call call;
  const std::size_t open = text.find('(');
  call.word = trimmed(text.substr(0, open));
  if (open == std::string::npos) return call;
  call.closed = text.back() == ')';
  const std::string inside = text.substr(open + 1, text.size() - open - (call.closed ? 2 : 1));
  std::string part;
  int depth = 0;
  for (const char c : inside) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (c == ',' && depth == 0) {
      call.arguments.push_back(trimmed(part));
      part.clear();
    } else {
      part += c;
    }
  }
  call.arguments.push_back(trimmed(part));
  return call;
}

std::string symbol_of(const Quantity& quantity) {
  const char* const symbols[] = {"U({})", "h{}", "PVLS({})"};
  return fmt::format(fmt::runtime(symbols[static_cast<int>(quantity.kind)]), quantity.index);
}

// ---- the monitors ---------------------------------------------------------------------------------------------------

class PeriodMonitor final : public Monitor {
 public:
  double value(const Orbit& x, const CollocationRule&) const override { return x.period(); }
  double gradient(const Orbit& x, const CollocationRule&, OrbitVector& row) const override {
    row.set_zero();
    row.durations.setOnes();
    return x.period();
  }
};

class DurationMonitor final : public Monitor {
 public:
  explicit DurationMonitor(int segment) : segment_(segment) {}
  double value(const Orbit& x, const CollocationRule&) const override { return x.duration(segment_); }
  double gradient(const Orbit& x, const CollocationRule&, OrbitVector& row) const override {
    row.set_zero();
    row.durations(segment_) = 1.0;
    return x.duration(segment_);
  }

 private:
  int segment_;
};

/// h_x f at the end of a segment; by x h_xx f + h_x f_x, by p h_xp f + h_x f_p.
class VelocityMonitor final : public Monitor {
 public:
  VelocityMonitor(const DefiningSystem& system, int segment)
      : system_(system),
        segment_(segment),
        index_(system.signature()[static_cast<std::size_t>(segment)]),
        f_(system.dimension()),
        hx_(system.dimension()),
        by_state_(system.dimension()),
        direction_(Eigen::VectorXd::Zero(system.dimension() + system.free_count())),
        by_parameter_(system.free_count()),
        fx_(system.dimension(), system.dimension()),
        fp_(system.dimension(), system.free_count()) {}

  double value(const Orbit& x, const CollocationRule&) const override {
    const double* par = x.par.data();
    const double* u = x.end(segment_);
    double h = 0.0;
    system_.system().value(FunctionKind::field, index_.field, u, par, f_.data());
    system_.system().first(FunctionKind::event, index_.event, u, par, {}, &h, hx_.data(), nullptr);
    return hx_.dot(f_);
  }

  double gradient(const Orbit& x, const CollocationRule& rule, OrbitVector& row) const override {
    const double result = value(x, rule);
    const std::vector<int>& free = system_.free_parameters();
    const double* par = x.par.data();
    const double* u = x.end(segment_);
    system_.system().first(FunctionKind::field, index_.field, u, par, free, f_.data(), fx_.data(), fp_.data());
    direction_.head(f_.size()) = f_;
    double rate = 0.0;
    system_.system().second(FunctionKind::event, index_.event, u, par, free, direction_.data(), &rate, by_state_.data(),
                            by_parameter_.data());
    by_state_.noalias() += fx_.transpose() * hx_;
    by_parameter_.noalias() += fp_.transpose() * hx_;
    row.set_zero();
    row.states.col(x.shape.last_node(segment_)) = by_state_;
    row.globals = by_parameter_;
    return result;
  }

 private:
  const DefiningSystem& system_;
  int segment_;
  IndexVector index_;
  mutable Eigen::VectorXd f_, hx_, by_state_, direction_, by_parameter_;
  mutable Eigen::MatrixXd fx_, fp_;
};

/// What monitors of a quantity share.
class QuantityMonitor : public Monitor {
 public:
  QuantityMonitor(const DefiningSystem& system, Quantity quantity)
      : function_(system.system(), quantity, system.free_parameters()),
        by_state_(system.dimension()),
        by_parameter_(system.free_count()),
        state_(system.dimension()) {}

 protected:
  /// Adds `factor` times the quantity's gradient at sigma of interval j of segment s, where `weights` are those of the
  /// nodes and state_ is the state. Returns the quantity.
  double add(const Orbit& x, int s, int j, const double* weights, double factor, OrbitVector& row) const {
    const double value = function_.first(state_.data(), x.par.data(), by_state_.data(), by_parameter_.data());
    const int column = x.shape.first_node(s) + j * x.shape.collocation;
    for (int i = 0; i <= x.shape.collocation; ++i)
      for (int a = 0; a < x.shape.dimension; ++a) row.states(a, column + i) += factor * weights[i] * by_state_(a);
    row.globals += factor * by_parameter_;
    return value;
  }

  QuantityFunction function_;
  mutable Eigen::VectorXd by_state_, by_parameter_, state_;
};

class EndMonitor final : public QuantityMonitor {
 public:
  EndMonitor(const DefiningSystem& system, Quantity quantity, int segment, bool at_end)
      : QuantityMonitor(system, quantity), segment_(segment), at_end_(at_end) {}

  double value(const Orbit& x, const CollocationRule&) const override {
    return function_.value(place(x), x.par.data());
  }
  double gradient(const Orbit& x, const CollocationRule&, OrbitVector& row) const override {
    row.set_zero();
    const double result = function_.first(place(x), x.par.data(), by_state_.data(), by_parameter_.data());
    row.states.col(at_end_ ? x.shape.last_node(segment_) : x.shape.first_node(segment_)) = by_state_;
    row.globals = by_parameter_;
    return result;
  }

 private:
  const double* place(const Orbit& x) const { return at_end_ ? x.end(segment_) : x.start(segment_); }

  int segment_;
  bool at_end_;
};

/// sum T_s integral X dtau over the segments, divided by sum T_s for the mean.
class IntegralMonitor final : public QuantityMonitor {
 public:
  IntegralMonitor(const DefiningSystem& system, Quantity quantity, int segment, bool mean)
      : QuantityMonitor(system, quantity),
        first_(segment < 0 ? 0 : segment),
        last_(segment < 0 ? system.segments() - 1 : segment),
        mean_(mean) {}

  double value(const Orbit& x, const CollocationRule& rule) const override {
    double total = 0.0;
    for (int s = first_; s <= last_; ++s) total += x.duration(s) * of_segment(x, rule, s);
    if (mean_ && total == 0.0 && x.period() == 0.0) return of_segment(x, rule, first_);  // an equilibrium
    return mean_ ? total / time(x) : total;
  }

  /// By u_i: T w l_i X_x / t, by T_s: (integral_s - mean) / t, by p: T w X_p / t, with t = sum T_s or 1.
  double gradient(const Orbit& x, const CollocationRule& rule, OrbitVector& row) const override {
    const double divisor = mean_ ? time(x) : 1.0;
    weights_.resize(static_cast<std::size_t>(rule.points() + 1));
    row.set_zero();
    double result = 0.0;
    for (int s = first_; s <= last_; ++s) {
      const double scale = x.duration(s) / divisor;
      for_each_gauss_point(x, rule, s, [&](int j, int g, double, double weight) {
        interpolate(x, rule, s, j, g, state_.data());
        for (int i = 0; i <= rule.points(); ++i) weights_[static_cast<std::size_t>(i)] = rule.value(g, i);
        row.durations(s) += weight / divisor * add(x, s, j, weights_.data(), scale * weight, row);
      });
      result += x.duration(s) * row.durations(s);
    }
    if (mean_) row.durations.segment(first_, last_ - first_ + 1).array() -= result / divisor;
    return result;
  }

 private:
  double of_segment(const Orbit& x, const CollocationRule& rule, int s) const {
    double sum = 0.0;
    for_each_gauss_point(x, rule, s, [&](int j, int g, double, double weight) {
      interpolate(x, rule, s, j, g, state_.data());
      sum += weight * function_.value(state_.data(), x.par.data());
    });
    return sum;
  }
  double time(const Orbit& x) const {
    double sum = 0.0;
    for (int s = first_; s <= last_; ++s) sum += x.duration(s);
    return sum != 0.0 ? sum : 1.0;
  }

  int first_, last_;
  bool mean_;
  mutable std::vector<double> weights_;
};

/// The gradient of an extremum is that of X at its place, for X' vanishes there or the place is an end.
class ExtremumMonitor final : public QuantityMonitor {
 public:
  ExtremumMonitor(const DefiningSystem& system, Quantity quantity, int segment, double sign)
      : QuantityMonitor(system, quantity),
        first_(segment < 0 ? 0 : segment),
        last_(segment < 0 ? system.segments() - 1 : segment),
        sign_(sign),
        slope_(system.dimension()) {}

  double value(const Orbit& x, const CollocationRule& rule) const override { return find(x, rule).value; }

  double gradient(const Orbit& x, const CollocationRule& rule, OrbitVector& row) const override {
    const Place place = find(x, rule);
    put_state(x, rule, place.segment, place.interval, place.sigma);
    row.set_zero();
    add(x, place.segment, place.interval, weights_.data(), 1.0, row);
    return place.value;
  }

 private:
  struct Place {
    int segment = 0;
    int interval = 0;
    double sigma = 0.0;
    double value = 0.0;
  };

  void put_state(const Orbit& x, const CollocationRule& rule, int s, int j, double sigma) const {
    const auto count = static_cast<std::size_t>(rule.points() + 1);
    weights_.resize(count);
    slopes_.resize(count);
    rule.basis(sigma, weights_.data(), slopes_.data());
    state_.setZero();
    slope_.setZero();
    const double* node = x.node(s, j * x.shape.collocation);
    for (std::size_t i = 0; i < count; ++i)
      for (Eigen::Index a = 0; a < state_.size(); ++a, ++node) {
        state_(a) += weights_[i] * *node;
        slope_(a) += slopes_[i] * *node;
      }
  }

  /// d X / d sigma, with the sign of a maximum.
  double rate(const Orbit& x, const CollocationRule& rule, int s, int j, double sigma) const {
    put_state(x, rule, s, j, sigma);
    function_.first(state_.data(), x.par.data(), by_state_.data(), by_parameter_.data());
    return sign_ * by_state_.dot(slope_);
  }

  Place find(const Orbit& x, const CollocationRule& rule) const {
    int segment = first_;
    int node = 0;
    double best = -std::numeric_limits<double>::infinity();
    for (int s = first_; s <= last_; ++s)
      for (int k = 0; k < x.shape.nodes_of(s); ++k)
        if (const double value = sign_ * function_.value(x.node(s, k), x.par.data()); value > best)
          best = value, segment = s, node = k;
    const int c = x.shape.collocation;
    Place place{segment, std::min(node / c, x.shape.intervals_of(segment) - 1), 0.0, sign_ * best};
    place.sigma = static_cast<double>(node - place.interval * c) / c;
    if (node > 0) refine(x, rule, node - 1, place);
    if (node + 1 < x.shape.nodes_of(segment)) refine(x, rule, node, place);
    return place;
  }

  /// Between nodes k and k + 1 of the place's segment.
  void refine(const Orbit& x, const CollocationRule& rule, int k, Place& place) const {
    const int c = x.shape.collocation;
    const int j = k / c;
    const double left = static_cast<double>(k - j * c) / c;
    const double right = left + 1.0 / c;
    const auto slope = [&](double sigma) { return rate(x, rule, place.segment, j, sigma); };
    const double at_left = slope(left);
    const double at_right = slope(right);
    if (!(at_left > 0.0 && at_right < 0.0)) return;
    std::uintmax_t iterations = 60;
    const auto bracket = boost::math::tools::toms748_solve(slope, left, right, at_left, at_right,
                                                           boost::math::tools::eps_tolerance<double>(48), iterations);
    const double sigma = 0.5 * (bracket.first + bracket.second);
    put_state(x, rule, place.segment, j, sigma);
    const double value = function_.value(state_.data(), x.par.data());
    if (sign_ * value >= sign_ * place.value) place = {place.segment, j, sigma, value};
  }

  int first_, last_;
  double sign_;
  mutable Eigen::VectorXd slope_;
  mutable std::vector<double> weights_, slopes_;
};

}  // namespace

std::string monitor_list() {
  std::string list;
  for (const MonitorForm& form : forms) list += fmt::format("{}{}", list.empty() ? "" : ", ", form.shown);
  return list;
}

MonitorName parse_monitor(const HybridSystem& system, const std::string& text, const std::string& where) {
  const Call call = split(text);
  const auto form = std::find_if(forms.begin(), forms.end(), [&](const MonitorForm& f) { return call.word == f.word; });
  const auto refuse = [&](const std::string& why) {
    throw UserError(fmt::format("{}: {} is no monitor: {}", where, in_quotes(text), why));
  };
  const std::optional<Quantity> bare = call.arguments.empty() ? find_quantity(system, call.word) : std::nullopt;
  if (form == forms.end() && bare && bare->kind == Quantity::Kind::user_function) return {Kind::start, *bare, 0};
  if (form == forms.end())
    refuse(fmt::format("there are {}, with X a state, an event function or a user function: {}", monitor_list(),
                       quantity_list(system)));
  if (!call.closed) refuse("a closing parenthesis is missing");
  MonitorName name;
  name.kind = form->kind;
  std::size_t next = 0;
  if (form->has_quantity) {
    const std::string wanted = call.arguments.empty() ? "" : call.arguments.front();
    const std::optional<Quantity> quantity = find_quantity(system, wanted);
    if (!quantity)
      refuse(fmt::format("{} is no state, event function or user function of {}; it has {}", in_quotes(wanted),
                         system.name(), quantity_list(system)));
    if (wanted.find_first_of(" \t") != std::string::npos)
      refuse(fmt::format("a name with blanks cannot stand here; write {} for it", symbol_of(*quantity)));
    name.quantity = *quantity;
    ++next;
  }
  const bool has_number = call.arguments.size() > next;
  if (form->needs_number && !has_number) refuse(fmt::format("it is written {}, with a number", form->shown));
  if (call.arguments.size() > next + 1 || (form->kind == Kind::period && has_number))
    refuse(fmt::format("it has too many arguments; it is written {}", form->shown));
  if (has_number) {
    const std::optional<int> number = parse_integer(call.arguments[next]);
    if (!number || *number < 1)
      refuse(fmt::format("{} is no {}, which count from 1", in_quotes(call.arguments[next]),
                         form->kind == Kind::multiplier ? "multiplier" : "segment"));
    name.number = *number;
  }
  return name;
}

std::unique_ptr<Monitor> make_monitor(const MonitorName& name, const DefiningSystem& system) {
  const int segment = name.number - 1;
  switch (name.kind) {
    case Kind::period:
      return std::make_unique<PeriodMonitor>();
    case Kind::velocity:
      return std::make_unique<VelocityMonitor>(system, segment);
    case Kind::start:
      return std::make_unique<EndMonitor>(system, name.quantity, std::max(segment, 0), false);
    case Kind::end:
      return std::make_unique<EndMonitor>(system, name.quantity, segment < 0 ? system.segments() - 1 : segment, true);
    case Kind::maximum:
      return std::make_unique<ExtremumMonitor>(system, name.quantity, segment, 1.0);
    case Kind::minimum:
      return std::make_unique<ExtremumMonitor>(system, name.quantity, segment, -1.0);
    case Kind::mean:
      return std::make_unique<IntegralMonitor>(system, name.quantity, segment, true);
    case Kind::integral:
      return std::make_unique<IntegralMonitor>(system, name.quantity, segment, false);
    default:
      return nullptr;
  }
}

std::unique_ptr<Monitor> make_duration_monitor(int segment) { return std::make_unique<DurationMonitor>(segment); }

}  // namespace tchat
