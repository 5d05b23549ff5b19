/// The event functions h_j watched along one flow, looked at from one integration step to the next: does one of them
/// fall through zero, and where does one come near zero without reaching it?
///
/// Only an *armed* event can fall, one whose h has been positive. At the start: h > tolerance is armed; a start on the
/// surface (|h| within tolerance, as after an impact or on a section) that leaves upwards is armed as soon as h > 0;
/// one that leaves downwards, a start below zero, and a start just after the event, when h has risen again. The start
/// itself never counts.
///
/// h_P = h_x f tells where h is least between two looks (2.57-2.60), so that a pair of crossings inside one step is
/// found; a least value that is not below zero is a contact.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

/// x(t) inside the last integration step; valid until the next call.
using DenseOutput = std::function<const double*(double t)>;

class EventWatch {
 public:
  /// A local minimum of h that does not reach zero.
  struct Contact {
    int event = 0;
    double time = 0.0;
    double h = 0.0;
    Eigen::VectorXd state;
  };
  struct Fall {
    int event = 0;
    double time = 0.0;
  };

  /// A view of `system` and `par`, which outlive this object. `tolerance` on |h| / (1 + |h_x| |x|) says what is on the
  /// surface at the start x0 (time 0); of the events `after`, which have just happened, the start is on the surface
  /// whatever h.
  EventWatch(const HybridSystem& system, int field, const std::vector<int>& events, const Eigen::VectorXd& par,
             const double* x0, double tolerance, const std::vector<int>& after = {});

  int count() const { return static_cast<int>(events_.size()); }
  /// h_j and then h_x f of every event: 2 count() values, falling and rising through zero at what is looked for. False
  /// when an h cannot be evaluated.
  bool roots(const double* x, double* out) const;

  /// Looks at the flow from the time last looked at to `time`; the first fall, if there is one, is where the next look
  /// begins. `is_root`, if not null, tells which of roots() the integrator has located at `time`.
  std::optional<Fall> look(double time, const DenseOutput& state, const int* is_root);

  /// Contacts seen since the last call.
  std::vector<Contact> take_contacts();
  bool is_armed(int event) const;
  /// h_j, and its rate h_x f: 0 where it cannot be evaluated.
  double value(int event, const double* x) const { return system_.event(event, x, par_.data()); }
  double rate(int event, const double* x) const;

 private:
  /// h_j, its rate h_x f (0 where it cannot be evaluated), and what rounding of the state makes of h.
  struct Value {
    double h = 0.0, rate = 0.0, scale = 1.0;
  };
  void set_field(const double* x) const;
  Value on_field(int event, const double* x) const;  // the field has been set
  Value at(int event, const double* x) const;

  enum class Readiness { below, leaving_upwards, armed };
  struct Watched {
    int event;
    Readiness readiness;
    double h, rate;    // at the time last looked at
    double tolerance;  // |h| / (1 + |h_x| |x|) up to this has not risen
  };

  /// When this event falls in (time_, end], where its h and rate are now those given; updates its readiness.
  std::optional<double> fall(Watched& watched, double end, double h, double rate, bool is_minimum,
                             const DenseOutput& state);
  void look_again_from(double time, const DenseOutput& state);

  const HybridSystem& system_;
  int field_;
  const Eigen::VectorXd& par_;
  double time_ = 0.0;
  std::vector<Watched> events_;
  // What is looked at at every step is kept here.
  std::vector<Watched> before_;
  std::vector<double> now_;
  mutable Eigen::VectorXd f_;
  mutable Eigen::RowVectorXd h_x_;
  std::vector<Contact> contacts_;
};

}  // namespace tchat
