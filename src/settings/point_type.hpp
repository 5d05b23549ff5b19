/// The types of points of a branch, and what a label reports of its normal form.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tchat {

// Names of the points of a branch: AUTO's two-letter types, and our own GR and XI which files carry as UZ.
//
// On two-parameter curves the type number has a tens digit (the curve being followed): it is dropped, the sign kept,
// but for AUTO's codimension-two codes 23, 83, 28, 78, 77, 87, 88.

/// Type numbers of AUTO (src/docs/files.md); on two-parameter curves the file adds a tens digit.
/// A new type of points on curves of one kind takes a number that has the curve's digit already, as -32 has, and ends
/// in no number of another type of these curves: readers know it by that alone.
enum class PointType {
  ordinary = 0,
  equilibrium_branch_point = 1,
  equilibrium_fold = 2,
  hopf = 3,
  regular = 4,  ///< every NPR points
  user = -4,    ///< UZ and every zero of a monitored function
  fold = 5,
  branch_point = 6,
  period_doubling = 7,
  torus = 8,
  end = 9,
  no_convergence = -9,
  bogdanov_takens = -1,    ///< on curves of folds and Hopf points of equilibria
  cusp = -2,               ///< on fold curves
  zero_hopf = -3,          ///< on curves of folds and Hopf points of equilibria
  generalized_hopf = -32,  ///< on curves of Hopf points; with its tens digit, for -2 is the cusp
  double_hopf = 33,        ///< on curves of Hopf points, with its tens digit
  resonance_1 = -5,        ///< 1:1, on fold and torus curves
  resonance_2 = -6,        ///< 1:2, on period-doubling and torus curves
  resonance_3 = -7,        ///< 1:3, on torus curves
  resonance_4 = -8,        ///< 1:4, on torus curves
  // With tens digits, the first seven as AUTO has them.
  fold_and_torus = 23,         ///< on fold curves
  fold_and_doubling = 28,      ///< on fold curves
  doubling_and_torus = 77,     ///< on curves of period doublings
  doubling_and_fold = 78,      ///< on curves of period doublings
  torus_and_fold = 83,         ///< on torus curves
  torus_and_doubling = 87,     ///< on torus curves
  two_tori = 88,               ///< on torus curves
  generalized_doubling = -71,  ///< on curves of period doublings
  doubled_fold_end = -51,      ///< the same on curves of folds of doubled orbits, which begin there
  chenciner = -81              ///< on torus curves
};

/// What a UZ label is: the last PAR entries of a q-file entry, four internal values for each kind. What vanishes with
/// the label's own function has a kind each, after the label's own.
struct UserPointKind {
  enum Kind {
    none = 0,
    user_value = 1,
    contact = 2,
    xi = 3,
    impact_velocity = 4,
    grazing_codimension_two = 5,
    other_type = 6,  ///< a point that has a type number of its own, beside the label's
    boundary_equilibrium = 7,
    extremum = 9,  ///< 8 marks meshes of segments in files
    rule = 10,     ///< by the problem's rules another segment follows
    chatter = 11   ///< impacts cease to accumulate; the last one that files may have
  };
  int kind = none;
  int segment = 0;  ///< from 1
  int index = 0;    ///< event function, n of xi_n, PAR index of a user value, or type number (other_type)
  double tau = 0.0;
  bool operator==(const UserPointKind&) const = default;
};

/// The shapes of symbols in pictures.
enum class PointSymbol { square, circle, triangle, diamond, pentagon, reversed_triangle, dot };

/// A type of points. All that depends on the type alone is in one table: constants, readers, pictures, `tchat table
/// --types` and the pages are made from it.
struct PointTypeFacts {
  const char* name;     ///< the letters, which several numbers may share
  int number;           ///< in files, without the tens digit of a curve
  int kind;             ///< UserPointKind::Kind of UZ points, else none
  const char* meaning;  ///< a sentence
  PointSymbol symbol;
  bool is_filled;
  bool is_labelled;     ///< in pictures, where the user does not say which are
  bool is_bifurcation;  ///< a multiplier or eigenvalue is on the border of stability there
  bool is_whole;        ///< the number is one of AUTO's for codimension two: its tens digit is no curve's
};

