#include "simulation/event_watch.hpp"
#include "hybrid/event_at.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tchat {

namespace {

using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Between a and b, where `is_before` holds at first and not any more at the end: the end of the part where it holds.
double last_change(double a, double b, const std::function<bool(double)>& is_before) {
  for (int halving = 0; halving < 60 && a < b; ++halving) {
    const double middle = 0.5 * (a + b);
    (is_before(middle) ? a : b) = middle;
  }
  return b;
}

struct Rate {
  double h = 0.0, rate = 0.0, scale = 1.0;

  Rate(const HybridSystem& system, int field, int event, const double* x, const VectorXd& par) {
    const EventAt at = event_at(system, event, field, x, par.data());
    h = at.h;
    rate = std::isfinite(at.rate()) ? at.rate() : 0.0;
    scale = at.scale(x);
  }
};

}  // namespace

EventWatch::EventWatch(const HybridSystem& system, int field, const std::vector<int>& events, const VectorXd& par,
                       const double* x0, double tolerance)
    : system_(system), field_(field), par_(par), tolerance_(tolerance) {
  for (const int event : events) {
    const Rate start(system, field, event, x0, par);
    const bool on_surface = std::abs(start.h) <= tolerance * start.scale;
    Readiness readiness = start.h > 0.0 ? Readiness::armed : Readiness::below;
    if (on_surface) readiness = start.rate > 0.0 ? Readiness::leaving_upwards : Readiness::below;
    events_.push_back({event, readiness, start.h, start.rate});
  }
}

bool EventWatch::roots(const double* x, double* out) const {
  for (int i = 0; i < count(); ++i) {
    const Rate now(system_, field_, events_[static_cast<std::size_t>(i)].event, x, par_);
    out[i] = now.h;
    out[count() + i] = now.rate;
  }
  return all_finite(out, count());
}

double EventWatch::rate(int event, const double* x) const { return Rate(system_, field_, event, x, par_).rate; }

bool EventWatch::is_armed(int event) const {
  return std::any_of(events_.begin(), events_.end(), [&](const Watched& watched) {
    return watched.event == event && watched.readiness == Readiness::armed;
  });
}

std::vector<EventWatch::Contact> EventWatch::take_contacts() { return std::exchange(contacts_, {}); }

std::optional<double> EventWatch::fall(Watched& watched, double end, double h, double rate, bool is_minimum,
                                       const DenseOutput& state) {
  const int event = watched.event;
  const auto is_positive = [&](double t) { return value(event, state(t)) > 0.0; };
  if (watched.readiness == Readiness::armed) {
    if (h <= 0.0) return last_change(time_, end, is_positive);
    if (!is_minimum && !(watched.rate < 0.0 && rate > 0.0)) return std::nullopt;
    const auto falls = [&](double t) { return this->rate(event, state(t)) < 0.0; };
    const double least = is_minimum ? end : last_change(time_, end, falls);
    const double h_least = value(event, state(least));
    if (h_least < 0.0) return last_change(time_, least, is_positive);
    contacts_.push_back({event, least, h_least, Eigen::Map<const VectorXd>(state(least), system_.dimension())});
    return std::nullopt;
  }
  // Below zero or just leaving it: a maximum between the two times may have been above.
  if (watched.rate > 0.0 && rate < 0.0 && h <= 0.0) {
    const double top = last_change(time_, end, [&](double t) { return this->rate(event, state(t)) > 0.0; });
    const bool is_above = is_positive(top);
    if (is_above) return last_change(top, end, is_positive);
    if (watched.readiness == Readiness::leaving_upwards) return top;  // a flight as short as rounding
  }
  const double scale = Rate(system_, field_, event, state(end), par_).scale;
  const bool has_risen = watched.readiness == Readiness::leaving_upwards || rate > 0.0 || h > tolerance_ * scale;
  if (h > 0.0 && has_risen) watched.readiness = Readiness::armed;
  return std::nullopt;
}

std::optional<EventWatch::Fall> EventWatch::look(double time, const DenseOutput& state, const int* is_root) {
  const std::vector<Watched> before = events_;
  std::optional<Fall> first;
  std::vector<double> now(2 * events_.size());
  roots(state(time), now.data());
  for (std::size_t i = 0; i < events_.size(); ++i) {
    Watched& watched = events_[i];
    const bool is_fall = is_root != nullptr && is_root[i] != 0 && watched.readiness == Readiness::armed;
    const bool is_minimum = is_root != nullptr && is_root[events_.size() + i] != 0;
    const double rate = is_minimum ? std::max(now[events_.size() + i], 0.0) : now[events_.size() + i];
    const std::optional<double> at =
        is_fall && now[i] > 0.0 ? time : fall(watched, time, now[i], rate, is_minimum, state);
    if (at && (!first || *at < first->time)) first = Fall{watched.event, *at};
    watched.h = now[i];
    watched.rate = rate;
  }
  time_ = time;
  if (!first) return first;
  events_ = before;  // what came after the fall is looked at again
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
    const Rate at(system_, field_, watched.event, x.data(), par_);
    watched.h = at.h;
    watched.rate = at.rate;
  }
}

}  // namespace tchat
