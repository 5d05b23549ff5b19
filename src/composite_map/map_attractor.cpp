#include "composite_map/map_attractor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "attractor/qr_accumulator.hpp"
#include "simulation/mode_rule.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Exponents that are told from zero by so many error bars, and by this much per return.
constexpr double bars = 3.0;
constexpr double least_growth = 1e-4;

/// Why iterates cannot go on; "" when they can.
std::string trouble(const IteratedMap& map, const Iterate& iterate, const VectorXd& x, const MapIteration& settings) {
  if (iterate.missed)
    return fmt::format("contact at x = {}, outside the neighbourhood of the grazing point that the discontinuity map is "
                       "applied in",
                       state_text(x));
  if (!iterate.image.allFinite())
    return fmt::format("the map has no value at x = {}: it is too far from grazing", state_text(x));
  const double distance = map.smooth().distance(iterate.image);
  if (!(distance <= settings.escape))
    return fmt::format("the iterates leave the neighbourhood of the grazing motion, for x = {}: there the map says "
                       "nothing of the flow",
                       state_text(iterate.image));
  return "";
}

class Iteration {
 public:
  Iteration(const IteratedMap& map, const VectorXd& x0, const ParameterVector& par, const MapIteration& settings)
      : map_(map), par_(par), settings_(settings), x_(x0) {}

  MapAttractor run() {
    for (long k = 0; k < settings_.transient; ++k)
      if (!step()) return found_;
    points_.clear(), penetrations_.clear(), contacts_.clear(), times_.clear();
    begun_ = true;
    for (long k = 0; k < settings_.returns; ++k)
      if (!step()) return found_;
    found_.last = x_;
    found_.period = period();
    if (found_.period > 0)
      keep_period();
    else
      keep_all();
    if (settings_.exponents > 0 || found_.period == 0) add_exponents();
    if (found_.period == 0) tell_kind();
    return found_;
  }

 private:
  bool step() {
    if (settings_.interrupted && ++steps_ % 1024 == 0 && settings_.interrupted())
      throw ComputationError("interrupted");
    const Iterate iterate = map_.step(x_, par_);
    found_.message = trouble(map_, iterate, x_, settings_);
    if (!found_.message.empty()) {
      found_.kind = AttractorKind::escape;
      found_.time = NAN;
      found_.last = x_;
      return false;
    }
    if (begun_) {
      points_.push_back(x_);
      penetrations_.push_back(iterate.penetration);
      contacts_.push_back(iterate.contact);
      times_.push_back(iterate.time);
    }
    x_ = iterate.image;
    return true;
  }

  /// The least one by which the last iterates repeat themselves, twice at least; 0: none.
  int period() const {
    const auto count = static_cast<long>(points_.size());
    const VectorXd& scale = map_.smooth().extent();
    // A motion that does not repeat itself covers a range; one that does may lie in a point: then the extents decide.
    VectorXd low = points_.back(), high = points_.back();
    for (const VectorXd& x : points_) low = low.cwiseMin(x), high = high.cwiseMax(x);
    const VectorXd range = (high - low).cwiseMin(scale).cwiseMax(1e-3 * scale);
    for (long p = 1; p <= settings_.max_period && 3 * p <= count; ++p) {
      bool repeats = true;
      for (long k = 0; repeats && k < 2 * p; ++k) {
        const auto later = static_cast<std::size_t>(count - 1 - k);
        const auto earlier = later - static_cast<std::size_t>(p);
        const VectorXd d = map_.smooth().difference(points_[later], points_[earlier]);
        repeats = contacts_[later] == contacts_[earlier] &&
                  d.cwiseQuotient(range).cwiseAbs().maxCoeff() <= settings_.recognition;
      }
      if (repeats) return static_cast<int>(p);
    }
    return 0;
  }

  void keep(std::size_t from) {
    const auto count = static_cast<Index>(points_.size() - from);
    found_.points.resize(x_.size(), count);
    found_.penetrations.resize(count);
    for (Index k = 0; k < count; ++k) {
      const std::size_t i = from + static_cast<std::size_t>(k);
      found_.points.col(k) = points_[i];
      found_.penetrations(k) = penetrations_[i];
    }
    found_.contacts.assign(contacts_.begin() + static_cast<std::ptrdiff_t>(from), contacts_.end());
  }

  void keep_period() {
    const std::size_t from = points_.size() - static_cast<std::size_t>(found_.period);
    keep(from);
    found_.kind = AttractorKind::periodic;
    found_.time = 0.0;
    for (std::size_t i = from; i < times_.size(); ++i) found_.time += times_[i];
  }

  void keep_all() {
    keep(0);
    found_.time = NAN;
  }

  void add_exponents() {
    const Index wanted = settings_.exponents > 0 ? settings_.exponents : 1;
    QrAccumulator accumulator(map_.coordinates(), std::min(wanted, map_.exponents()));
    for (std::size_t k = 0; k < points_.size(); ++k)
      accumulator.pass(map_.tangent(points_[k], par_), times_[k]);
    found_.spectrum = accumulator.spectrum();
  }

  void tell_kind() {
    const double mean_time = found_.spectrum->time / static_cast<double>(points_.size());
    const double largest = found_.spectrum->exponents(0);
    const double bar = std::max(bars * found_.spectrum->errors(0), least_growth / mean_time);
    if (largest > bar)
      found_.kind = AttractorKind::chaotic;
    else if (largest >= -bar)
      found_.kind = AttractorKind::quasi_periodic;
    else
      found_.message = fmt::format("the iterates approach a periodic orbit that is longer than {} returns, or slowly: more "
                                   "of them, or a longer transient, may tell",
                                   settings_.max_period);
  }

  const IteratedMap& map_;
  const ParameterVector& par_;
  const MapIteration& settings_;
  VectorXd x_;
  long steps_ = 0;
  bool begun_ = false;
  MapAttractor found_;
  std::vector<VectorXd> points_;
  std::vector<double> penetrations_, times_;
  std::vector<bool> contacts_;
};

}  // namespace

MapAttractor iterate_to_attractor(const IteratedMap& map, const VectorXd& x0, const ParameterVector& par,
                                  const MapIteration& settings) {
  return Iteration(map, x0, par, settings).run();
}

}  // namespace tchat
