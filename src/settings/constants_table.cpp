#include "settings/constants_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "base/levels.hpp"
#include "base/words.hpp"
#include "model/hybrid_system.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

using R = RunSettings;

Limits range(double lowest, double highest) { return {lowest, highest}; }
Limits at_least(double lowest) { return {lowest}; }
Limits positive() { return {.lowest = 0.0, .lowest_excluded = true}; }
Limits above_rounding() { return at_least(level::rounding_of_sums); }  // as corrections of Newton's method are
Limits nonzero() { return {.zero_excluded = true}; }
Limits one_of(std::vector<int> choices) { return {.choices = std::move(choices)}; }
Limits any() { return {}; }

constexpr double largest_weight = 1e60;                    // of a state in units of 1e-30
constexpr double last_parameter = first_name + max_names;  // names stand there
constexpr double max_list = 100000;                        // length of lists that nothing else bounds
constexpr std::string_view kept = "read and kept, no effect";
std::vector<int> with_zero(std::vector<int> choices) {
  choices.push_back(0);
  return choices;
}

std::vector<Constant> make_table() {
  static const std::string families = problem_families();
  static const std::string types = all_type_names();
  static const std::string label =
      fmt::format("a label number >= 0, or a type with a count (PD1: {}, and a number)", types);
  static const std::string type_with_count = fmt::format("a type with a count ({}) and a number", types);
  const SegmentInteger segment_type{&SegmentSettings::type, nullptr};
  const SegmentInteger field{nullptr, &IndexVector::field};
  const SegmentInteger event{nullptr, &IndexVector::event, true};
  const SegmentInteger jump{nullptr, &IndexVector::jump, true};
  return {
      {"NDIM", "number of states of one segment", 1, &R::dimension, range(1, most_states), "", "5", ""},
      {"IPS", "problem type", 1, &R::problem_type, one_of(problem_type_numbers()), families, "180", ""},
      {"IRS", "label to start from, 0: from data", 1, &R::start, at_least(0), label, "PD1", ""},
      {"ILP", "detect folds; negative: and stop there", 1, &R::detect_folds, range(-1, 1), "", "1", ""},
      {"NICP", "number of free parameters listed", 2, ListCount{"ICP"}, range(1, max_segments), "", "3", ""},
      {"ICP", "free parameters, durations included", 2, &R::free_parameters, range(1, last_parameter),
       "PAR indices: 1 to 60 of the problem (or its names), 61, 62, ... the durations of the segments (behind more "
       "than 60 parameters they follow these); names of monitors",
       "[1, 61, 62]", ""},
      {"NTST", "number of mesh intervals of each segment", 3, &R::mesh_intervals, range(1, 5000), "", "50", ""},
      {"NCOL", "number of collocation points of each mesh interval", 3, &R::collocation_points, range(2, 7), "", "4",
       ""},
      {"IAD", "points between mesh adaptations, 0: fixed mesh", 3, &R::adapt_mesh_every, at_least(0), "", "3", ""},
      {"ISP", "detection of bifurcations; negative: and stop there", 3, &R::detect_bifurcations, range(-4, 4),
       "0 (none), 1 (multipliers only), 2 (all), 3 (BP only), 4 (all but BP), or their negatives", "2", ""},
      {"ISW", "branch mode", 3, &R::branch_mode, one_of(with_zero(branch_modes())),
       "1 (normal), 2 (two-parameter curve of the point IRS), 3 (curve in three parameters: generic BP, TR of a fixed "
       "angle), 2 to 6 (extrema of a monitor, so many parameters free), -1 (switch to the branch that bifurcates at "
       "IRS); 0 means 1",
       "1", ""},
      {"IPLT", "solution measure", 3, &R::measure, any(),
       "an integer from -n to 3n; with n = NDIM, k = 1..n: 0 L2-norm, k or -k maximum or minimum, n+k integral, 2n+k "
       "L2-norm of U(k)",
       "0", ""},
      {"NBC", "number of boundary conditions", 3, &R::boundary_conditions, range(0, most_states), "", "0",
       "of IPS = 4; else read and kept, no effect: follows from the signature"},
      {"NINT", "number of integral conditions", 3, &R::integral_conditions, range(0, most_states), "", "0",
       "of IPS = 4; else read and kept, no effect: follows from the problem type"},
      {"NMX", "largest number of points", 4, &R::max_points, at_least(0), "", "100", ""},
      {"RL0", "lower bound of the first free parameter", 4, &R::parameter_min, any(), "", "0.0", ""},
      {"RL1", "upper bound of the first free parameter", 4, &R::parameter_max, any(), "", "1.0", ""},
      {"A0", "lower bound of the solution measure", 4, &R::measure_min, any(), "", "0.0", ""},
      {"A1", "upper bound of the solution measure", 4, &R::measure_max, any(), "", "100.0", ""},
      {"NPR", "label every NPR-th point, 0: none", 5, &R::print_every, at_least(0), "", "10", ""},
      {"MXBF", "number of bifurcating branches to follow", 5, &R::max_bifurcations, any(), "", "0",
       "read and kept, no effect: it concerns equilibria"},
      {"IID",
       "what the d-file says of ordinary points: 0 nothing, 1 multipliers, 2 test values too, 3 as much as of labels",
       5, &R::diagnostics_level, at_least(0), "", "2", ""},
      {"ITMX", "largest number of iterations to locate a special point", 5, &R::max_location_iterations, at_least(0),
       "", "9", ""},
      {"ITNW", "largest number of Newton and chord iterations", 5, &R::max_newton, at_least(1), "", "8", ""},
      {"NWTN", "number of full Newton iterations before chord iterations", 5, &R::full_newton, at_least(1), "", "3",
       ""},
      {"JAC", "who supplies derivatives", 5, &R::jacobian, range(-1, 1), "", "0",
       "read and kept, no effect: GCIDIFF and the problem decide"},
      {"EPSL", "relative tolerance of parameters", 6, &R::tolerance_parameters, above_rounding(), "", "1e-7", ""},
      {"EPSU", "relative tolerance of states", 6, &R::tolerance_states, above_rounding(), "", "1e-7", ""},
      {"EPSS", "relative tolerance of special points", 6, &R::tolerance_special, positive(), "", "1e-5", ""},
      {"DS", "first step along the branch, its sign is the direction", 7, &R::step, nonzero(), "", "0.01", ""},
      {"DSMIN", "smallest step", 7, &R::step_min, at_least(0), "", "0.0", ""},
      {"DSMAX", "largest step", 7, &R::step_max, at_least(0), "", "0.1", ""},
      {"IADS", "points between step size adaptations, 0: fixed step", 7, &R::adapt_step_every, at_least(0), "", "1",
       ""},
      {"NTHL", "number of parameter weights", 8, ListCount{"THL"}, range(0, max_segments), "", "0", ""},
      {"THL", "weights of parameters in the step length", 8, &R::parameter_weights, range(0, largest_weight), "",
       "{61: 0.0}", "", range(1, last_parameter)},
      {"NTHU", "number of state weights", 9, ListCount{"THU"}, range(0, most_states), "", "0", ""},
      {"THU", "weights of states in the step length and norm", 9, &R::state_weights, range(0, largest_weight), "",
       "{1: 0.5}", "", range(1, most_states)},
      {"NUZR", "number of user values", 10, ListCount{"UZR"}, range(0, max_list), "", "0", ""},
      {"UZR",
       "values of parameters to locate; index negative: and stop there",
       10,
       &R::user_values,
       any(),
       "",
       "{1: [2.5, 3.0], -2: 4.0}",
       "",
       {-last_parameter, last_parameter, false, true, {}}},
      {"GCISTART", "kind of starting data", 11, &R::grazing_start, any(), "", "0", kept},
      {"GCIDIFF", "order of the derivatives that a hand-coded problem supplies", 11, &R::derivative_order, range(0, 2),
       "", "1", ""},
      {"GCNPSI", "number of test functions", 12, ListCount{"GCIPSI"}, range(0, max_list), "", "0", ""},
      {"GCIPSI", "test functions to locate", 12, &R::test_functions, range(1, 100000), "", "[1, 2]", ""},
      {"GCNFIXED", "number of fixed quantities", 13, ListCount{"GCIFIXED"}, range(0, max_list), "", "0", kept},
      {"GCIFIXED", "fixed quantities", 13, &R::fixed, any(), "", "[]", kept},
      {"GCNOSEG", "number of segments", 14, SegmentCount{}, range(1, max_segments), "", "2", ""},
      {"GCSEGTYP", "type of each segment", 14, segment_type, one_of({0, 1, 2}),
       "0 (ends in the identity jump), 1 (ends in another jump) or 2 (ends in grazing contact)", "[1, 0]", ""},
      {"GCFIND", "vector field of each segment", 15, field, at_least(1), "", "[1, 2]", ""},
      {"GCHIND", "terminal event function of each segment", 16, event, at_least(0),
       "an integer >= 1; 0 on the one segment of an orbit without a section; none, or 0, with IPS = 4", "[1, 2]", ""},
      {"GCGIND", "jump function of each segment", 17, jump, at_least(0),
       "an integer >= 1, or 0 for the identity; none, or 0, with IPS = 4", "[1, 2]", ""},
      {"GCHNO", "number of event functions monitored on each segment", 18, MonitorCounts{}, range(0, max_list), "",
       "[1, 2]", ""},
      {"GCHGRZIND", "event functions monitored on each segment", 18, MonitorLists{}, at_least(1), "", "[[1], [2, 1]]",
       ""},
      {"GRSTOP", "end the branch at grazing", extension_record, &R::stop_at_grazing, one_of({0, 1}),
       "0 (go on) or 1 (end the branch)", "0", ""},
      {"GRJUMP", "jump function that contact would bring", extension_record, &R::grazing_jump, at_least(1), "", "1",
       ""},
      {"STOP", "end the branch at the n-th point of a type", extension_record, &R::stop_rules, any(), type_with_count,
       "[PD1, GR2]", ""},
      {"HOLD", "quantities that keep their values, one more parameter of ICP free for each", extension_record, &R::held,
       any(), "names of monitors or durations with a value, or a list of names for the values of the start",
       "{period: 36}", ""},
      {"BOUNDS", "bounds of further quantities, outside of which the branch ends", extension_record, &R::bounds, any(),
       "pairs of a parameter, duration or monitor and its least and largest value", "{T1: [0, 10], max(x): [-1, 2]}",
       ""},
      {"CONSERVED", "conserved function, such as an energy; its orbits need no free parameter", extension_record,
       &R::conserved, any(), "a user function or a state of the problem", "energy", "of IPS = 180"},
      {"CURVE", "curve to follow from a label of several, by the type of its points; empty: the label's own",
       extension_record, &R::curve, any(), "LP, PD, TR, BP, HB or BE", "TR", "of ISW = 2 and 3"},
      {"CUBIC", "locate GPD and CH on curves of PD and TR, where the cubic coefficient of the normal form is zero",
       extension_record, &R::cubic_terms, one_of({0, 1, 2}),
       "0 (no), 1 (where third derivatives are exact) or 2 (also where they are differences, which take longer)", "0",
       "of ISW = 2"},
      {"MODE",
       "which one: of the oscillations at an equilibrium, 1 is the slowest; of the branches that leave a BP or PD "
       "where "
       "several multipliers meet",
       extension_record, &R::mode, at_least(1), "", "2", "with ISW = -1, and at HH"},
      {"ICPMOVE", "let ICP(1) move where no orbit is found at its first value", extension_record, &R::start_may_move,
       one_of({0, 1}), "0 (refuse such a start) or 1 (take an orbit near it, with another value)", "1", ""},
      {"CLSTOP", "end the branch where it comes back to its first point", extension_record, &R::stop_when_closed,
       one_of({0, 1}), "0 (go on, round again) or 1 (end the branch)", "0", ""},
      {"NHARM", "harmonics that a torus begins with, 0: as the start has, or 7", extension_record, &R::harmonics,
       range(0, max_torus_segments), "", "10", "of IPS = 182 and 152"},
      {"HARMTOL", "size of the last harmonics of a torus, by which their number adapts; 0: it stays", extension_record,
       &R::harmonic_tolerance, at_least(0), "", "1e-8", "of IPS = 182 and 152"},
      {"ERRMAX",
       "error between mesh points, or of a known multiplier, beyond which NTST is doubled, or the branch ends; 0: any",
       extension_record, &R::error_bound, at_least(0), "", "1e-2", ""},
      {"OWNMESH", "give each segment a mesh of its own, of NTST intervals on average", extension_record, &R::own_meshes,
       one_of({0, 1}), "0 (one mesh in common) or 1 (own meshes)", "1", "not of tori"},
      {"PROBLEM", "problem of the run, where the command line names none", extension_record, &R::problem, any(),
       "a name or path for -p, from the folder of the constants file", "linosc", ""},
      {"PAR", "values of parameters", command_line_record, &R::parameter_values, any(),
       "a finite number for PAR(index) or PAR(name)", "{2: 0.8}", ""},
  };
}

}  // namespace

