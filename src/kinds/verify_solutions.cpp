#include "kinds/verify_solutions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <utility>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/auto_format.hpp"
#include "files/diagnostics_file.hpp"
#include "files/recorded_labels.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "kinds/verify_between.hpp"
#include "model/events.hpp"
#include "orbit/admissibility.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/torus_system.hpp"
#include "plugin/exit_guard.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_library.hpp"
#include "plugin/problem_setup.hpp"
#include "run/orbit_start.hpp"
#include "run/torus_start.hpp"
#include "settings/constant_value.hpp"
#include "settings/constants_file.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"
#include "settings/settings_type.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
using Multipliers = std::vector<Complex>;

/// exp(i theta) of the one off the real axis that is nearest to the unit circle.
std::optional<Complex> angle_of_pair(const Multipliers& multipliers) {
  const Complex* nearest = nullptr;
  const auto distance = [](const Complex& mu) { return std::abs(std::abs(mu) - 1.0); };
  for (const Complex& mu : multipliers)
    if (mu.imag() > 0.0 && (nearest == nullptr || distance(mu) < distance(*nearest))) nearest = &mu;
  if (nearest == nullptr) return std::nullopt;
  return *nearest / std::abs(*nearest);
}

/// Type numbers of what is critical there: the tens digit of a point on a two-parameter curve, or its own number.
std::vector<int> critical_types(const LabelledSolution& solution, bool is_in_parameter) {
  if (keeps_contact(solution.problem_type)) return {};
  if (const int curve = curve_type(solution.type); curve > 0) return {curve};
  std::vector<int> types = {solution.type};
  for (const UserPointKind& kind : solution.further)
    if (kind.kind == UserPointKind::other_type) types.push_back(kind.index);
  if (!is_in_parameter)
    std::erase_if(types, [](int type) {
      return type == static_cast<int>(PointType::fold) || type == static_cast<int>(PointType::branch_point);
    });
  return types;
}

}  // namespace

