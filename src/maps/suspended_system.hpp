/// A hybrid system with some of its parameters taken along as states that rest:
///
///     z = (x, q),   x' = f_i(x, p with q in it),   q' = 0,   jumps leave q alone,
///
/// so that what is expanded in the state is expanded in those parameters too, to the same order. Further, the surfaces
/// that local analysis needs stand among its event functions: behind those of the problem comes -h_P = -h_{D,x} f_i,
/// which falls through zero where h_D is least along the flow, and then the plane a . x = a . x*.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"

namespace tchat {

/// What falls through zero where a.x falls below a.at.
struct SectionPlane {
  Eigen::VectorXd normal;  ///< a, n
  Eigen::VectorXd at;      ///< n
};

class SuspendedSystem {
 public:
  /// A view of `base`, which outlives this object. `along` lists PAR indices from 1, each once; `field` and `wall` are
  /// i and D of h_P. Index vectors with the event `wall` do not follow any other: the flow does not see it.
  SuspendedSystem(const HybridSystem& base, std::vector<int> along, int field, int wall,
                  std::optional<SectionPlane> plane = {});
  SuspendedSystem(const SuspendedSystem&) = delete;
  SuspendedSystem& operator=(const SuspendedSystem&) = delete;
  ~SuspendedSystem() = default;

  const HybridSystem& system() const { return *system_; }
  const HybridSystem& base() const { return base_; }
  const std::vector<int>& along() const { return along_; }
  int field() const { return field_; }
  int wall() const { return wall_; }
  /// The number of -h_P among the event functions.
  int least_distance() const { return base_.count(FunctionKind::event) + 1; }
  /// The number of the plane, where there is one.
  int plane() const { return base_.count(FunctionKind::event) + 2; }

  /// (x, q) with q of `par`, and back.
  Eigen::VectorXd suspended(const Eigen::VectorXd& x, const Eigen::VectorXd& par) const;
  Eigen::VectorXd state(const Eigen::VectorXd& z) const { return z.head(base_.dimension()); }

 private:
  struct At;
  void first(FunctionKind kind, int index, const double* z, const double* par, const std::vector<int>& active,
             double* out, double* dz, double* dp) const;
  void first_of_rate(const At& at, double* out, double* dz, double* dp) const;
  double rate(const double* x, const double* par) const;

  static void value(const void* self, int kind, int index, const double* z, const double* par, double* out);
  static void first(const void* self, int kind, int index, const double* z, const double* par, const int* active,
                    int active_count, double* out, double* dz, double* dp);
  static void second(const void* self, int kind, int index, const double* z, const double* par, const int* active,
                     int active_count, const double* direction, double* out, double* dz, double* dp);
  static int successors(const void* self, const int from[3], const double* z, const double* par, int* to, int capacity);

  const HybridSystem& base_;
  std::vector<int> along_;
  int field_, wall_;
  std::optional<SectionPlane> plane_;
  std::vector<std::string> names_;
  std::vector<const char*> state_names_;
  std::vector<const char*> event_names_;
  tchat_problem table_{};
  std::optional<HybridSystem> system_;
};

}  // namespace tchat
