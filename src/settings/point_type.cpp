#include "settings/point_type.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/words.hpp"

namespace tchat {

namespace {

constexpr auto table = std::to_array<PointTypeFacts>({
    {"BP", 6, UserPointKind::none,
     "branch point: the problem is singular and its bordered determinant changes sign; ISW = -1 starts the other "
     "branch",
     PointSymbol::pentagon, true, true, true, false},
    {"BP", 1, UserPointKind::none, "branch point of equilibria", PointSymbol::pentagon, true, true, true, false},
    {"LP", 5, UserPointKind::none, "fold: ICP(1) turns by more than rounding, on a grazing curve too",
     PointSymbol::square, true, true, true, false},
    {"LP", 2, UserPointKind::none, "fold of equilibria", PointSymbol::square, true, true, true, false},
    {"HB", 3, UserPointKind::none,
     "Hopf bifurcation: a pair of eigenvalues of an equilibrium on the imaginary axis; also the end of a branch of "
     "periodic orbits that shrink to one",
     PointSymbol::reversed_triangle, true, true, true, false},
    {"PD", 7, UserPointKind::none, "period doubling: a multiplier passes -1", PointSymbol::triangle, true, true, true,
     false},
    {"TR", 8, UserPointKind::none, "torus bifurcation: a complex pair of multipliers passes the unit circle",
     PointSymbol::diamond, true, true, true, false},
    {"UZ", -4, UserPointKind::none, "a point without a kind, of AUTO's files", PointSymbol::circle, true, false, false,
     false},
    {"UZ", -4, UserPointKind::user_value, "user value (UZR)", PointSymbol::circle, true, false, false, false},
    {"GR", -4, UserPointKind::contact,
     "grazing: contact with a monitored event inside a segment, or two events at once where another event cuts the "
     "orbit; the branch ends there unless GRSTOP=0",
     PointSymbol::circle, false, true, false, false},
    {"GR", -4, UserPointKind::impact_velocity,
     "grazing: the velocity of an impact passes zero, or a section becomes tangent; the branch ends there unless "
     "GRSTOP=0",
     PointSymbol::circle, false, true, false, false},
    {"GR", -4, UserPointKind::rule,
     "the rules of the model change: beyond it another jump follows the end of a segment; the branch ends there unless "
     "GRSTOP=0",
     PointSymbol::circle, false, true, false, false},
    {"GR", -4, UserPointKind::chatter,
     "chatter becomes incomplete: on one side the impacts of a segment do not accumulate; the branch ends there unless "
     "GRSTOP=0",
     PointSymbol::circle, false, true, false, false},
    {"BE", -4, UserPointKind::boundary_equilibrium,
     "boundary equilibrium: a monitored event function is zero at an equilibrium; the branch ends there unless "
     "GRSTOP=0 or the function rises",
     PointSymbol::pentagon, false, true, false, false},
    {"XI", -4, UserPointKind::xi,
     "xi_n = 0 on a grazing curve (n from GCIPSI); functions that vanish together have one label", PointSymbol::circle,
     true, true, false, false},
    {"GC", -4, UserPointKind::grazing_codimension_two,
     "grazing-fold or grazing-flip: the orbit without the contact has the multiplier +1 or -1; or a* = 0",
     PointSymbol::diamond, false, true, false, false},
    {"EX", -4, UserPointKind::extremum,
     "extremum of ICP(1): of a monitor along the branch, with ISW = 2, 3, ... in one parameter more; of a "
     "parameter along a curve",
     PointSymbol::reversed_triangle, false, true, false, false},
    {"CP", -2, UserPointKind::none, "cusp on a curve of folds", PointSymbol::square, false, true, false, false},
    {"BT", -1, UserPointKind::none, "Bogdanov-Takens point on a curve of equilibria: a double eigenvalue 0",
     PointSymbol::reversed_triangle, false, true, false, false},
    {"ZH", -3, UserPointKind::none, "zero-Hopf point on a curve of equilibria", PointSymbol::pentagon, false, true,
     false, false},
    {"GH", -32, UserPointKind::none, "generalized Hopf (Bautin) point on a curve of Hopf bifurcations",
     PointSymbol::diamond, false, true, false, true},
    {"HH", 33, UserPointKind::none,
     "double Hopf point on a curve of Hopf bifurcations: two pairs of eigenvalues on the imaginary axis",
     PointSymbol::reversed_triangle, false, true, false, true},
    {"R1", -5, UserPointKind::none, "1:1 resonance on a curve of folds or torus bifurcations, which ends there",
     PointSymbol::reversed_triangle, false, true, false, false},
    {"R2", -6, UserPointKind::none,
     "1:2 resonance on a curve of period doublings or torus bifurcations, which ends there", PointSymbol::triangle,
     false, true, false, false},
    {"R3", -7, UserPointKind::none, "1:3 resonance on a curve of torus bifurcations", PointSymbol::pentagon, false,
     true, false, false},
    {"R4", -8, UserPointKind::none, "1:4 resonance on a curve of torus bifurcations", PointSymbol::diamond, false, true,
     false, false},
    {"GPD", -71, UserPointKind::none,
     "generalised period doubling on a curve of period doublings: the coefficient c of the normal form is zero",
     PointSymbol::triangle, false, true, false, true},
    {"GPD", -51, UserPointKind::none,
     "generalised period doubling, where a curve of folds of doubled orbits begins: their halves are the same",
     PointSymbol::triangle, false, true, false, true},
    {"CH", -81, UserPointKind::none,
     "Chenciner point on a torus curve: the coefficient Re d of the normal form is zero", PointSymbol::diamond, false,
     true, false, true},
    {"EP", 9, UserPointKind::none,
     "first point of a run from data, or the regular end of a branch; also where a closed branch is back at its first "
     "point, or an orbit has shrunk to an equilibrium",
     PointSymbol::dot, true, false, false, false},
    {"MX", -9, UserPointKind::none, "no convergence: the last converged point again, with its mesh and multipliers",
     PointSymbol::reversed_triangle, true, false, false, false},
    {"RG", 4, UserPointKind::none, "every NPR-th point", PointSymbol::dot, true, false, false, false},
    {"LTR", 23, UserPointKind::none,
     "fold and torus bifurcation at once: a multiplier 1 and a complex pair on the unit circle", PointSymbol::square,
     false, true, false, true},
    {"LTR", 83, UserPointKind::none,
     "fold and torus bifurcation at once: a multiplier 1 and a complex pair on the unit circle", PointSymbol::square,
     false, true, false, true},
    {"LPD", 28, UserPointKind::none, "fold and period doubling at once (fold-flip): multipliers 1 and -1",
     PointSymbol::square, false, true, false, true},
    {"LPD", 78, UserPointKind::none, "fold and period doubling at once (fold-flip): multipliers 1 and -1",
     PointSymbol::square, false, true, false, true},
    {"PTR", 77, UserPointKind::none,
     "period doubling and torus bifurcation at once: a multiplier -1 and a complex pair on the unit circle",
     PointSymbol::triangle, false, true, false, true},
    {"PTR", 87, UserPointKind::none,
     "period doubling and torus bifurcation at once: a multiplier -1 and a complex pair on the unit circle",
     PointSymbol::triangle, false, true, false, true},
    {"TTR", 88, UserPointKind::none, "two torus bifurcations at once: two complex pairs on the unit circle",
     PointSymbol::diamond, false, true, false, true},
});

}  // namespace

std::span<const PointTypeFacts> point_types() { return table; }

std::string all_type_names() {
  std::vector<std::string_view> names;
  for (const PointTypeFacts& row : table)
    if (std::find(names.begin(), names.end(), row.name) == names.end()) names.emplace_back(row.name);
  const std::string_view last = names.back();
  names.pop_back();
  return fmt::format("{} or {}", fmt::join(names, ", "), last);
}

const PointTypeFacts* find_point_type(std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(), [=](const auto& row) { return row.name == name; });
  return found != table.end() ? found : nullptr;
}