Multipliers critical_multipliers(const LabelledSolution& solution, const Multipliers& stored,
                                 const Multipliers& computed, bool is_in_parameter) {
  Multipliers critical;
  for (const int type : critical_types(solution, is_in_parameter)) {
    if (type == static_cast<int>(PointType::fold) || type == static_cast<int>(PointType::branch_point))
      critical.push_back(1.0);
    else if (type == static_cast<int>(PointType::period_doubling))
      critical.push_back(-1.0);
    else if (type == static_cast<int>(PointType::torus))
      if (const auto mu = angle_of_pair(stored.empty() ? computed : stored)) critical.push_back(*mu);
  }
  for (const UserPointKind& kind : all_kinds(solution))
    if (kind.kind == UserPointKind::grazing_codimension_two && kind.index != 0)
      critical.push_back(static_cast<double>(kind.index));
  return critical;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// |h_x f| up to this share of |h_x| |f| is contact.
constexpr double least_rate = level::located;

/// The N returns that begin at the phases offset + i / N.
Orbit returns_from(const TorusSystem& torus, const Orbit& x, double offset) {
  Orbit result = x;
  const int m = torus.segments_per_return();
  for (int i = 0; i < torus.orbits(); ++i) {
    const Orbit one = return_at(torus, x, offset + static_cast<double>(i) / torus.orbits());
    result.states.middleCols(i * one.states.cols(), one.states.cols()) = one.states;
    for (int s = 0; s < m; ++s) result.duration(i * m + s) = one.duration(s);
  }
  return result;
}

/// What follows each segment of those returns: the start of the next one, or u(phi + rho).
MatrixXd following_states(const TorusSystem& torus, const Orbit& x, const Orbit& returns, double offset) {
  const int m = torus.segments_per_return();
  const Index n = x.shape.dimension;
  MatrixXd states(n, returns.shape.segments);
  for (int s = 0; s < returns.shape.segments; ++s) {
    if ((s + 1) % m != 0) {
      states.col(s) = Eigen::Map<const VectorXd>(returns.start(s + 1), n);
      continue;
    }
    const int orbit = s / m;
    const double phi = offset + static_cast<double>(orbit) / torus.orbits() + TorusSystem::rotation(x);
    states.col(s) = return_at(torus, x, phi).states.col(0) + torus.winding().returns;
  }
  return states;
}

/// What matters of `other` too.
void take_worse(SegmentCheck& worst, const SegmentCheck& other) {
  if (worst.message.empty()) worst.message = other.message;
  worst.growth = std::max(worst.growth, other.growth);
  worst.state_defect = std::max(worst.state_defect, other.state_defect);
  worst.time_defect = std::max(worst.time_defect, other.time_defect);
  worst.event_level = std::max(worst.event_level, other.event_level);
  worst.touches = worst.touches && other.touches;
  worst.leaves_surface = worst.leaves_surface || other.leaves_surface;
  if (worst.wrong.empty()) worst.wrong = other.wrong;
  if (worst.passed.empty()) worst.passed = other.passed;
}

/// The derivatives of the N integrated returns, each a column; NaN where one ends in contact. `links`: of all segments
/// of all returns.
MatrixXd integrated_returns(const TorusSystem& torus, const std::vector<SegmentLink>& links, Index n) {
  const int m = torus.segments_per_return();
  MatrixXd columns(n * n, torus.orbits());
  for (int i = 0; i < torus.orbits(); ++i) {
    MatrixXd product = MatrixXd::Identity(n, n);
    for (int s = 0; s < m; ++s) {
      const SegmentLink& link = links[static_cast<std::size_t>(i * m + s)];
      const double rate = link.hx * link.f;
      if (!(std::abs(rate) > least_rate * link.hx.norm() * link.f.norm())) return MatrixXd::Constant(n * n, 1, NAN);
      product = link.gx * project_along_flow(link.f, link.hx.transpose(), link.flow * product);
    }
    columns.col(i) = Eigen::Map<const VectorXd>(product.data(), n * n);
  }
  return columns;
}

/// The largest range of a state over the curve, relative to its scale. An error of the curve turns its direction, along
/// which one multiplier is 1, by that error divided by this: near the birth of a torus multipliers are known to less.
double curve_size(const TorusSystem& torus, const Orbit& x, const VectorXd& scale) {
  const MatrixXd curve = periodic_section_curve(torus, x);
  const VectorXd ranges = curve.rowwise().maxCoeff() - curve.rowwise().minCoeff();
  return (ranges + torus.winding().curve.cwiseAbs()).cwiseQuotient(scale).cwiseMin(1.0).maxCoeff();
}

/// Moduli of the multipliers of the integrated returns; empty where there are none. `scale`: the sizes of states in
/// which the links are.
std::vector<std::complex<double>> integrated_moduli(const TorusSystem& torus, const Orbit& x,
                                                    const std::vector<SegmentLink>& links, const VectorXd& scale) {
  const int states = least_dimension(torus.system(), torus.signature());
  if (links.empty() || states < 2) return {};
  const MatrixXd matrices = integrated_returns(torus, links, x.shape.dimension);
  if (!matrices.allFinite()) return {};
  const MatrixXd curve = scale.cwiseInverse().asDiagonal() * periodic_section_curve(torus, x);
  const VectorXd moduli = moduli_along_rotation(matrices, curve, torus.winding().curve.cwiseQuotient(scale),
                                                TorusSystem::rotation(x), states);
  std::vector<std::complex<double>> result(moduli.begin(), moduli.end());
  result.emplace_back(0.0);
  return result;
}

}  // namespace

