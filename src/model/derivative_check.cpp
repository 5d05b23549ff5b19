#include "model/derivative_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "model/checked_function.hpp"
#include "model/function_values.hpp"
#include "model/parameter_vector.hpp"
#include "model/scaled_problem.hpp"
#include "model/scales.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double boundary_tolerance = level::located;  // of the derivatives' scale; differences are good to about 1e-9
constexpr std::size_t most_listed = 5;

}  // namespace

BoundaryCheck check_boundary(const HybridSystem& system, int segments, const VectorXd& par, unsigned seed) {
  const int n = system.dimension();
  const int rows = system.boundary_conditions();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto any = [&] { return uniform(random); };
  const MatrixXd starts = MatrixXd::NullaryExpr(n, segments, any);
  const MatrixXd ends = MatrixXd::NullaryExpr(n, segments, any);
  VectorXd values = par;
  const ParameterLayout layout = system.layout();
  for (int s = 0; s < segments; ++s) values(layout.duration(s) - 1) = 1.5 + any();
  std::vector<int> active(static_cast<std::size_t>(system.parameters()));
  std::iota(active.begin(), active.end(), 1);
  for (int s = 0; s < segments; ++s) active.push_back(layout.duration(s));

  // Columns: starts, ends, parameters and durations.
  const int states = n * segments;
  MatrixXd supplied(rows, 2 * states + static_cast<int>(active.size()));
  MatrixXd expected = supplied;
  VectorXd b(rows);
  const OrbitEnds at{segments, starts.data(), ends.data(), values.data()};
  const auto column = [rows](MatrixXd& m, int c) { return m.data() + c * rows; };
  system.boundary_first(at, active, b.data(), column(supplied, 0), column(supplied, states),
                        column(supplied, 2 * states));
  difference_boundary(system, at, active, b.data(), column(expected, 0), column(expected, states),
                      column(expected, 2 * states));

  const auto variable = [&](int c) {
    if (c < 2 * states) {
      const int place = c % states;
      return fmt::format("{} at the {} of segment {}", system.state_name(place % n + 1), c < states ? "start" : "end",
                         place / n + 1);
    }
    const int k = active[static_cast<std::size_t>(c - 2 * states)];
    return layout.is_duration(k, segments) ? fmt::format("T of segment {}", layout.duration_segment(k) + 1)
                                           : system.parameter_name(k);
  };
  BoundaryCheck check{segments, rows, 0.0, {}};
  const double scale = 1.0 + (expected.allFinite() ? expected.cwiseAbs().maxCoeff() : 0.0);
  for (int r = 0; r < rows; ++r) {
    if (!std::isfinite(b(r)))
      check.faults.push_back(
          fmt::format("boundary condition {} is {} on {} segment{}: is it left unset, or does it ask "
                      "for another segment (their number is GCNOSEG)?",
                      r + 1, b(r), segments, segments == 1 ? "" : "s"));
    for (int c = 0; std::isfinite(b(r)) && c < supplied.cols(); ++c) {
      const double error = std::abs(supplied(r, c) - expected(r, c)) / scale;
      if (!(error <= check.error)) check.error = error;
      if (!(error <= boundary_tolerance) && check.faults.size() < most_listed)
        check.faults.push_back(fmt::format("d b_{} / d {} is {:.10g}, differences give {:.10g}", r + 1, variable(c),
                                           supplied(r, c), expected(r, c)));
    }
  }
  return check;
}

std::string to_text(const BoundaryCheck& check) {
  return fmt::format("  boundary conditions 1 to {:<12}  first {:.1e}  {}\n", check.conditions, check.error,
                     check.faults.empty() ? "ok" : "FAULT");
}

