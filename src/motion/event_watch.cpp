#include "motion/event_watch.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

namespace tchat {

namespace {

using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Between a, where f > 0, and b, where it is not: the first time after which it is not.
double last_change(double a, double b, const std::function<double(double)>& f) {
  const double f_a = f(a);
  const double f_b = f(b);
  if (f_a > 0.0 && f_b < 0.0 && std::isfinite(f_a) && std::isfinite(f_b)) {
    std::uintmax_t evaluations = 60;
    const boost::math::tools::eps_tolerance<double> tolerance(52);
    return boost::math::tools::toms748_solve(f, a, b, f_a, f_b, tolerance, evaluations).second;
  }
  for (int halving = 0; halving < 60 && a < b; ++halving) {
    const double middle = 0.5 * (a + b);
    (f(middle) > 0.0 ? a : b) = middle;
  }
  return b;
}

}  // namespace

EventWatch::EventWatch(const HybridSystem& system, int field, const std::vector<int>& events, const VectorXd& par,
                       const double* x0, double tolerance, const std::vector<int>& after)
    : system_(system), field_(field), par_(par), f_(system.dimension()), h_x_(f_.size()) {
  for (const int event : events) {
    const Value start = at(event, x0);
    const bool is_after = std::find(after.begin(), after.end(), event) != after.end();
    const double around = is_after ? std::max(tolerance, std::abs(start.h) / start.scale) : tolerance;
    const bool on_surface = std::abs(start.h) <= around * start.scale;
    Readiness readiness = start.h > 0.0 ? Readiness::armed : Readiness::below;
    if (on_surface) readiness = start.rate > 0.0 ? Readiness::leaving_upwards : Readiness::below;
    events_.push_back({event, readiness, start.h, start.rate, around});
  }
}

void EventWatch::set_field(const double* x) const {
  system_.value(FunctionKind::field, field_, x, par_.data(), f_.data());
}

EventWatch::Value EventWatch::on_field(int event, const double* x) const {
  Value value;
  system_.first(FunctionKind::event, event, x, par_.data(), {}, &value.h, h_x_.data(), nullptr);
  const double rate = h_x_.dot(f_);
  value.rate = std::isfinite(rate) ? rate : 0.0;
  value.scale = 1.0 + h_x_.norm() * Eigen::Map<const VectorXd>(x, h_x_.size()).norm();
  return value;
}

EventWatch::Value EventWatch::at(int event, const double* x) const {
  set_field(x);
  return on_field(event, x);
}

bool EventWatch::roots(const double* x, double* out) const {
  set_field(x);
  for (int i = 0; i < count(); ++i) {
    const Value now = on_field(events_[static_cast<std::size_t>(i)].event, x);
    out[i] = now.h;
    out[count() + i] = now.rate;
  }
  return all_finite(out, count());
}

double EventWatch::rate(int event, const double* x) const { return at(event, x).rate; }

bool EventWatch::is_armed(int event) const {
  return std::any_of(events_.begin(), events_.end(), [&](const Watched& watched) {
    return watched.event == event && watched.readiness == Readiness::armed;
  });
}

std::vector<EventWatch::Contact> EventWatch::take_contacts() { return std::exchange(contacts_, {}); }

std::optional<double> EventWatch::fall(Watched& watched, double end, double h, double rate, bool is_minimum,
                                       const DenseOutput& state) {
  const int event = watched.event;
  const auto h_at = [&](double t) { return value(event, state(t)); };
  if (watched.readiness == Readiness::armed) {
    if (h <= 0.0) return last_change(time_, end, h_at);
    if (!is_minimum && !(watched.rate < 0.0 && rate > 0.0)) return std::nullopt;
    const auto falls = [&](double t) { return -this->rate(event, state(t)); };
    const double least = is_minimum ? end : last_change(time_, end, falls);
    const double h_least = value(event, state(least));
    if (h_least < 0.0) return last_change(time_, least, h_at);
    contacts_.push_back({event, least, h_least, Eigen::Map<const VectorXd>(state(least), system_.dimension())});
    return std::nullopt;
  }
  // Below zero or just leaving it: a maximum between the two times may have been above.
  if (watched.rate > 0.0 && rate < 0.0 && h <= 0.0) {
    const double top = last_change(time_, end, [&](double t) { return this->rate(event, state(t)); });
    const bool is_above = h_at(top) > 0.0;
    if (is_above) return last_change(top, end, h_at);
    if (watched.readiness == Readiness::leaving_upwards) return top;  // a flight as short as rounding
  }
  const double scale = at(event, state(end)).scale;
  const bool has_risen = watched.readiness == Readiness::leaving_upwards || rate > 0.0 || h > watched.tolerance * scale;
  if (h > 0.0 && has_risen) watched.readiness = Readiness::armed;
  return std::nullopt;
}

std::optional<EventWatch::Fall> EventWatch::look(double time, const DenseOutput& state, const int* is_root) {
  before_ = events_;
  std::optional<Fall> first;
  now_.resize(2 * events_.size());
  roots(state(time), now_.data());
  for (std::size_t i = 0; i < events_.size(); ++i) {
    Watched& watched = events_[i];
    const bool is_fall = is_root != nullptr && is_root[i] != 0 && watched.readiness == Readiness::armed;
    const bool is_minimum = is_root != nullptr && is_root[events_.size() + i] != 0;
    const double rate = is_minimum ? std::max(now_[events_.size() + i], 0.0) : now_[events_.size() + i];
    const std::optional<double> at =
        is_fall && now_[i] > 0.0 ? time : fall(watched, time, now_[i], rate, is_minimum, state);
    if (at && (!first || *at < first->time)) first = Fall{watched.event, *at};
    watched.h = now_[i];
    watched.rate = rate;
  }
  time_ = time;
  if (!first) return first;
  events_ = before_;  // what came after the fall is looked at again
  look_again_from(first->time, state);
  for (Watched& watched : events_)
    if (watched.event == first->event) watched.readiness = Readiness::below;
  return first;
}

void EventWatch::look_again_from(double time, const DenseOutput& state) {
  time_ = time;
  std::erase_if(contacts_, [&](const Contact& contact) { return contact.time > time; });
  const VectorXd x = Eigen::Map<const VectorXd>(state(time), system_.dimension());
  for (Watched& watched : events_) {
    const Value now = at(watched.event, x.data());
    watched.h = now.h;
    watched.rate = now.rate;
  }
}

}  // namespace tchat
