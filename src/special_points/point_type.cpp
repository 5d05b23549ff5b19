#include "special_points/point_type.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace tchat {

namespace {

std::string user_point_name(const UserPointKind& kind) {
  switch (kind.kind) {
    case UserPointKind::contact:
    case UserPointKind::impact_velocity:
      return "GR";
    case UserPointKind::xi:
      return "XI";
    case UserPointKind::grazing_codimension_two:
      return "GC";
    case UserPointKind::boundary_equilibrium:
      return "BE";
    default:
      return "UZ";
  }
}

/// AUTO's codes that are not a tens digit before a basic type; "" for all others.
std::string codimension_two_name(int type) {
  switch (type) {
    case 23:
    case 83:
      return "LTR";
    case 28:
    case 78:
      return "LPD";
    case 77:
    case 87:
      return "PTR";
    case 88:
      return "TTR";
    case -32:
      return "GH";
    default:
      return "";
  }
}

}  // namespace

int basic_type(int type) { return type % 10; }

int file_type(PointType type, int curve) {
  const int number = static_cast<int>(type);
  if (number == 0 || std::abs(number) >= 10) return number;
  return number < 0 ? number - 10 * curve : number + 10 * curve;
}

bool is_fold(PointType type) { return type == PointType::fold || type == PointType::equilibrium_fold; }

bool is_bifurcation(PointType type) {
  switch (type) {
    case PointType::fold:
    case PointType::equilibrium_fold:
    case PointType::branch_point:
    case PointType::equilibrium_branch_point:
    case PointType::hopf:
    case PointType::period_doubling:
    case PointType::torus:
      return true;
    default:
      return false;
  }
}

std::string type_name(int type, const UserPointKind& kind) {
  if (const std::string name = codimension_two_name(type); !name.empty()) return name;
  switch (basic_type(type)) {
    case 1:
    case 6:
      return "BP";
    case 2:
    case 5:
      return "LP";
    case 3:
      return "HB";
    case 4:
      return "RG";
    case -4:
      return user_point_name(kind);
    case 7:
      return "PD";
    case 8:
      return "TR";
    case 9:
      return "EP";
    case -9:
      return "MX";
    case -1:
      return "BT";
    case -2:
      return "CP";
    case -3:
      return "ZH";
    case -5:
      return "R1";
    case -6:
      return "R2";
    case -7:
      return "R3";
    case -8:
      return "R4";
    default:
      return "";
  }
}

std::string curve_name(int curve_type) {
  const bool of_user_points = curve_type == -static_cast<int>(PointType::user);
  return of_user_points ? user_point_name({UserPointKind::contact}) : type_name(curve_type);
}

std::vector<std::string> type_names(int type, const UserPointKind& kind, const std::vector<UserPointKind>& further) {
  constexpr int user = static_cast<int>(PointType::user);
  std::vector<std::string> names{type_name(type, kind)};
  for (const UserPointKind& other : further) {
    const std::string name = type_name(other.kind == UserPointKind::other_type ? other.index : user, other);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::string description(const UserPointKind& kind, const std::string& parameter) {
  switch (kind.kind) {
    case UserPointKind::user_value:
      return "user value of " + (parameter.empty() ? fmt::format("PAR({})", kind.index) : parameter);
    case UserPointKind::contact:
      return fmt::format("contact inside segment {}, event function {}, tau = {:.6g}", kind.segment, kind.index,
                         kind.tau);
    case UserPointKind::xi:
      return fmt::format("xi_{} = 0", kind.index);
    case UserPointKind::impact_velocity:
      return fmt::format("impact velocity zero at the end of segment {}, event function {}", kind.segment, kind.index);
    case UserPointKind::grazing_codimension_two:
      if (kind.index == 0) return "a* = 0: h is no longer least at the contact";
      return kind.index < 0 ? "grazing-flip: multiplier -1 of the orbit that grazes, without the contact"
                            : "grazing-fold: multiplier +1 of the orbit that grazes, without the contact";
    case UserPointKind::boundary_equilibrium:
      return fmt::format("boundary equilibrium, event function {}", kind.index);
    case UserPointKind::other_type:
      return type_name(kind.index);
    default:
      return "";
  }
}

}  // namespace tchat
