#include "maps/suspended_system.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// The base's derivatives by x and by (parameters that are states, active ones) as the first rows of those of the
/// suspended system, which are `own`; the others are zero. dp may be null.
void spread(const MatrixXd& by_state, const MatrixXd& by_parameter, int states, int own, double* dz, double* dp) {
  const Eigen::Index rows = by_state.rows(), n = by_state.cols(), active = by_parameter.cols() - states;
  Eigen::Map<MatrixXd> dz_all(dz, own, n + states);
  dz_all.setZero();
  dz_all.topLeftCorner(rows, n) = by_state;
  dz_all.topRightCorner(rows, states) = by_parameter.leftCols(states);
  if (dp == nullptr) return;
  Eigen::Map<MatrixXd> dp_all(dp, own, active);
  dp_all.setZero();
  dp_all.topRows(rows) = by_parameter.rightCols(active);
}

}  // namespace

/// A point of the suspended system as the base sees it, and the parameters by which derivatives are wanted: those that
/// are states first, then the active ones.
struct SuspendedSystem::At {
  const double* x;
  VectorXd par;
  std::vector<int> active;

  At(const SuspendedSystem& self, const double* z, const double* par_given, const int* more, int more_count)
      : x(z), par(Eigen::Map<const VectorXd>(par_given, self.base_.layout().room())), active(self.along_) {
    const int n = self.base_.dimension();
    for (std::size_t k = 0; k < self.along_.size(); ++k) par(self.along_[k] - 1) = z[n + static_cast<int>(k)];
    active.insert(active.end(), more, more + more_count);
  }
};

SuspendedSystem::SuspendedSystem(const HybridSystem& base, std::vector<int> along, int field, int wall,
                                 std::optional<SectionPlane> plane)
    : base_(base), along_(std::move(along)), field_(field), wall_(wall), plane_(std::move(plane)) {
  const tchat_problem& of_base = base.table();
  table_.abi_version = TCHAT_PROBLEM_ABI;
  table_.struct_size = sizeof(tchat_problem);
  table_.dimension = base.dimension() + static_cast<int>(along_.size());
  table_.parameters = base.parameters();
  table_.fields = of_base.fields;
  table_.events = of_base.events + (plane_ ? 2 : 1);
  table_.jumps = of_base.jumps;
  table_.derivative_order = 2;
  table_.name = of_base.name;
  for (int k = 1; k <= base.dimension(); ++k) names_.push_back(base.state_name(k));
  for (const int k : along_) names_.push_back(base.parameter_name(k));
  for (int j = 1; j <= of_base.events; ++j) names_.push_back(base.function_name(FunctionKind::event, j));
  names_.push_back("least " + base.function_name(FunctionKind::event, wall));
  names_.emplace_back("section");
  for (int k = 0; k < static_cast<int>(names_.size()); ++k)
    (k < table_.dimension ? state_names_ : event_names_).push_back(names_[static_cast<std::size_t>(k)].c_str());
  table_.state_names = state_names_.data();
  table_.event_names = event_names_.data();
  table_.parameter_names = of_base.parameter_names;
  table_.field_names = of_base.field_names;
  table_.jump_names = of_base.jump_names;
  table_.initial_parameters = of_base.initial_parameters;
  table_.self = this;
  table_.value = &SuspendedSystem::value;
  table_.first = &SuspendedSystem::first;
  table_.second = &SuspendedSystem::second;
  table_.successors = base.has_successors() ? &SuspendedSystem::successors : nullptr;
  system_.emplace(table_);
}

VectorXd SuspendedSystem::suspended(const VectorXd& x, const VectorXd& par) const {
  VectorXd z(x.size() + static_cast<Eigen::Index>(along_.size()));
  z.head(x.size()) = x;
  for (std::size_t k = 0; k < along_.size(); ++k) z(x.size() + static_cast<Eigen::Index>(k)) = par(along_[k] - 1);
  return z;
}

double SuspendedSystem::rate(const double* x, const double* par) const {
  VectorXd gradient(base_.dimension()), f(base_.dimension());
  double h = 0.0;
  base_.first(FunctionKind::event, wall_, x, par, {}, &h, gradient.data(), nullptr);
  base_.value(FunctionKind::field, field_, x, par, f.data());
  return gradient.dot(f);
}

void SuspendedSystem::value(const void* self_given, int kind, int index, const double* z, const double* par,
                            double* out) {
  const auto& self = *static_cast<const SuspendedSystem*>(self_given);
  const At at(self, z, par, nullptr, 0);
  const int n = self.base_.dimension();
  const auto function = static_cast<FunctionKind>(kind);
  if (function == FunctionKind::event && index == self.plane()) {
    *out = self.plane_->normal.dot(Eigen::Map<const VectorXd>(z, n) - self.plane_->at);
    return;
  }
  if (function == FunctionKind::event && index == self.least_distance()) {
    *out = -self.rate(z, at.par.data());
    return;
  }
  self.base_.value(function, index, z, at.par.data(), out);
  for (int k = 0; k < static_cast<int>(self.along_.size()) && function != FunctionKind::event; ++k)
    out[n + k] = function == FunctionKind::field ? 0.0 : z[n + k];
}