OrbitCheck check_torus(const HybridSystem& system, const RunSettings& one_return, const Orbit& x,
                       const std::vector<std::complex<double>>& stored, double tolerance) {
  const int m = segment_count(one_return);
  const int orbits = x.shape.segments / m;
  const TorusSystem torus(system, one_return.signature(), orbits, {}, torus_winding(system, one_return.signature(), x));
  const RunSettings settings = settings_of_orbits(one_return, orbits);
  const VectorXd scale = state_sizes(system, settings.signature(), x);
  const std::vector<Index> angles = angle_states(system, one_return.signature(), section_curve(torus, x), x.par);
  OrbitCheck result;
  for (const double offset : {0.0, 0.5 / orbits}) {
    const Orbit returns = offset == 0.0 ? x : returns_from(torus, x, offset);
    const std::vector<SegmentCheck> checks = check_segments(
        system, settings, returns, scale, following_states(torus, x, returns, offset), tolerance, angles);
    if (offset == 0.0)
      result.multipliers = integrated_moduli(torus, x, links_of(system, settings, x, checks, scale), scale);
    for (std::size_t s = 0; s < checks.size(); ++s) {
      const std::size_t place = s % static_cast<std::size_t>(m);
      if (result.segments.size() <= place)
        result.segments.push_back(checks[s]);
      else
        take_worse(result.segments[place], checks[s]);
    }
  }
  for (int s = 0; s < m; ++s) {
    double mean = 0.0;
    for (int i = 0; i < orbits; ++i) mean += x.duration(i * m + s) / orbits;
    result.durations.push_back(mean);
    result.period += std::abs(mean);
  }
  result.goes_forward = x.period() > 0.0 && std::isfinite(x.period());
  if (!(result.period > 0.0)) result.period = 1.0;
  result.computes_multipliers = true;
  if (result.multipliers.size() == stored.size() && !stored.empty()) {
    result.multiplier_difference = largest_difference(stored, result.multipliers);
    result.multiplier_error = *result.multiplier_difference * curve_size(torus, x, scale);
  }
  return result;
}

namespace {

std::vector<LabelledSolution> chosen(const VerifyRequest& request, const SolutionFile& file, const std::string& path) {
  if (request.labels.empty()) return file.solutions;
  std::vector<LabelledSolution> result;
  for (const std::string& word : request.labels)
    result.push_back(find_solution(file.solutions, read_label(word), path));
  return result;
}

/// The points of the d-file; empty when there is none.
std::vector<DiagnosticPoint> recorded_points(const std::string& path) {
  if (path.empty() || !std::filesystem::exists(path)) return {};
  return read_diagnostics_file(path);
}

/// Those with a label, by its number.
std::map<int, const DiagnosticPoint*> labelled_points(const std::vector<DiagnosticPoint>& points) {
  std::map<int, const DiagnosticPoint*> result;
  for (const DiagnosticPoint& point : points)
    if (point.label > 0) result[point.label] = &point;
  return result;
}

const char* word_for(Defect defect) {
  switch (defect) {
    case Defect::not_integrated:
      return "not integrated";
    case Defect::undecided:
      return "undecided: errors grow too much";
    case Defect::duration:
      return "no positive duration";
    case Defect::integral:
      return "integral condition";
    case Defect::state:
      return "state";
    case Defect::time:
      return "time";
    case Defect::event:
      return "event";
    case Defect::critical:
      return "no critical multiplier";
    default:
      return "multipliers";
  }
}

/// What is seen of one label.
struct Verdict {
  bool is_right = true;          // segments that say nothing do not count
  bool is_undecided = false;     // there are such
  bool is_inadmissible = false;  // as stored
};

struct Largest {
  double value = 0.0;
  std::string where = "none";
  void take(double other, const std::string& place) {
    if (!(other > value)) return;
    value = other;
    where = place;
  }
};

/// Do folds and branch points of this run have the multiplier 1, whatever was found out while it ran?
bool is_in_parameter(const RunSettings& settings) {
  if (!settings.held.empty()) return false;
  return !settings.conserved.empty() || !is_monitor(settings, settings.free_parameters.front());
}

class Table {
 public:
  Table(const HybridSystem& system, const RunSettings& settings, double tolerance, std::ostream& screen)
      : system_(system),
        settings_(settings),
        family_(family_of(settings.problem_type)),
        tolerance_(tolerance),
        screen_(screen) {
    screen_ << " LAB  TY SEG              T    STATE     TIME   GROWTH  MULTIPL.  CRITICAL  EVENT\n";
  }

