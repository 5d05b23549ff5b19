#include "orbit/defining_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "model/events.hpp"
#include "model/function_values.hpp"

namespace tchat {

DefiningSystem::DefiningSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters)
    : system_(system), signature_(std::move(signature)), free_parameters_(std::move(free_parameters)) {
  for (int s = 0; s < segments(); ++s) contact_segments_.push_back(tchat::is_contact_segment(system_, signature_, s));
}

void DefiningSystem::section_gradient(int s, const double* x, const double* par, double* gradient) const {
  double h = 0.0;
  if (!has_event(s))
    std::fill_n(gradient, dimension(), 0.0);
  else
    system_.first(FunctionKind::event, signature_[static_cast<std::size_t>(s)].event, x, par, {}, &h, gradient,
                  nullptr);
}

namespace {

bool is_finite_at(const DefiningSystem& defining, FunctionKind kind, int index, const double* x, const double* par) {
  const int n = defining.dimension();
  const int rows = defining.system().rows(kind);
  const int free = defining.free_count();
  std::vector<double> value(static_cast<std::size_t>(rows));
  std::vector<double> by_state(static_cast<std::size_t>(rows * n));
  std::vector<double> by_parameter(static_cast<std::size_t>(rows * free) + 1);
  defining.system().first(kind, index, x, par, defining.free_parameters(), value.data(), by_state.data(),
                          by_parameter.data());
  return all_finite(value.data(), rows) && all_finite(by_state.data(), rows * n) &&
         all_finite(by_parameter.data(), rows * free);
}

/// Why Filippov's field is not finite where both of its fields are.
std::string two_fold(const HybridSystem& system, FunctionKind kind, int index) {
  const tchat_sliding* const mode = kind == FunctionKind::field ? system.sliding_mode(index) : nullptr;
  if (mode == nullptr) return "";
  return fmt::format(
      "; it slides on event {} ({}), and its field has no value where h_x f of the fields {} and {} is "
      "the same, as at a two-fold, where both are tangent",
      mode->surface, system.function_name(FunctionKind::event, mode->surface), mode->minus, mode->plus);
}

/// Why a function that chatter makes of impacts is not.
std::string no_limit(const HybridSystem& system, FunctionKind kind, int index) {
  const bool is_of_contact = kind == FunctionKind::jump && system.chatter_with_limit(index) == nullptr;
  if (is_of_contact || !system.is_made_by_chatter(kind, index)) return "";
  return "; tchat makes it of the impacts, which accumulate where their restitution is between 0 and 1";
}

std::string place(const HybridSystem& system, FunctionKind kind, int index, int s, double tau, const double* x) {
  const char* kinds[] = {"vector field", "event function", "jump function", "integrand"};
  return fmt::format("{} {} ({}) or a derivative of it is not finite on segment {} at tau = {:.6g}, {}{}{}",
                     kinds[static_cast<int>(kind)], index, system.function_name(kind, index), s + 1, tau,
                     named_state(system, x), two_fold(system, kind, index), no_limit(system, kind, index));
}

}  // namespace

std::string function_failure(const DefiningSystem& defining, FunctionKind kind, int index, int s, double tau,
                             const double* x, const double* par) {
  return is_finite_at(defining, kind, index, x, par) ? "" : place(defining.system(), kind, index, s, tau, x);
}

std::string evaluation_failure(const DefiningSystem& defining, const CollocationRule& rule, const Orbit& x) {
  const double* par = x.par.data();
  const int c = x.shape.collocation;
  std::vector<int> rising(static_cast<std::size_t>(c));  // the Gauss points in the order of time
  std::iota(rising.begin(), rising.end(), 0);
  std::sort(rising.begin(), rising.end(), [&](int a, int b) { return rule.gauss(a) < rule.gauss(b); });
  for (int s = 0; s < x.shape.segments; ++s) {
    const IndexVector& v = defining.signature()[static_cast<std::size_t>(s)];
    for (int j = 0; j < x.shape.intervals_of(s); ++j) {
      const auto nodes = x.states.middleCols(x.shape.first_node(s) + j * c, c + 1);
      const double left = x.mesh_of(s)[j];
      const double h = x.mesh_of(s)[j + 1] - left;
      for (const int g : rising) {
        const Eigen::VectorXd point = nodes * rule.value.row(g).transpose();
        const double tau = left + h * rule.gauss(g);
        const std::string field = function_failure(defining, FunctionKind::field, v.field, s, tau, point.data(), par);
        if (!field.empty()) return field;
        const std::string integrand = defining.integral_failure(s, tau, point.data(), par);
        if (!integrand.empty()) return integrand;
      }
    }
    if (const std::string ends = defining.coupling_failure(s, x); !ends.empty()) return ends;
  }
  return "";
}

}  // namespace tchat