namespace {

constexpr double consistency_factor = level::negligible;  // between two exact evaluations
constexpr int guard = 16;                                 // entries of room behind arguments and outputs
constexpr double untouched = -7.25e77;                    // what the room behind the outputs holds
constexpr int most_faults = 10;                           // wrong entries of one function that are listed
constexpr int most_parameters_of_second = 60;  // of more a random choice: every one costs as many evaluations again
constexpr int many_variables = 16;             // from here on random directions instead of every variable
constexpr int some_directions = 4;

/// Where roots and angles are likely to have zero arguments, and asin and acos arguments of modulus 1: the problem's
/// start and zero, and those with one state 0, 1 or -1.
std::vector<VectorXd> special_states(const HybridSystem& system) {
  std::vector<VectorXd> states;
  if (const double* const initial = system.table().initial_state)
    states.emplace_back(Eigen::Map<const VectorXd>(initial, system.dimension()));
  states.emplace_back(VectorXd::Zero(system.dimension()));
  const std::vector<VectorXd> bases = states;
  for (const VectorXd& base : bases)
    for (int k = 0; k < system.dimension(); ++k)
      for (const double value : {0.0, 1.0, -1.0}) {
        states.push_back(base);
        states.back()(k) = value;
      }
  return states;
}

/// Keeps the messages of one function: the worst entry, and the first fault of each sort.
class FunctionChecker {
 public:
  FunctionChecker(const HybridSystem& system, FunctionKind kind, int index, const std::vector<TestPoint>& points,
                  unsigned seed)
      : system_(system),
        function_(system, kind, index),
        points_(points),
        random_(seed),
        of_second_(system, kind, index, some_parameters(system, seed)) {
    check_.kind = kind;
    check_.index = index;
  }

  FunctionCheck run() {
    check_bounds();  // first: a function that writes too much would spoil memory in what follows
    if (check_.faults.empty()) check_values();
    if (!check_.faults.empty()) return check_;
    if (system_.table().derivative_order >= 1) note_singular_state();
    if (system_.table().derivative_order >= 1)
      for (const TestPoint& at : evaluable_) check_first(at);
    if (system_.table().derivative_order >= 2)
      for (const TestPoint& at : evaluable_) check_second(at);
    add_first_faults();
    if (second_.at_fault()) check_.faults.push_back(text(second_, check_.worst_second, second_at_));
    return check_;
  }

 private:
  static std::vector<int> some_parameters(const HybridSystem& system, unsigned seed) {
    std::vector<int> all(static_cast<std::size_t>(system.parameters())), some;
    std::iota(all.begin(), all.end(), 1);
    std::mt19937 random(seed);
    std::sample(all.begin(), all.end(), std::back_inserter(some), most_parameters_of_second, random);
    return some;
  }

  void check_values() {
    const int rows = function_.rows();
    std::vector<int> failures(static_cast<std::size_t>(rows), 0);
    for (const TestPoint& at : points_) {
      const VectorXd f = function_.value(at);
      for (int r = 0; r < rows; ++r) failures[static_cast<std::size_t>(r)] += std::isfinite(f(r)) ? 0 : 1;
      if (f.allFinite()) evaluable_.push_back(at);
      if (!f.allFinite() && !at.is_random && !is_made_by_chatter()) fault_at_given_state(f, at);
      if (f.allFinite() && function_.value(at) != f)
        add_fault("changes",
                  fmt::format("{} changes from call to call at the same point: it must depend on x and par only",
                              function_.row_name(0)));
    }
    const int all = static_cast<int>(points_.size());
    if (evaluable_.empty() && is_made_by_chatter())
      return check_.notes.push_back(fmt::format(
          "no value at {} of {} states: neither do impacts accumulate there nor does contact end", all, all));
    for (int r = 0; r < rows; ++r) {
      if (failures[static_cast<std::size_t>(r)] == all)
        add_fault(fmt::format("NaN {}", function_.row_name(r)),
                  fmt::format("{} is NaN or infinite at every state tried: is it left unset?", function_.row_name(r)));
    }
    if (evaluable_.size() < points_.size() && !evaluable_.empty())
      check_.notes.push_back(fmt::format("not evaluable at {} of {} states", points_.size() - evaluable_.size(), all));
  }