  Verdict add(const LabelledSolution& solution, const DiagnosticPoint* recorded) {
    const std::string why_not = family_.mismatch(solution, settings_);
    if (!why_not.empty()) {
      screen_ << fmt::format("{:>4}  {:<2}  not verified: {}\n", solution.label, type_name(solution), why_not);
      return {false, false};
    }
    const Orbit x = orbit_of(solution);
    const auto stored = recorded != nullptr ? recorded->multipliers : std::vector<std::complex<double>>{};
    const OrbitCheck check = family_.check(
        system_, settings_, x, stored, tolerance_, [&](const std::vector<std::complex<double>>& computed) {
          return critical_multipliers(solution, stored, computed, is_in_parameter(settings_));
        });
    const bool is_inadmissible = recorded != nullptr ? !recorded->admissible : has_inadmissibilities(x);
    return rows(solution, check, is_inadmissible);
  }

  std::string worst() const {
    const std::string critical =
        critical_.where == "none" ? "" : fmt::format(", critical ones {:.1e} ({})", critical_.value, critical_.where);
    const std::string integral =
        integral_.where == "none" ? ""
                                  : fmt::format(", integral conditions {:.1e} ({})", integral_.value, integral_.where);
    const std::string multipliers =
        multipliers_.where == "none" ? "no multipliers compared"
                                     : fmt::format("multipliers {:.1e} ({})", multipliers_.value, multipliers_.where);
    return folded(fmt::format("Largest defects{}: states {:.1e} ({}), times {:.1e} ({}), {}{}{}.",
                              family_.checked_trajectories(), state_.value, state_.where, time_.value, time_.where,
                              multipliers, critical, integral));
  }

 private:
  Orbit orbit_of(const LabelledSolution& solution) const {
    const auto segments = static_cast<int>(solution.states.rows() / settings_.dimension);
    return orbit_from_solution(in_layout(solution, system_.layout()),
                               stored_shape(solution, settings_.dimension, segments), {}, "the q-file")
        .orbit;
  }

  bool has_inadmissibilities(const Orbit& x) const {
    Signature signature;  // of all returns
    std::vector<std::vector<int>> monitored;
    for (std::size_t s = 0; s < static_cast<std::size_t>(x.shape.segments); ++s) {
      const SegmentSettings& segment = settings_.segments[s % settings_.segments.size()];
      signature.push_back(segment.index);
      monitored.push_back(segment.monitor);
    }
    const CollocationRule rule(x.shape.collocation);
    const double error = estimated_error(system_, signature, x, rule);
    return !inadmissibilities(system_, signature, monitored, x, rule, error).empty();
  }

  std::string event_name(int event) const { return system_.function_name(FunctionKind::event, event); }

  /// "front, but end of slip at t = 0.31 comes first"
  std::string events(const OrbitCheck& check, std::size_t s) const {
    const SegmentCheck& segment = check.segments[s];
    const int event = settings_.segments[s].index.event;
    std::string text = event == no_function ? "-" : event_name(event);
    for (const EventMet& met : segment.wrong)
      text += fmt::format(", but {} at t = {:.6g} comes first (depth {:.1e})", event_name(met.event),
                          met.time > level::orbit * check.period ? met.time : 0.0, met.depth);
    if (segment.leaves_surface) text += ", crossed from below";
    if (segment.breaks_rules) text += ", after which the problem's rules have another segment";
    if (check.durations[s] < 0.0 && segment.wrong.empty()) text += ", negative duration";
    if (!segment.passed.empty() && segment.wrong.empty())
      text += fmt::format(", passes {} at t = {:.6g}{}", event_name(segment.passed.front().event),
                          segment.passed.front().time,
                          segment.passed.size() > 1 ? fmt::format(" and {} more", segment.passed.size() - 1) : "");
    return segment.message.empty() ? text : segment.message;
  }