bool Limits::contain(double value) const {
  if (!std::isfinite(value)) return false;
  if (!choices.empty()) return std::find(choices.begin(), choices.end(), value) != choices.end();
  if (zero_excluded && value == 0.0) return false;
  if (lowest_excluded && value == lowest) return false;
  return value >= lowest && value <= highest;
}

std::span<const Constant> constants_table() {
  static const std::vector<Constant> table = make_table();
  return table;
}

std::span<const PositionalRecord> positional_records() {
  static constexpr std::array<PositionalRecord, 18> records{{
      {"NDIM, IPS, IRS, ILP", "5 180 1 1"},
      {"NICP, (ICP(I), I=1, NICP)", "3 1 61 62"},
      {"NTST, NCOL, IAD, ISP, ISW, IPLT, NBC, NINT", "50 4 3 2 1 0 0 0"},
      {"NMX, RL0, RL1, A0, A1", "1000 0.0 1.0 0.0 100.0"},
      {"NPR, MXBF, IID, ITMX, ITNW, NWTN, JAC", "10 0 2 9 8 3 0"},
      {"EPSL, EPSU, EPSS", "1e-7 1e-7 1e-5"},
      {"DS, DSMIN, DSMAX, IADS", "0.01 0.0 0.1 1"},
      {"NTHL, ((ITHL(I), THL(I)), I=1, NTHL)", "1, then on a line of its own 61 0.0"},
      {"NTHU, ((ITHU(I), THU(I)), I=1, NTHU)", "1, then on a line of its own 1 0.5"},
      {"NUZR, ((IUZR(I), UZR(I)), I=1, NUZR)", "1, then on a line of its own 1 2.5"},
      {"GCISTART, GCIDIFF", "0 1"},
      {"GCNPSI, (GCIPSI(I), I=1, GCNPSI)", "3 1 2 3"},
      {"GCNFIXED, (GCIFIXED(I), I=1, GCNFIXED)", "0"},
      {"GCNOSEG, (GCSEGTYP(I), I=1, GCNOSEG)", "2 1 0"},
      {"(GCFIND(I), I=1, GCNOSEG)", "1 2"},
      {"(GCHIND(I), I=1, GCNOSEG)", "1 2"},
      {"(GCGIND(I), I=1, GCNOSEG)", "1 2"},
      {"GCHNO, (GCHGRZIND(I), I=1, GCHNO), one record for each segment", "2 2 1"},
  }};
  return records;
}

