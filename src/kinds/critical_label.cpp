#include "kinds/critical_label.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "files/solution_file.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

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

}  // namespace tchat