/// All types of points, in the order in which messages and pages name them.
std::span<const PointTypeFacts> point_types();
/// The letters of all, each once: "BP, LP, ... or TTR".
std::string all_type_names();
/// The first of these letters; null for others.
const PointTypeFacts* find_point_type(std::string_view name);
/// Of a number in files; null for unknown numbers. A UZ point whose kind is unknown has the row of kind none.
const PointTypeFacts* find_point_type(int type, const UserPointKind& kind);

/// Is the basic type number one of these?
bool is_among(const std::vector<PointType>& types, int type);
/// -59 -> -9, 54 -> 4.
int basic_type(int type);
/// The same; codimension-two numbers such as 28 are returned unchanged.
int label_type(int type);
/// Are orbits born at such a point, so that theirs have shrunk to an equilibrium: a Hopf bifurcation, for folds of
/// orbits a generalised one?
bool is_birth_of_orbits(int type);
/// The type of the points of the curve that a point with this number in files is on: its tens digit; 0: on none. AUTO's
/// numbers for codimension two have a 2 for folds of periodic orbits.
int curve_type(int type);
/// The types of the curves in two parameters that go through a point with this number in files, or without the tens
/// digit: its own bifurcation, or both where two meet. Empty for other points.
std::vector<PointType> curves_through(int type);
/// The number in files: with the tens digit of the curve that is followed, 0 for none. A Hopf point at the end of a
/// torus curve is an end: its own number would be that of LTR.
int file_type(PointType type, int curve);

bool is_fold(PointType type);
/// A multiplier or eigenvalue is on the border of stability there.
bool is_bifurcation(PointType type);

/// "EP", "LP", "BP", "PD", "TR", "RG", "MX", "R1", "CP", ...; of type UZ by kind: "UZ" (user value or not known),
/// "GR" (contact, impact velocity), "XI", "GC" (grazing-fold or -flip), "BE" (boundary equilibrium), "EX" (extremum).
/// "" for an ordinary point and unknown numbers.
std::string type_name(int type, const UserPointKind& kind = {});

/// Is a label of `type` also one of what vanishes there besides? Not a fold at a branch point, where a branch turns by
/// its symmetry: no curve of folds starts there.
bool counts_beside(int type, const UserPointKind& other);

/// All names of a point that is several things at once, each once, its own first: {"GR", "UZ"}.
std::vector<std::string> type_names(int type, const UserPointKind& kind, const std::vector<UserPointKind>& further);

/// What a UZ label is, in words: "contact inside segment 1, event function 2, tau = 0.5"; "" for kind none. `parameter`
/// is the name of the one whose value the user asked for, PAR(index) when empty.
std::string description(const UserPointKind& kind, const std::string& parameter = "");

// What a label says of its normal form, as a sentence and as data.
//
//     normal form NAME = VALUE +- UNCERTAINTY[, VERDICT[: or ; EXPLANATION]]

struct NormalFormNote {
  std::string name;  ///< of the coefficient: a, c, Re d, l_1
  double value = 0.0;
  double uncertainty = 0.0;
  std::string verdict = {};  ///< "supercritical", "subcritical", "transcritical", ...; "" where there is none to say

  /// Is what is born unstable, beside the stable solution that it is born from?
  bool is_subcritical() const { return verdict.starts_with("subcritical"); }
};

/// `explanation`, where there is one, begins with ':' or ';'.
std::string format_normal_form(const NormalFormNote& note, std::string_view explanation);

/// The sentence in a line that may have others before and behind it, separated by "; ". Nothing where there is none.
std::optional<NormalFormNote> parse_normal_form(std::string_view line);

}  // namespace tchat