  void fault_at_given_state(const VectorXd& f, const TestPoint& at) {
    for (int r = 0; r < function_.rows(); ++r)
      if (!std::isfinite(f(r)))
        add_fault(fmt::format("NaN {}", function_.row_name(r)),
                  fmt::format("{} is {} at {}", function_.row_name(r), f(r), point_text(system_, at)));
  }

  /// Writing behind the outputs, reading behind the states and parameters.
  void check_bounds() {
    const std::string name = system_.function_name(check_.kind, check_.index);
    for (const TestPoint& at : points_) {
      const VectorXd plain = guarded_value(at, 0.0);
      const VectorXd spoilt = guarded_value(at, NAN);
      if (has_finite_values(plain) && !has_finite_values(spoilt))
        add_fault("reads",
                  fmt::format("{} reads beyond its {} states or {} parameters: are `dimension` and `parameters` right?",
                              name, system_.dimension(), system_.parameters()));
      if ((plain.tail(plain.size() - function_.rows()).array() != untouched).any())
        add_fault("writes",
                  fmt::format("{} writes more than {} outputs: is `dimension` right?", name, function_.rows()));
    }
  }

  bool has_finite_values(const VectorXd& out) const { return out.head(function_.rows()).allFinite(); }

  /// The function evaluated with room behind its arguments, filled with `padding`, and behind its outputs, `untouched`.
  VectorXd guarded_value(const TestPoint& at, double padding) const {
    const int n = system_.dimension();
    const int q = system_.parameters();
    VectorXd x = VectorXd::Constant(n + guard, padding);
    x.head(n) = at.x;
    VectorXd par = VectorXd::Constant(system_.layout().room(), padding);
    par.head(q) = at.par.head(q);
    VectorXd out = VectorXd::Constant(function_.rows() + n + guard, untouched);
    system_.value(check_.kind, check_.index, x.data(), par.data(), out.data());
    return out;
  }

  /// Random states miss the zeros of roots: the first special state with a value and no finite derivatives is noted.
  void note_singular_state() {
    const bool is_of_states = check_.kind != FunctionKind::integrand;
    for (const VectorXd& x : is_of_states ? special_states(system_) : std::vector<VectorXd>{}) {
      const TestPoint at{x, points_.front().par, true};
      if (has_finite_derivatives(system_, check_.kind, check_.index, at.x.data(), at.par.data())) continue;
      check_.notes.push_back(no_finite_derivatives(system_, check_.kind, check_.index, at.x));
      return;
    }
  }

  void check_first(const TestPoint& at) {
    VectorXd value;
    const MatrixXd derivative = function_.first(at, value);
    if (!derivative.allFinite() && function_.value(at).allFinite())
      return add_fault("derivatives", no_finite_derivatives(system_, check_.kind, check_.index, at.x));
    const VectorXd expected = function_.value(at);
    if (!((value - expected).norm() <= consistency_factor * (1.0 + expected.norm())))
      add_fault("value", fmt::format("the value of {} with derivatives differs from its value alone at {}",
                                     system_.function_name(check_.kind, check_.index), point_text(system_, at)));
    const auto first = [this](const TestPoint& near) {
      VectorXd with;
      return function_.first(near, with);
    };
    const auto compared =
        compare_with_differences(function_, at, first, [this](const TestPoint& near) { return function_.value(near); });
    for (const ComparedEntry& entry : compared.faults) {
      FirstFault& fault = first_faults_[{entry.row, entry.column}];
      if (entry.excess > fault.entry.excess) fault = {entry, point_text(system_, at)};
    }
    if (compared.worst.excess <= first_excess_) return;
    first_excess_ = compared.worst.excess;
    check_.first_error = compared.worst.relative;
    check_.worst_first = first_name(compared.worst);
  }

  std::string first_name(const ComparedEntry& entry) const {
    return fmt::format("d {} / d {}", function_.row_name(entry.row), function_.variable_name(entry.column));
  }

