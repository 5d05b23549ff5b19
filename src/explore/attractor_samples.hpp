/// The attractors of a sweep, value by value.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "explore/orbit_catalogue.hpp"
#include "files/point_file.hpp"
#include "model/hybrid_system.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

/// What one value and start lead to.
struct SweptAttractor {
  const SweepAttractor* attractor = nullptr;
  std::size_t row = 0;
  double value = 0.0;   ///< of the parameter
  double period = 0.0;  ///< in time; NaN
};

class AttractorSamples {
 public:
  /// Of no value.
  AttractorSamples() = default;
  /// Throws UserError as read_sweep_file() does.
  AttractorSamples(const std::string& path, const HybridSystem& system)
      : table_(read_sweep_file(path)), state_names_(ProblemNames::of(system).states) {}

  const SweepTable& table() const { return table_; }
  void for_each(const std::function<void(const SweptAttractor&)>& use) const;
  /// How often a value and a start lead to each kind of motion, attractor or not.
  std::map<AttractorKind, int> kinds() const;
  /// The columns of these names, NaN for those that are missing.
  std::vector<double> values_of(const SweptAttractor& sample, const std::vector<std::string>& names) const;
  /// The first recorded state, of a period that in which its first segment ends; nothing where none is recorded.
  std::optional<Eigen::VectorXd> numbers_of(const SweptAttractor& sample) const;
  /// The words of `tchat simulate` that begin there; "" where none is recorded.
  std::string words_of(const SweptAttractor& sample) const;
  /// The words of `tchat simulate` that begin on an attractor, where it has been found first.
  static std::string words_of(const SweepAttractor& attractor);
  double value_of(const SweepAttractor& attractor) const;
  /// `count` states of low discrepancy in the least box around the starts and the recorded states, as --state takes
  /// them.
  std::vector<std::string> further_starts(int count) const;

 private:
  /// Rows of a value and start, one of them each.
  std::vector<std::size_t> first_rows() const;

  SweepTable table_;
  std::vector<std::string> state_names_;
};

SignatureWord signature_word(const SweepAttractor& attractor);

}  // namespace tchat