/// -h_P with the gradient -(h_xx f + h_x f_x) and its derivatives by parameters, -(h_xp f + h_x f_p).
void SuspendedSystem::first_of_rate(const At& at, double* out, double* dz, double* dp) const {
  const int n = base_.dimension();
  const auto count = static_cast<int>(at.active.size());
  double h = 0.0, along_f = 0.0;
  RowVectorXd hx(n), hp(count), curvature(n), mixed(count);
  VectorXd direction = VectorXd::Zero(n + count), f(n);
  MatrixXd fx(n, n), fp(n, count);
  base_.first(FunctionKind::event, wall_, at.x, at.par.data(), at.active, &h, hx.data(), hp.data());
  base_.first(FunctionKind::field, field_, at.x, at.par.data(), at.active, f.data(), fx.data(), fp.data());
  direction.head(n) = f;
  base_.second(FunctionKind::event, wall_, at.x, at.par.data(), at.active, direction.data(), &along_f, curvature.data(),
               mixed.data());
  *out = -hx.dot(f);
  const RowVectorXd by_state = -(curvature + hx * fx);
  const RowVectorXd by_parameter = -(mixed + hx * fp);
  const auto states = static_cast<int>(along_.size());
  std::copy_n(by_state.data(), n, dz);
  std::copy_n(by_parameter.data(), states, dz + n);
  if (dp != nullptr) std::copy_n(by_parameter.data() + states, count - states, dp);
}

void SuspendedSystem::first(const void* self_given, int kind, int index, const double* z, const double* par,
                            const int* active, int active_count, double* out, double* dz, double* dp) {
  const auto& self = *static_cast<const SuspendedSystem*>(self_given);
  const At at(self, z, par, active, active_count);
  const int n = self.base_.dimension();
  const auto states = static_cast<int>(self.along_.size());
  const auto function = static_cast<FunctionKind>(kind);
  if (function == FunctionKind::event && index == self.plane()) {
    value(self_given, kind, index, z, par, out);
    std::copy_n(self.plane_->normal.data(), n, dz);
    std::fill_n(dz + n, states, 0.0);
    if (dp != nullptr) std::fill_n(dp, active_count, 0.0);
    return;
  }
  if (function == FunctionKind::event && index == self.least_distance()) return self.first_of_rate(at, out, dz, dp);
  const int rows = self.base_.rows(function);
  MatrixXd by_state(rows, n), by_parameter(rows, static_cast<Eigen::Index>(at.active.size()));
  self.base_.first(function, index, z, at.par.data(), at.active, out, by_state.data(), by_parameter.data());
  spread(by_state, by_parameter, states, function == FunctionKind::event ? 1 : n + states, dz, dp);
  if (function == FunctionKind::event) return;
  for (int k = 0; k < states; ++k) {
    out[n + k] = function == FunctionKind::field ? 0.0 : z[n + k];
    if (function == FunctionKind::jump) dz[(n + k) * (n + states) + n + k] = 1.0;
  }
}

void SuspendedSystem::second(const void* self_given, int kind, int index, const double* z, const double* par,
                             const int* active, int active_count, const double* direction, double* out, double* dz,
                             double* dp) {
  const auto& self = *static_cast<const SuspendedSystem*>(self_given);
  const int n = self.base_.dimension();
  const auto states = static_cast<int>(self.along_.size());
  const auto function = static_cast<FunctionKind>(kind);
  if (function == FunctionKind::event && index > self.base_.count(FunctionKind::event)) {
    // Third derivatives of h_D would be needed: those of the first derivatives by differences.
    return difference_second(*self.system_, function, index, z, par, {active, static_cast<std::size_t>(active_count)},
                             direction, out, dz, dp);
  }
  const At at(self, z, par, active, active_count);
  const int rows = self.base_.rows(function);
  MatrixXd by_state(rows, n), by_parameter(rows, static_cast<Eigen::Index>(at.active.size()));
  // (v, q's part of v, w) is already in the base's order: states, parameters that are states, active ones.
  self.base_.second(function, index, z, at.par.data(), at.active, direction, out, by_state.data(), by_parameter.data());
  spread(by_state, by_parameter, states, function == FunctionKind::event ? 1 : n + states, dz, dp);
  for (int k = 0; k < states && function != FunctionKind::event; ++k)
    out[n + k] = function == FunctionKind::field ? 0.0 : direction[n + k];
}

int SuspendedSystem::successors(const void* self_given, const int from[3], const double* z, const double* par, int* to,
                                int capacity) {
  const auto& self = *static_cast<const SuspendedSystem*>(self_given);
  const At at(self, z, par, nullptr, 0);
  const auto following = self.base_.successors({from[0], from[1], from[2]}, z, at.par.data());
  if (!following) return -1;
  int count = 0;
  for (const IndexVector& index : *following) {
    if (index.event == self.wall_) continue;
    if (count < capacity) {
      to[3 * count] = index.field;
      to[3 * count + 1] = index.event;
      to[3 * count + 2] = index.jump;
    }
    ++count;
  }
  return count;
}

}  // namespace tchat
