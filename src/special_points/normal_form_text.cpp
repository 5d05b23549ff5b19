#include "special_points/normal_form_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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
  const auto list = multipliers.nontrivial();
  return std::all_of(list.begin(), list.end(), [&](const std::complex<double>& mu) {
    const double distance = std::min(std::abs(mu - critical), std::abs(mu - std::conj(critical)));
    return distance < agreeing_multiplier || std::abs(mu) < 1.0 - multiplier_accuracy(multipliers);
  });
}

std::string text_of(const char* name, double value, double uncertainty) {
  return fmt::format("{} = {:.10g} +- {:.1g}", name, value, uncertainty);
}

/// `born`: what is born there.
std::string criticality(const TestedPoint& point, bool supercritical, std::complex<double> critical, const char* born) {
  const char* const name = supercritical ? "supercritical" : "subcritical";
  if (!others_are_inside(point.multipliers, critical))
    return fmt::format("{}; another multiplier makes all of them unstable, or may do so", name);
  return supercritical ? fmt::format("{}: stable {} where this orbit is unstable", name, born)
                       : fmt::format("{}: unstable {} where this orbit is stable", name, born);
}

}  // namespace

std::string normal_form_text(const TestedPoint& point, std::complex<double> critical) {
  const DefiningSystem& system = point.condensed.system();
  if (!point.one_parameter_family || point.multipliers.are_eigenvalues || system.orbits() > 1) return "";
  if (const int s = touching_segment(point); s >= 0)
    return fmt::format("no normal form: the end of segment {} is tangent to its event surface", s + 1);
  const bool is_fold = critical == 1.0, is_doubling = critical == -1.0;
  const bool is_torus = !is_fold && !is_doubling;
  if (is_torus && is_strong_resonance(critical)) return "no normal form: the angle is that of a strong resonance";
  const std::optional<NormalForm> form = normal_form(system, point.orbit, critical);
  if (!form) return "no normal form: its equations are singular, or the mesh cannot tell how exact they are";
  const char* const name = is_fold ? "a" : is_doubling ? "c" : "Re d";
  const double value = form->coefficient.real();
  const std::string text = "normal form " + text_of(name, value, form->uncertainty);
  if (is_fold) return text;
  if (!(std::abs(value) > form->uncertainty)) return text + ": sub- or supercritical cannot be told";
  const bool supercritical = is_doubling ? value > 0.0 : value < 0.0;
  return text + ", " + criticality(point, supercritical, critical, is_torus ? "tori" : "doubled orbits");
}

}  // namespace tchat
