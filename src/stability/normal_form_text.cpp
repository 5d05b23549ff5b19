#include "stability/normal_form_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "orbit/condensed_system.hpp"
#include "settings/point_type.hpp"
#include "stability/equilibrium_normal_form.hpp"
#include "stability/normal_form.hpp"
#include "stability/test_function.hpp"

namespace tchat {

namespace {

/// Where a power up to the fourth of e^(i theta) is nearly 1, curves of orbits cross what is born.
bool is_strong_resonance(std::complex<double> critical) {
  constexpr double near = 1e-3;
  return std::abs(std::pow(critical, 3) - 1.0) < near || std::abs(std::pow(critical, 4) - 1.0) < near;
}

/// Is every multiplier, or eigenvalue, but the critical one, or pair, surely that of a stable solution?
bool others_are_inside(const FloquetMultipliers& multipliers, std::complex<double> critical) {
  if (!multipliers.determined()) return false;
  std::vector<std::complex<double>> others(multipliers.nontrivial().begin(), multipliers.nontrivial().end());
  const double size = multipliers.are_eigenvalues ? largest_modulus(others) : 1.0;
  const auto leave_out = [&](const std::complex<double>& wanted) {
    const auto nearest = std::min_element(others.begin(), others.end(), [&](const auto& a, const auto& b) {
      return std::abs(a - wanted) < std::abs(b - wanted);
    });
    if (nearest != others.end()) others.erase(nearest);
  };
  leave_out(critical);
  if (critical.imag() != 0.0) leave_out(std::conj(critical));
  return std::all_of(others.begin(), others.end(), [&](const std::complex<double>& mu) {
    return stability_excess(multipliers, mu) < -multiplier_accuracy(multipliers) * size;
  });
}

/// What is born, and where, in words.
struct Birth {
  const char* supercritical;
  const char* subcritical;
};
constexpr Birth of_doubled_orbits = {"stable doubled orbits where this orbit is unstable",
                                     "unstable doubled orbits where this orbit is stable"};
constexpr Birth of_tori = {"stable tori where this orbit is unstable", "unstable tori where this orbit is stable"};
constexpr Birth of_orbits = {"stable orbits where this equilibrium is unstable",
                             "unstable orbits where this equilibrium is stable"};
constexpr Birth of_turning_branch = {"the branch that turns here is stable where the other one is unstable",
                                     "the branch that turns here is unstable where the other one is stable"};

/// What a verdict means, if nothing else makes all solutions unstable.
std::string explanation(const TestedPoint& point, std::complex<double> critical, const char* meaning) {
  if (others_are_inside(point.multipliers, critical)) return fmt::format(": {}", meaning);
  return point.multipliers.are_eigenvalues ? "; another eigenvalue is, or may be, to the right of the imaginary axis"
                                           : "; another multiplier is, or may be, outside the unit circle";
}

/// `what` in a verdict, such as "pitchfork", may be "".
std::string criticality(const TestedPoint& point, const char* name, const Coefficient& coefficient, bool supercritical,
                        std::complex<double> critical, const Birth& birth, std::string_view what = "") {
  NormalFormNote note{name, coefficient.value, coefficient.uncertainty};
  if (!(std::abs(coefficient.value) > coefficient.uncertainty)) {
    note.verdict = "too uncertain to decide between sub- and supercritical";
    return format_normal_form(note, "");
  }
  note.verdict = fmt::format("{}critical{}", supercritical ? "super" : "sub", what);
  return format_normal_form(note,
                            explanation(point, critical, supercritical ? birth.supercritical : birth.subcritical));
}

constexpr const char* singular = "no normal form: its equations are singular";

std::optional<std::string> why_not_smooth(const TestedPoint& point) {
  const int s = touching_segment(point);
  if (s < 0) return std::nullopt;
  return fmt::format("no normal form: the end of segment {} is tangent to its event surface", s + 1);
}

/// Why periodic orbits have no coefficient here; nothing where one can be computed. With monitors held a multiplier 1
/// says nothing of the branch.
std::optional<std::string> why_none(const TestedPoint& point, bool of_multiplier_one) {
  const DefiningSystem& system = point.condensed.system();
  if (point.condition != nullptr || system.orbits() > 1) return "";
  if (system.conserved_quantities() > 0) return "no normal form: a quantity is conserved";
  if (of_multiplier_one && !point.one_parameter_family) return "";
  return why_not_smooth(point);
}

std::string without_estimate() { return fmt::format("{}, or the mesh is too coarse for an error estimate", singular); }

}  // namespace

std::string normal_form_text(const TestedPoint& point, std::complex<double> critical) {
  if (point.multipliers.are_eigenvalues) return "";
  if (const std::optional<std::string> why = why_none(point, critical == 1.0)) return *why;
  const bool is_fold = critical == 1.0, is_doubling = critical == -1.0;
  const bool is_pair = !is_fold && !is_doubling;
  if (is_pair && is_strong_resonance(critical)) return "no normal form: the angle is that of a strong resonance";
  const std::optional<NormalForm> form = normal_form(point.condensed.system(), point.orbit, point.tangent, critical);
  if (!form) return without_estimate();
  const Coefficient coefficient{form->coefficient.real(), form->uncertainty};
  if (is_fold) return format_normal_form({"a", coefficient.value, coefficient.uncertainty}, "");
  if (is_doubling) return criticality(point, "c", coefficient, coefficient.value > 0.0, critical, of_doubled_orbits);
  return criticality(point, "Re d", coefficient, coefficient.value < 0.0, critical, of_tori);
}

std::string fold_text(const TestedPoint& point) {
  if (!point.multipliers.are_eigenvalues) return normal_form_text(point, 1.0);
  if (!point.one_parameter_family) return "";
  const std::optional<Coefficient> a = equilibrium_fold_form(point.condensed.system(), point.orbit);
  return a ? format_normal_form({"a", a->value, a->uncertainty}, "") : singular;
}

std::string branch_point_text(const TestedPoint& point) {
  const FloquetMultipliers& multipliers = point.multipliers;
  if (!point.one_parameter_family || !multipliers.valid) return "";
  const DefiningSystem& system = point.condensed.system();
  if (!multipliers.are_eigenvalues)
    if (const std::optional<std::string> why = why_none(point, true)) return *why;
  const std::optional<BranchingForm> form =
      multipliers.are_eigenvalues ? equilibrium_branching(system, point.orbit) : orbit_branching(system, point.orbit);
  if (!form) return multipliers.are_eigenvalues ? singular : without_estimate();
  const std::complex<double> critical = multipliers.are_eigenvalues ? 0.0 : 1.0;
  NormalFormNote note{"a", form->a.value, form->a.uncertainty};
  switch (branching_of(*form)) {
    case Branching::pitchfork:
      return criticality(point, "c", form->c, form->c.value < 0.0, critical, of_turning_branch, " pitchfork");
    case Branching::transcritical:
      note.verdict = "transcritical";
      return format_normal_form(
          note, fmt::format("{}; {} +- b dp, b = {:.10g} +- {:.1g}",
                            explanation(point, critical, "stability passes from one branch to the other"),
                            multipliers.are_eigenvalues ? "eigenvalues" : "multipliers 1", form->b.value,
                            form->b.uncertainty));
    default:
      note.verdict = "too uncertain to decide between transcritical and pitchfork";
      return format_normal_form(note, "");
  }
}

std::string codimension_two_text(const TestedPoint& point, PointType type) {
  const DefiningSystem& system = point.condensed.system();
  if (point.multipliers.are_eigenvalues || system.orbits() > 1 || system.conserved_quantities() > 0) return "";
  if (const std::optional<std::string> why = why_not_smooth(point)) return *why;
  std::string text;
  for (const auto& [name, of] : codimension_two_form(system, point.orbit, type))
    text += text.empty() ? format_normal_form({name, of.value, of.uncertainty}, "")
                         : fmt::format("; {} = {:.10g} +- {:.1g}", name, of.value, of.uncertainty);
  return text.empty() ? without_estimate() : text;
}

std::string hopf_text(const TestedPoint& point, double omega) {
  if (!point.one_parameter_family) return "";
  const Coefficient coefficient = first_lyapunov_coefficient(point.condensed.system(), point.orbit, omega);
  if (!std::isfinite(coefficient.value)) return singular;
  return criticality(point, "l_1", coefficient, coefficient.value < 0.0, {0.0, omega}, of_orbits);
}

}  // namespace tchat