  /// Every wrong entry, each where it is worst, row by row; a long list is cut.
  void add_first_faults() {
    int shown = 0;
    for (const auto& [place, fault] : first_faults_) {
      if (++shown > most_faults) break;
      check_.faults.push_back(text(fault.entry, first_name(fault.entry), fault.at));
    }
    const int all = static_cast<int>(first_faults_.size());
    if (all > most_faults)
      check_.faults.push_back(fmt::format("{} more first derivatives of {} are wrong", all - most_faults,
                                          system_.function_name(check_.kind, check_.index)));
  }

  void check_second(const TestPoint& at) {
    if (!has_finite_derivatives(system_, check_.kind, check_.index, at.x.data(), at.par.data())) return;
    const int variables = of_second_.variables();
    const bool every_variable = takes_every_variable();
    for (int k = 0; k < (every_variable ? variables : some_directions); ++k)
      check_along(at, every_variable ? VectorXd(VectorXd::Unit(variables, k)) : random_direction(),
                  every_variable ? of_second_.variable_name(k) : "a random direction");
  }

  /// Then it has values only where impacts accumulate, and takes long to evaluate.
  bool is_made_by_chatter() const { return system_.is_made_by_chatter(check_.kind, check_.index); }

  bool takes_every_variable() const { return of_second_.variables() <= many_variables && !is_made_by_chatter(); }

  void check_along(const TestPoint& at, const VectorXd& direction, const std::string& name) {
    VectorXd along;
    of_second_.second(at, direction, along);
    check_agreement(at, direction, along, name);
    const auto second = [this, &direction](const TestPoint& near) {
      VectorXd with;
      return of_second_.second(near, direction, with);
    };
    const auto value = [this, &direction](const TestPoint& near) {
      VectorXd d;
      of_second_.second(near, direction, d);
      return d;
    };
    const auto compared = takes_every_variable()
                              ? compare_with_differences(of_second_, at, second, value)
                              : compare_along_directions(of_second_, at, random_directions(), second, value);
    const ComparedEntry& worst = compared.worst;
    if (worst.excess <= second_.excess) return;
    second_ = worst;
    second_at_ = point_text(system_, at);
    check_.second_error = worst.relative;
    check_.worst_second =
        fmt::format("d2 {} / d {} d {}", of_second_.row_name(worst.row), name, of_second_.variable_name(worst.column));
  }

  /// The directional derivative that comes with second derivatives is exact too; a difference is a first derivative's
  /// fault, reported already when the differences saw it.
  void check_agreement(const TestPoint& at, const VectorXd& direction, const VectorXd& along, const std::string& name) {
    VectorXd value;
    const MatrixXd first = of_second_.first(at, value);
    const VectorXd expected = first * direction;
    const double scale = 1.0 + first.lpNorm<Eigen::Infinity>() + value.lpNorm<Eigen::Infinity>();
    for (int r = 0; r < function_.rows(); ++r) {
      const bool agrees = std::abs(along(r) - expected(r)) <= consistency_factor * scale;
      if (agrees || !first_faults_.empty()) continue;
      add_fault(fmt::format("agreement {}", function_.row_name(r)),
                fmt::format("d {} / d {} is {:.13g} from the first derivatives but {:.13g} from the second ones at {}",
                            function_.row_name(r), name, expected(r), along(r), point_text(system_, at)));
    }
  }

  VectorXd random_direction() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    return VectorXd::NullaryExpr(of_second_.variables(), [&] { return uniform(random_); });
  }

  std::vector<VectorXd> random_directions() {
    std::vector<VectorXd> directions(some_directions);
    for (VectorXd& direction : directions) direction = random_direction();
    return directions;
  }

  static std::string text(const ComparedEntry& worst, const std::string& entry, const std::string& at) {
    return fmt::format("{} is {:.10g}, differences give {:.10g}, at {}", entry, worst.supplied, worst.difference, at);
  }

  /// One message of a sort is enough: the same fault shows at every state.
  void add_fault(const std::string& sort, const std::string& message) {
    if (sorts_.insert(sort).second) check_.faults.push_back(message);
  }

