#include "special_points/normal_form_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bvp/condensed_system.hpp"
#include "special_points/label_evidence.hpp"
#include "stability/normal_form.hpp"

namespace tchat {

namespace {

/// Where a power up to the fourth of e^(i theta) is nearly 1, curves of orbits cross what is born.
bool is_strong_resonance(std::complex<double> critical) {
  constexpr double near = 1e-3;
  return std::abs(std::pow(critical, 3) - 1.0) < near || std::abs(std::pow(critical, 4) - 1.0) < near;
}

/// Is every multiplier but the critical one, or pair, surely inside the unit circle?
bool others_are_inside(const FloquetMultipliers& multipliers, std::complex<double> critical) {
  if (!multipliers.determined()) return false;
  std::vector<std::complex<double>> others(multipliers.nontrivial().begin(), multipliers.nontrivial().end());
  const auto leave_out = [&](const std::complex<double>& wanted) {
    const auto nearest = std::min_element(others.begin(), others.end(), [&](const auto& a, const auto& b) {
      return std::abs(a - wanted) < std::abs(b - wanted);
    });
    if (nearest != others.end()) others.erase(nearest);
  };
  leave_out(critical);
  if (critical.imag() != 0.0) leave_out(std::conj(critical));
  return std::all_of(others.begin(), others.end(), [&](const std::complex<double>& mu) {
    return std::abs(mu) < 1.0 - multiplier_accuracy(multipliers);
  });
}

std::string text_of(const char* name, double value, double uncertainty) {
  return fmt::format("{} = {:.10g} +- {:.1g}", name, value, uncertainty);
}

/// `born`: what is born there.
std::string criticality(const TestedPoint& point, bool supercritical, std::complex<double> critical, const char* born) {
  const char* const name = supercritical ? "supercritical" : "subcritical";
  if (!others_are_inside(point.multipliers, critical))
    return fmt::format("{}; another multiplier is, or may be, outside the unit circle", name);
  return supercritical ? fmt::format("{}: stable {} where this orbit is unstable", name, born)
                       : fmt::format("{}: unstable {} where this orbit is stable", name, born);
}

}  // namespace

std::string normal_form_text(const TestedPoint& point, std::complex<double> critical) {
  const DefiningSystem& system = point.condensed.system();
  if (!point.one_parameter_family || point.multipliers.are_eigenvalues || system.orbits() > 1 ||
      system.conserved_quantities() > 0)
    return "";
  if (const int s = touching_segment(point); s >= 0)
    return fmt::format("no normal form: the end of segment {} is tangent to its event surface", s + 1);
  const bool is_fold = critical == 1.0, is_doubling = critical == -1.0;
  const bool is_pair = !is_fold && !is_doubling;
  if (is_pair && is_strong_resonance(critical)) return "no normal form: the angle is that of a strong resonance";
  const std::optional<NormalForm> form = normal_form(system, point.orbit, critical);
  if (!form) return "no normal form: its equations are singular, or the mesh is too coarse for an error estimate";
  const char* const name = is_fold ? "a" : is_doubling ? "c" : "Re d";
  const double value = form->coefficient.real();
  const std::string text = "normal form " + text_of(name, value, form->uncertainty);
  if (is_fold) return text;
  if (!(std::abs(value) > form->uncertainty)) return text + ", too uncertain to decide between sub- and supercritical";
  const bool supercritical = is_doubling ? value > 0.0 : value < 0.0;
  return text + ", " + criticality(point, supercritical, critical, is_pair ? "tori" : "doubled orbits");
}

}  // namespace tchat
