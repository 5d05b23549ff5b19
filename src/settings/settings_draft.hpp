/// Settings in the making: constants are assigned one after the other, each checked by itself; what ties several of
/// them together (list lengths, the segments' lists) is settled by `finish`.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "settings/constant_value.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// Accepted without effect, or probably not what was meant: complete sentences for the user.
using Warnings = std::vector<std::string>;

class SettingsDraft {
 public:
  /// `source` names the text that the constants come from ("gc.mems", "command line").
  SettingsDraft(RunSettings base, std::string source);

  /// Gives a constant a new value (a list is replaced as a whole). Throws UserError when the value by itself is wrong.
  void assign(const Constant& constant, const RawValue& value);

  /// Positional form: the k-th value of GCHNO, GCHGRZIND, one segment after the other.
  void add_monitored(const Constant& constant, const RawValue& list);

  /// PAR(name) = value; `name` is an index or a name of the problem.
  void assign_parameter(const Constant& constant, const Token& name, const RawValue& value);

  /// The number that a count has been given (NICP ...), for readers that need it to go on.
  int count(const Constant& constant) const { return counts_.at(constant.keyword); }
  /// Number of segments given so far (GCNOSEG).
  int segments() const { return segment_count_.value_or(1); }

  /// Has a value been assigned to the constant?
  bool is_given(std::string_view keyword) const { return places_.count(keyword) > 0; }

  /// Settles the segments and all counts and checks the whole. Throws UserError.
  RunSettings finish(Warnings* warnings);

 private:
  struct Assigner;
  using Lists = std::vector<std::vector<int>>;

  Place place_of(std::string_view keyword) const;
  int settle_segment_count() const;
  void check_lengths_agree() const;
  void settle_segments();
  int missing_value(const SegmentInteger& member) const;
  void settle_segment_integers(const Constant& constant, const SegmentInteger& member);
  void settle_monitors();
  Lists monitors_of_segments(const Constant& constant) const;
  void check_count(const Constant& constant, std::size_t actual) const;
  void check_counts() const;
  void note_indices();

  Token index_token(const Constant& constant, const std::string& shown, const Token& token);

  RunSettings settings_;
  std::string source_;
  std::map<std::string_view, Place> places_;            // of what has been assigned, by keyword
  std::map<std::string_view, int> counts_;              // NICP, ...
  std::map<std::string_view, std::vector<int>> lists_;  // GCSEGTYP, GCFIND, ..., GCHNO, as given
  std::optional<int> segment_count_;                    // GCNOSEG
  std::optional<Lists> monitors_;                       // GCHGRZIND, one list per segment
  std::vector<int> flat_monitors_;                      // GCHGRZIND as one list, to be cut by GCHNO
};

}  // namespace tchat
