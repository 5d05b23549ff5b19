/// PAR: parameters of the problem, durations of segments, and what follows them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/words.hpp"

namespace tchat {

// Which entries of PAR are the problem's parameters, which are durations of segments, and what stands behind these.

/// A larger number is an input error: memory would not suffice.
inline constexpr int most_parameters = 1'000'000;
inline constexpr int max_segments = 100'000;
/// The orbits of a torus may have as many in all, for their returns are coupled densely.
inline constexpr int max_torus_segments = 256;
inline constexpr int max_monitors = 32;
inline constexpr const char* rotation_name = "rho";

/// PAR of a problem that has P parameters. PAR(1), ..., PAR(P) are its own. The duration of segment s (s = 1..) is
/// PAR(60 + s) as long as P <= 60, so that files of small problems are numbered as TC-HAT's are; beyond that the
/// durations follow the parameters, PAR(P + s).
class ParameterLayout {
 public:
  /// Of a problem of few parameters.
  constexpr ParameterLayout() = default;
  constexpr explicit ParameterLayout(int parameters) : parameters_(parameters) {}

  /// P; problems of up to 60 parameters have the same layout, whatever P is.
  constexpr int parameters() const { return parameters_; }

  constexpr int first_duration() const { return std::max(parameters_, least_room) + 1; }
  /// PAR index of the duration of segment s (0-based).
  constexpr int duration(int s) const { return first_duration() + s; }
  /// True when PAR(k) is a duration of an orbit of `segments` segments.
  constexpr bool is_duration(int k, int segments) const {
    return k >= first_duration() && k < first_duration() + segments;
  }
  /// The segment (0-based) whose duration PAR(k) is.
  constexpr int duration_segment(int k) const { return k - first_duration(); }

  /// The rotation number of a torus (orbit/torus_system.hpp): PAR(60), which must not be a parameter of the problem;
  /// else the entry behind the durations that a torus may have. Orbits of more segments have a duration there.
  constexpr int rotation() const { return has_room_for_rotation() ? least_room : duration(max_torus_segments); }
  /// Is PAR(k) neither a duration nor behind the durations? The rotation number counts as a parameter.
  constexpr bool is_parameter(int k, int segments) const {
    return (k >= 1 && k < first_duration()) || (k == rotation() && !is_duration(k, segments));
  }

  /// Values of monitors (orbit/monitor.hpp) stand behind all this while a run lasts; no file has them as PAR.
  constexpr int first_monitor(int segments) const {
    return duration(std::max(max_torus_segments, segments)) + (has_room_for_rotation() ? 0 : 1);
  }
  /// The parameter that unfolds equations (orbit/ring_system.hpp), behind the monitors.
  constexpr int unfolding(int segments) const { return first_monitor(segments) + max_monitors; }

  /// How many entries PAR of an orbit has: no fewer than problems may rely on (TCHAT_PAR_LENGTH).
  constexpr int room(int segments = 1) const { return std::max(least_length, unfolding(segments)); }

  /// How many of these a labelled solution of a torus, or of any other kind, stores: TC-HAT's 100 at least.
  constexpr int stored(int segments, bool has_rotation) const {
    const int last = std::max(least_stored, first_duration() - 1 + segments);
    return has_rotation ? std::max(last, rotation()) : last;
  }

  /// The number of parameters where a file must record it to be understood without the problem; else 0.
  constexpr int recorded(bool has_rotation) const {
    return parameters_ > least_room || (has_rotation && !has_room_for_rotation()) ? parameters_ : 0;
  }

  /// "T2" of the second duration: what users read. Files of runs have PAR(62), as TC-HAT's do.
  std::string duration_name(int k) const { return "T" + std::to_string(duration_segment(k) + 1); }
  /// The index of "T2"; nothing for what names no duration.
  std::optional<int> duration_of_name(std::string_view name) const {
    if (name.size() < 2 || name.size() > 7 || name.front() != 'T') return std::nullopt;
    const std::optional<int> segment = parse_integer(name.substr(1));
    if (!segment || *segment < 1 || *segment > max_segments) return std::nullopt;
    return duration(*segment - 1);
  }

 private:
  static constexpr int least_room = 60;
  static constexpr int least_length = 512;
  static constexpr int least_stored = 100;
  constexpr bool has_room_for_rotation() const { return parameters_ < least_room; }

  int parameters_ = 0;
};

// PAR: the problem's parameters and the segment durations in one vector, as users and files number them.

/// PAR(k) is par(k - 1); unused ones are zero. The vector of an orbit has room for its durations and for monitors, any
/// other one has the room of an orbit of one segment. The vector knows which of its entries are durations.
class ParameterVector : public Eigen::VectorXd {
 public:
  /// No entries.
  ParameterVector() = default;
  /// Zeros, with room for an orbit of `segments` segments.
  explicit ParameterVector(const ParameterLayout& layout, int segments = 1)
      : Eigen::VectorXd(Eigen::VectorXd::Zero(layout.room(segments))), layout_(layout) {}
  /// These values.
  ParameterVector(const ParameterLayout& layout, Eigen::VectorXd values)
      : Eigen::VectorXd(std::move(values)), layout_(layout) {}
  /// New values of the same layout.
  template <class Values>
  ParameterVector& operator=(const Eigen::MatrixBase<Values>& values) {
    Eigen::VectorXd::operator=(values);
    return *this;
  }

  const ParameterLayout& layout() const { return layout_; }

  double duration(int s) const { return (*this)(layout_.duration(s) - 1); }
  double& duration(int s) { return (*this)(layout_.duration(s) - 1); }
  /// The durations of `count` segments from segment s on.
  auto durations(int count, int s = 0) { return segment(layout_.duration(s) - 1, count); }
  auto durations(int count, int s = 0) const { return segment(layout_.duration(s) - 1, count); }
  /// Sets durations and what is behind them to zero.
  void clear_durations() { tail(size() - layout_.first_duration() + 1).setZero(); }

  double rotation() const { return (*this)(layout_.rotation() - 1); }
  double& rotation() { return (*this)(layout_.rotation() - 1); }

  /// Resizes the vector for an orbit of `segments` segments; new entries are zero.
  void make_room(int segments) {
    const Eigen::Index before = size();
    if (before == layout_.room(segments)) return;
    conservativeResize(layout_.room(segments));
    if (size() > before) tail(size() - before).setZero();
  }

 private:
  ParameterLayout layout_;
};

}  // namespace tchat