  const HybridSystem& system_;
  CheckedFunction function_;
  const std::vector<TestPoint>& points_;
  std::mt19937 random_;
  CheckedFunction of_second_;  // by states and at most 60 parameters
  FunctionCheck check_;
  std::vector<TestPoint> evaluable_;
  struct FirstFault {
    ComparedEntry entry;
    std::string at;
  };
  std::map<std::pair<int, int>, FirstFault> first_faults_;  // by row and column
  double first_excess_ = 0.0;
  ComparedEntry second_;
  std::string second_at_;
  std::set<std::string> sorts_;  // of the faults found
};

}  // namespace

VectorXd checked_parameters(const HybridSystem& system, const DerivativeCheckOptions& options) {
  const VectorXd& given = options.parameters;
  const int room = system.layout().room(options.segments);
  if (given.size() > room || !given.allFinite())
    throw UserError(
        fmt::format("{} parameter values were given, allowed are at most {} finite ones.", given.size(), room));
  VectorXd par = VectorXd::Zero(room);
  const double* const initial = system.table().initial_parameters;
  for (int k = 0; k < system.parameters(); ++k) par(k) = initial != nullptr ? initial[k] : 1.0;
  par.head(given.size()) = given;
  return par;
}

namespace {

/// Powers of two next to the sizes of the states at the first one that is given, or where the problem starts.
VectorXd checked_units(const HybridSystem& system, const DerivativeCheckOptions& options) {
  const int n = system.dimension();
  const double* const initial = system.table().initial_state;
  if (options.states.empty() && initial == nullptr) return VectorXd::Ones(n);
  const VectorXd x = options.states.empty() ? VectorXd(Eigen::Map<const VectorXd>(initial, n)) : options.states.front();
  if (x.size() != n || system.count(FunctionKind::field) == 0) return VectorXd::Ones(n);
  return units_of(sizes_at(system, 1, x, checked_parameters(system, options)));
}

std::vector<TestPoint> test_points(const HybridSystem& system, const DerivativeCheckOptions& options) {
  const VectorXd par = checked_parameters(system, options);
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const VectorXd units = checked_units(system, options);
  std::vector<VectorXd> bases = options.states;
  if (bases.empty()) bases.push_back(VectorXd::Zero(system.dimension()));

  const int random_states = std::max(options.random_states, options.states.empty() ? 1 : 0);
  std::vector<TestPoint> points;
  for (const VectorXd& base : bases) {
    if (base.size() != system.dimension() || !base.allFinite())
      throw UserError(fmt::format("a state with {} entries was given; {} needs {} finite numbers.", base.size(),
                                  system.name(), system.dimension()));
    if (!options.states.empty()) points.push_back({base, par, false});
    for (int k = 0; k < random_states; ++k) {
      TestPoint point{base, par, true};
      for (Eigen::Index i = 0; i < base.size(); ++i)
        point.x(i) += options.spread * (units(i) + std::abs(base(i))) * uniform(random);
      for (double& p : point.par.head(system.parameters()))
        p += 0.1 * options.spread * checked_range(p) * uniform(random);
      points.push_back(point);
    }
  }
  return points;
}

std::vector<std::string> check_names(const HybridSystem& system) {
  std::vector<std::string> faults;
  std::set<std::string> names;
  for (int k = 1; k <= system.parameters(); ++k)
    if (!names.insert(system.parameter_name(k)).second)
      faults.push_back(fmt::format("the parameter name '{}' is used twice", system.parameter_name(k)));
  names.clear();
  for (int k = 1; k <= system.dimension(); ++k)
    if (!names.insert(system.state_name(k)).second)
      faults.push_back(fmt::format("the state name '{}' is used twice", system.state_name(k)));
  const double* const initial = system.table().initial_parameters;
  for (int k = 1; initial != nullptr && k <= system.parameters(); ++k)
    if (!std::isfinite(initial[k - 1]))
      faults.push_back(fmt::format("the starting value of {} is not finite", system.parameter_name(k)));
  return faults;
}

std::string function_line(const HybridSystem& system, const FunctionCheck& check, int order) {
  static constexpr const char* kinds[] = {"field", "event", "jump", "integrand"};
  const std::string name = system.function_name(check.kind, check.index);
  std::string line = fmt::format("  {:<5} {:<2} {:<20}", kinds[static_cast<int>(check.kind)], check.index, name);
  const bool was_compared = check.faults.empty() || !check.worst_first.empty();
  if (order >= 1 && was_compared) line += fmt::format("  first {:.1e}", check.first_error);
  if (order >= 2 && was_compared) line += fmt::format("  second {:.1e}", check.second_error);
  line += check.faults.empty() ? "  ok" : "  FAULT";
  for (const std::string& note : check.notes) line += fmt::format("  ({})", note);
  return line + "\n";
}

}  // namespace