const PointTypeFacts* find_point_type(int type, const UserPointKind& kind) {
  const auto is_whole = [type](const PointTypeFacts& row) { return row.is_whole && row.number == type; };
  if (const auto whole = std::find_if(table.begin(), table.end(), is_whole); whole != table.end()) return whole;
  const int wanted = basic_type(type);
  const bool has_kind = wanted == static_cast<int>(PointType::user);
  const auto fits = [&](const PointTypeFacts& row, int of_kind) {
    return !row.is_whole && row.number == wanted && (!has_kind || row.kind == of_kind);
  };
  for (const int of_kind : {kind.kind, static_cast<int>(UserPointKind::none)})
    for (const PointTypeFacts& row : table)
      if (fits(row, of_kind)) return &row;
  return nullptr;
}

bool is_among(const std::vector<PointType>& types, int type) {
  return std::any_of(types.begin(), types.end(), [=](PointType one) { return static_cast<int>(one) == type; });
}

int basic_type(int type) { return type % 10; }

int label_type(int type) {
  const PointTypeFacts* const found = find_point_type(type, {});
  return found != nullptr && found->is_whole ? type : basic_type(type);
}

bool is_birth_of_orbits(int type) {
  const auto birth = static_cast<PointType>(label_type(type));
  return birth == PointType::hopf || birth == PointType::generalized_hopf;
}

int curve_type(int type) {
  constexpr std::array of_orbits = {PointType::fold_and_torus, PointType::fold_and_doubling};
  const bool is_of_orbits =
      std::any_of(of_orbits.begin(), of_orbits.end(), [type](PointType one) { return static_cast<int>(one) == type; });
  return is_of_orbits ? static_cast<int>(PointType::fold) : std::abs(type) / 10;
}