  /// Of an orbit for which none are stored, or which has none.
  static std::string multipliers_of(const OrbitCheck& check) {
    std::string list;
    for (const std::complex<double>& mu : check.multipliers)
      list += fmt::format(
          "{}{:.8g}{}", list.empty() ? "" : ", ", mu.real(),
          mu.imag() == 0.0 ? "" : fmt::format(" {} {:.8g}i", mu.imag() < 0 ? '-' : '+', std::abs(mu.imag())));
    return fmt::format("{:12}multipliers: {}\n", "", list.empty() ? "not determined" : list);
  }

  Verdict rows(const LabelledSolution& solution, const OrbitCheck& check, bool is_inadmissible) {
    Verdict verdict;
    for (std::size_t s = 0; s < check.segments.size(); ++s) {
      const SegmentCheck& segment = check.segments[s];
      std::vector<Defect> defects = defects_of(check, s, tolerance_);
      const bool excused = is_inadmissible && std::erase(defects, Defect::event) > 0;
      if (s == 0 && are_multipliers_wrong(check, tolerance_)) defects.push_back(Defect::multipliers);
      if (s == 0 && are_critical_ones_wrong(check, tolerance_)) defects.push_back(Defect::critical);
      const bool is_undecided =
          defects == std::vector{Defect::undecided} || defects == std::vector{Defect::not_integrated};
      verdict.is_right = verdict.is_right && (defects.empty() || is_undecided);
      verdict.is_undecided = verdict.is_undecided || is_undecided;
      verdict.is_inadmissible = verdict.is_inadmissible || excused;
      std::vector<const char*> words;
      for (const Defect defect : defects) words.push_back(word_for(defect));
      const std::string end = !words.empty() ? fmt::format("  << {}", fmt::join(words, ", "))
                              : excused      ? "  inadmissible as stored"
                                             : "";
      const std::string place = fmt::format("label {}, segment {}", solution.label, s + 1);
      const double time = segment.time_defect / check.period;
      state_.take(segment.state_defect, place);
      time_.take(time, place);
      const std::string name = s == 0 ? fmt::format("{:>4}  {:<2}", solution.label, type_name(solution)) : "";
      const auto once = [s](const std::optional<double>& value) {
        return s == 0 && value ? fmt::format("{:.1e}", *value) : "";
      };
      screen_ << fmt::format("{:<8}{:>4}{:>15.7g}{:>9.1e}{:>9.1e}{:>9.1e}{:>10}{:>10}  {}{}\n", name, s + 1,
                             check.durations[s], segment.state_defect, time, segment.growth,
                             once(check.multiplier_difference), once(check.critical_difference), events(check, s), end);
    }
    if (!check.multiplier_difference && check.computes_multipliers) screen_ << multipliers_of(check);
    if (check.multiplier_difference)
      multipliers_.take(*check.multiplier_difference, fmt::format("label {}", solution.label));
    if (check.integral_defect) integral_.take(*check.integral_defect, fmt::format("label {}", solution.label));
    if (check.critical_difference) critical_.take(*check.critical_difference, fmt::format("label {}", solution.label));
    return verdict;
  }