bool DerivativeCheck::fine() const {
  const auto is_fine = [](const FunctionCheck& check) { return check.faults.empty(); };
  return faults.empty() && (!boundary || boundary->faults.empty()) &&
         std::all_of(functions.begin(), functions.end(), is_fine);
}

std::vector<VectorXd> checked_states(const HybridSystem& system, const DerivativeCheckOptions& options) {
  std::vector<VectorXd> states;
  for (const TestPoint& point : test_points(system, options)) states.push_back(point.x);
  return states;
}

DerivativeCheck check_derivatives(const HybridSystem& base, const DerivativeCheckOptions& options) {
  std::vector<TestPoint> points = test_points(base, options);
  const VectorXd units = checked_units(base, options);
  const ScaledProblem scaled(base, {units, VectorXd::Ones(base.parameters())});
  const HybridSystem& system = units == VectorXd::Ones(units.size()) ? base : scaled.system();
  for (TestPoint& point : points) point.x = point.x.cwiseQuotient(units);
  DerivativeCheck check;
  check.faults = check_names(system);
  const auto check_all = [&](FunctionKind kind, int count) {
    for (int index = 1; index <= count; ++index)
      check.functions.push_back(FunctionChecker(system, kind, index, points, options.seed).run());
  };
  for (const FunctionKind kind : {FunctionKind::field, FunctionKind::event, FunctionKind::jump})
    check_all(kind, system.count(kind));
  if (system.integral_conditions() > 0) check_all(FunctionKind::integrand, options.segments);
  if (system.boundary_conditions() > 0)
    check.boundary = check_boundary(system, options.segments, checked_parameters(system, options), options.seed);
  return check;
}

std::string to_text(const HybridSystem& system, const DerivativeCheck& check, const std::string& further,
                    bool further_fine) {
  const int order = system.table().derivative_order;
  std::string text = fmt::format("{}: dimension {}, parameters {}, fields {}, events {}, jumps {}\n", system.name(),
                                 system.dimension(), system.parameters(), system.count(FunctionKind::field),
                                 system.count(FunctionKind::event), system.count(FunctionKind::jump));
  text += "  states    ";
  for (int k = 1; k <= system.dimension(); ++k) text += fmt::format(" {}", system.state_name(k));
  text += "\n  parameters";
  for (int k = 1; k <= system.parameters(); ++k) text += fmt::format(" {}", system.parameter_name(k));
  text += fmt::format("\nSupplied derivatives of order {}; relative distance from finite differences:\n", order);
  if (order == 0) text += "  (none: tchat differentiates the values itself)\n";
  for (const FunctionCheck& function : check.functions) text += function_line(system, function, order);
  if (check.boundary) text += to_text(*check.boundary);
  for (const std::string& fault : check.faults) text += fmt::format("fault: {}\n", fault);
  for (const FunctionCheck& function : check.functions)
    for (const std::string& fault : function.faults) text += fmt::format("fault: {}\n", fault);
  if (check.boundary)
    for (const std::string& fault : check.boundary->faults) text += fmt::format("fault: {}\n", fault);
  return text + further + (check.fine() && further_fine ? "No fault found.\n" : "");
}

}  // namespace tchat