std::vector<PointType> curves_through(int type) {
  const PointTypeFacts* const found = find_point_type(type, {});
  const auto point = found != nullptr ? static_cast<PointType>(found->number) : PointType::ordinary;
  switch (point) {
    case PointType::fold:
    case PointType::period_doubling:
    case PointType::torus:
    case PointType::branch_point:
    case PointType::equilibrium_fold:
    case PointType::hopf:
      return {point};
    case PointType::fold_and_torus:
    case PointType::torus_and_fold:
    case PointType::resonance_1:
      return {PointType::fold, PointType::torus};
    case PointType::fold_and_doubling:
    case PointType::doubling_and_fold:
      return {PointType::fold, PointType::period_doubling};
    case PointType::doubling_and_torus:
    case PointType::torus_and_doubling:
    case PointType::resonance_2:
      return {PointType::period_doubling, PointType::torus};
    case PointType::bogdanov_takens:
    case PointType::zero_hopf:
      return {PointType::equilibrium_fold, PointType::hopf};
    case PointType::double_hopf:
      return {PointType::hopf};
    default:
      return {};
  }
}

int file_type(PointType type, int curve) {
  const int number = static_cast<int>(type);
  if (number == 0 || std::abs(number) >= 10) return number;
  const int on_curve = number < 0 ? number - 10 * curve : number + 10 * curve;
  const bool is_taken = std::any_of(table.begin(), table.end(),
                                    [=](const PointTypeFacts& row) { return row.is_whole && row.number == on_curve; });
  return is_taken && type != PointType::end ? file_type(PointType::end, curve) : on_curve;
}

bool is_fold(PointType type) { return type == PointType::fold || type == PointType::equilibrium_fold; }

bool is_bifurcation(PointType type) {
  const PointTypeFacts* found = find_point_type(static_cast<int>(type), {});
  return found != nullptr && found->is_bifurcation;
}

std::string type_name(int type, const UserPointKind& kind) {
  const PointTypeFacts* found = find_point_type(type, kind);
  return found != nullptr ? found->name : "";
}

bool counts_beside(int type, const UserPointKind& other) {
  const auto is_one_of = [](int number, PointType a, PointType b) {
    return number == static_cast<int>(a) || number == static_cast<int>(b);
  };
  return !(is_one_of(basic_type(type), PointType::branch_point, PointType::equilibrium_branch_point) &&
           other.kind == UserPointKind::other_type &&
           is_one_of(other.index, PointType::fold, PointType::equilibrium_fold));
}

std::vector<std::string> type_names(int type, const UserPointKind& kind, const std::vector<UserPointKind>& further) {
  constexpr int user = static_cast<int>(PointType::user);
  std::vector<std::string> names{type_name(type, kind)};
  for (const UserPointKind& other : further) {
    if (!counts_beside(type, other)) continue;
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
    case UserPointKind::extremum:
      return "extremum of ICP(1)";
    case UserPointKind::rule:
      return fmt::format("the rules of the model change at the end of segment {}, event function {}", kind.segment,
                         kind.index);
    case UserPointKind::chatter:
      return fmt::format("chatter becomes incomplete, segment {}, event function {}", kind.segment, kind.index);
    case UserPointKind::other_type:
      return type_name(kind.index);
    default:
      return "";
  }
}

namespace {

constexpr std::string_view beginning = "normal form ", equals = " = ", plus_minus = " +- ", comma = ", ";

/// Removes the text up to and including `end`, and returns what precedes `end`; nothing if `end` is absent.
std::optional<std::string_view> take_until(std::string_view& text, std::string_view end) {
  const std::size_t at = text.find(end);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(at + end.size());
  return part;
}

}  // namespace

std::string format_normal_form(const NormalFormNote& note, std::string_view explanation) {
  std::string text =
      fmt::format("{}{}{}{:.10g}{}{:.1g}", beginning, note.name, equals, note.value, plus_minus, note.uncertainty);
  if (!note.verdict.empty()) text += fmt::format("{}{}{}", comma, note.verdict, explanation);
  return text;
}

std::optional<NormalFormNote> parse_normal_form(std::string_view line) {
  if (!take_until(line, beginning)) return std::nullopt;
  const auto name = take_until(line, equals);
  const auto value = take_until(line, plus_minus);
  if (!name || !value) return std::nullopt;
  const auto known_to = line.substr(0, std::min(line.find_first_of(",; "), line.size()));
  const auto number = parse_fortran_real(*value), uncertainty = parse_fortran_real(known_to);
  if (!number || !uncertainty) return std::nullopt;
  line.remove_prefix(known_to.size());
  NormalFormNote note{std::string(*name), *number, *uncertainty};
  if (line.starts_with(comma))
    note.verdict = line.substr(comma.size(), std::min(line.find_first_of(":;"), line.size()) - comma.size());
  return note;
}

}  // namespace tchat
