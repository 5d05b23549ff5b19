/// The one table that describes every constant of a constants file: keyword, meaning, limits, place in the positional
/// form, member of RunSettings. Readers, overrides, writers and the documentation derive from it.
///
/// A default is what a value-initialised RunSettings holds (`default_text` in constants_writer.hpp).
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "settings/run_settings.hpp"

namespace tchat {

/// The number of values of another constant (NICP of ICP); follows from the list and is checked where it is given.
struct ListCount {
  std::string_view list;
};
/// GCNOSEG.
struct SegmentCount {};
/// One integer of every segment; exactly one of the two pointers is set.
struct SegmentInteger {
  int SegmentSettings::*own = nullptr;
  int IndexVector::*of_index = nullptr;
  bool of_ring = false;  ///< there is none where no ring ties the segments
};
/// GCHNO: how many event functions are monitored on each segment.
struct MonitorCounts {};
/// GCHGRZIND: which ones.
struct MonitorLists {};

/// Where a constant's value lives. Its alternative also tells the shape of the value.
using ConstantMember =
    std::variant<int RunSettings::*, double RunSettings::*, bool RunSettings::*, StartLabel RunSettings::*,
                 std::string RunSettings::*, std::vector<int> RunSettings::*, std::vector<IndexedValue> RunSettings::*,
                 std::vector<UserValue> RunSettings::*, std::vector<StopRule> RunSettings::*,
                 std::vector<HeldValue> RunSettings::*, std::vector<BoundedValue> RunSettings::*,
                 std::vector<RunSettings::ParameterValue> RunSettings::*, ListCount, SegmentCount, SegmentInteger,
                 MonitorCounts, MonitorLists>;

/// Limits of one number; `choices`, if any, are the only values.
struct Limits {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool lowest_excluded = false;
  bool zero_excluded = false;
  std::vector<int> choices = {};
  bool contain(double value) const;
};

inline constexpr int extension_record = 0;      ///< a `KEY = value` line after the positional records
inline constexpr int command_line_record = -1;  ///< KEY=VALUE on the command line only

struct Constant {
  std::string_view keyword;
  std::string_view meaning;
  int record;  ///< which positional record, from 1; or one of the two above
  ConstantMember member;
  Limits limits;             ///< of the value, or of each value of a list
  std::string_view allowed;  ///< where `limits` does not say it all
  std::string_view example;  ///< a value in keyword form
  std::string_view effect;   ///< empty: does what its meaning says; otherwise why it has no effect
  Limits index_limits = {};  ///< of the indices of pairs (THL, THU, UZR)
};

/// One record of the positional form.
struct PositionalRecord {
  std::string_view layout;   ///< names of its values, written as commentary
  std::string_view example;  ///< values
};

/// All constants in the order of the positional form, then the extensions, then what only a command line may give.
std::span<const Constant> constants_table();

/// Record r of the positional form is element r - 1.
std::span<const PositionalRecord> positional_records();

/// The constants of one record, in order.
std::vector<const Constant*> constants_of_record(int record);

/// The constant with that keyword in any case; nullptr when there is none.
const Constant* find_constant(std::string_view keyword);

/// Keywords that are spelled much like `word`, best first; empty when none is near.
std::vector<std::string> near_keywords(std::string_view word);

/// True when the values of a constant are real numbers.
bool has_real_values(const Constant& constant);

/// What is allowed, in words: "an integer from 1 to 5000".
std::string allowed_text(const Constant& constant);
std::string limits_text(const Limits& limits, bool real);

}  // namespace tchat