  const HybridSystem& system_;
  const RunSettings& settings_;
  const SolutionFamily& family_;
  double tolerance_;
  std::ostream& screen_;
  Largest state_, time_, multipliers_, critical_, integral_;
};

/// Labels in a summary.
constexpr std::size_t most_named = 20;

/// "1, 4, 7", as many as are named.
std::string list_of(const std::vector<int>& labels) {
  const std::size_t named = std::min(labels.size(), most_named);
  return fmt::format("{}{}", fmt::join(labels.begin(), labels.begin() + static_cast<std::ptrdiff_t>(named), ", "),
                     labels.size() > named ? ", ..." : "");
}

/// Labels by their verdict.
struct Verdicts {
  std::vector<int> wrong, undecided;
  std::size_t all = 0;
  int inadmissible = 0;
};

std::string summary(const std::string& path, const Verdicts& of, double tolerance, bool are_right_between) {
  const std::string stored =
      of.inadmissible > 0 ? fmt::format(" ({} inadmissible, as the run had found)", of.inadmissible) : "";
  const std::string open =
      of.undecided.empty()
          ? ""
          : fmt::format("{} of {} labels undecided, as errors grow too much along them or integration failed: {}",
                        of.undecided.size(), of.all, list_of(of.undecided));
  if (!of.wrong.empty())
    return fmt::format("{}: {} of {} labels beyond the tolerance {:g}{}: {}{}{}\n", path, of.wrong.size(), of.all,
                       tolerance, stored, list_of(of.wrong), open.empty() ? "" : "; ", open);
  const std::size_t right = of.all - of.undecided.size();
  if (right == 0) return fmt::format("{}: {}.\n", path, open);
  return fmt::format("{}: {} label{} agree{} with forward integration to {:g}{}{}{}{}.\n", path, right,
                     right == 1 ? "" : "s", right == 1 ? "s" : "", tolerance, stored, open.empty() ? "" : "; ", open,
                     are_right_between ? "" : ", but points between are none of the curve");
}

}  // namespace

bool verify_solutions(const VerifyRequest& request, std::ostream& screen, std::ostream& warnings) {
  if (!(request.tolerance > 0.0 && request.tolerance < 1.0))
    throw UserError(
        fmt::format("--tolerance {:g}: a number between 0 and 1 is needed, such as 1e-6", request.tolerance));
  const std::string path = resolve_solution_path(request.solutions);
  const SolutionFile file = read_solution_file(path);
  const std::vector<LabelledSolution> solutions = chosen(request, file, path);
  const std::string constants = constants_of_run(request.constants, path);
  RunSettings settings = read_constants_file(constants);

  if (const std::string why = family_of(settings.problem_type).why_unverifiable(settings); !why.empty())
    throw UserError(fmt::format("{}: {}", path, why));

  const std::string plugin =
      resolve_plugin_of_run(request.problem, run_path(path), recorded_problem(settings, constants), warnings);
  const ExitGuard guard(plugin);
  const ProblemLibrary library(plugin, [&] { return problem_sizes(settings); });
  const HybridSystem& system = library.system();
  require_recorded_parameters(path, system);
  resolve_names(settings, system);
  check_settings_against(system, settings, {constants});
  for (const std::string& warning : file.warnings) warnings << "tchat: warning: " << warning << '\n';

  const std::string diagnostics = sibling_path(path, 'd');
  const std::vector<DiagnosticPoint> recorded = recorded_points(diagnostics);
  const std::map<int, const DiagnosticPoint*> labelled = labelled_points(recorded);
  if (recorded.empty() && has_multipliers(settings.problem_type))
    warnings << fmt::format("tchat: warning: there is no {}: multipliers are compared with nothing\n",
                            diagnostics.empty() ? "d-file" : diagnostics);
  Table table(system, settings, request.tolerance, screen);
  Verdicts verdicts{{}, {}, solutions.size(), 0};
  for (const LabelledSolution& solution : solutions) {
    const auto found = labelled.find(solution.label);
    const Verdict verdict = table.add(solution, found != labelled.end() ? found->second : nullptr);
    if (!verdict.is_right)
      verdicts.wrong.push_back(solution.label);
    else if (verdict.is_undecided)
      verdicts.undecided.push_back(solution.label);
    verdicts.inadmissible += verdict.is_inadmissible ? 1 : 0;
  }
  const PointsBetween between =
      request.labels.empty() && is_in_parameter(settings)
          ? look_between_labels(recorded, file.solutions, settings.segments.front().index.event == no_function,
                                request.tolerance)
          : PointsBetween{};
  screen << table.worst() << describe(between, request.tolerance)
         << summary(path, verdicts, request.tolerance, between.are_right());
  return verdicts.wrong.empty() && verdicts.undecided.empty() && between.are_right();
}

}  // namespace tchat