std::vector<const Constant*> constants_of_record(int record) {
  std::vector<const Constant*> result;
  for (const Constant& constant : constants_table())
    if (constant.record == record) result.push_back(&constant);
  return result;
}

const Constant* find_constant(std::string_view keyword) {
  const std::string wanted = upper(keyword);
  for (const Constant& constant : constants_table())
    if (constant.keyword == wanted) return &constant;
  return nullptr;
}

std::vector<std::string> near_keywords(std::string_view word) {
  std::vector<std::string> keywords;
  for (const Constant& constant : constants_table()) keywords.emplace_back(constant.keyword);
  return near_words(word, keywords);
}

bool has_real_values(const Constant& constant) {
  const ConstantMember& m = constant.member;
  return std::holds_alternative<double R::*>(m) || std::holds_alternative<std::vector<IndexedValue> R::*>(m) ||
         std::holds_alternative<std::vector<UserValue> R::*>(m) ||
         std::holds_alternative<std::vector<HeldValue> R::*>(m) ||
         std::holds_alternative<std::vector<BoundedValue> R::*>(m) ||
         std::holds_alternative<std::vector<R::ParameterValue> R::*>(m);
}

std::string limits_text(const Limits& limits, bool real) {
  if (!limits.choices.empty()) return fmt::format("{}", fmt::join(limits.choices, ", "));
  std::string text = real ? "a finite number" : "an integer";
  if (std::isfinite(limits.lowest) && std::isfinite(limits.highest))
    text += fmt::format(" from {} to {}", limits.lowest, limits.highest);
  else if (std::isfinite(limits.lowest))
    text += fmt::format(" {} {}", limits.lowest_excluded ? ">" : ">=", limits.lowest);
  if (limits.zero_excluded) text += " other than 0";
  return text;
}

std::string allowed_text(const Constant& constant) {
  if (!constant.allowed.empty()) return std::string(constant.allowed);
  return limits_text(constant.limits, has_real_values(constant));
}

}  // namespace tchat
