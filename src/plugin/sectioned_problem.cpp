#include "plugin/sectioned_problem.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tchat {

bool lacks_sections(const HybridSystem& system) {
  const bool has_index_vectors = system.count(FunctionKind::event) > 0 && system.count(FunctionKind::jump) > 0;
  return !has_index_vectors && !system.has_modes() && system.count(FunctionKind::field) == 1 &&
         system.boundary_conditions() == 0;
}

struct SectionedProblem::Calls {
  static const SectionedProblem& object(const void* self) { return *static_cast<const SectionedProblem*>(self); }
  static bool is_section(const SectionedProblem& own, int kind, int index) {
    return kind == TCHAT_EVENT && index > own.plain_.events;
  }
  static bool is_identity(const SectionedProblem& own, int kind, int index) {
    return kind == TCHAT_JUMP && index > own.plain_.jumps;
  }

  static void value(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    double* out) {
    const SectionedProblem& own = object(self);
    const tchat_problem& plain = own.plain_;
    if (is_identity(own, kind, index)) {
      std::copy_n(x, plain.dimension, out);
      return;
    }
    if (!is_section(own, kind, index)) return plain.value(plain.self, kind, index, x, par, out);
    std::vector<double> f(static_cast<std::size_t>(plain.dimension));
    plain.value(plain.self, TCHAT_FIELD, 1, x, par, f.data());
    *out = f.front();
  }

  static void first(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    const std::int32_t* active, std::int32_t count, double* out, double* dx, double* dp) {
    const SectionedProblem& own = object(self);
    const tchat_problem& plain = own.plain_;
    const int n = plain.dimension;
    if (is_identity(own, kind, index)) {
      std::copy_n(x, n, out);
      std::fill_n(dx, n * n, 0.0);
      for (int i = 0; i < n; ++i) dx[i * (n + 1)] = 1.0;
      std::fill_n(dp, n * count, 0.0);
      return;
    }
    if (!is_section(own, kind, index)) return plain.first(plain.self, kind, index, x, par, active, count, out, dx, dp);
    std::vector<double> f(static_cast<std::size_t>(n)), fx(static_cast<std::size_t>(n * n)),
        fp(static_cast<std::size_t>(n * count));
    plain.first(plain.self, TCHAT_FIELD, 1, x, par, active, count, f.data(), fx.data(), fp.data());
    *out = f.front();
    for (int i = 0; i < n; ++i) dx[i] = fx[static_cast<std::size_t>(i * n)];
    for (int k = 0; k < count; ++k) dp[k] = fp[static_cast<std::size_t>(k * n)];
  }

  static std::int32_t successors(const void* self, const std::int32_t*, const double*, const double*, std::int32_t* to,
                                 std::int32_t capacity) {
    if (capacity < 1) return 0;
    const tchat_problem& table = object(self).table_;
    to[0] = 1, to[1] = table.events, to[2] = table.jumps;
    return 1;
  }
};

SectionedProblem::SectionedProblem(const tchat_problem& plain) : plain_(plain), table_(plain) {
  const HybridSystem system(plain);
  for (int j = 1; j <= plain.events; ++j) names_.push_back(system.function_name(FunctionKind::event, j));
  names_.push_back("maximum of " + system.state_name(1));
  for (int k = 1; k <= plain.jumps; ++k) names_.push_back(system.function_name(FunctionKind::jump, k));
  names_.emplace_back("identity");
  for (const std::string& name : names_)
    (std::ssize(event_names_) <= plain.events ? event_names_ : jump_names_).push_back(name.c_str());
  table_.events = plain.events + 1;
  table_.jumps = plain.jumps + 1;
  table_.event_names = event_names_.data();
  table_.jump_names = jump_names_.data();
  table_.derivative_order = std::min(plain.derivative_order, 1);
  table_.self = this;
  table_.value = &Calls::value;
  table_.first = plain.derivative_order >= 1 ? &Calls::first : nullptr;
  table_.second = nullptr;
  table_.third = nullptr;
  table_.third_at_points = nullptr;
  table_.successors = &Calls::successors;
  table_.user_values = 0;
  table_.output_parameters = nullptr;
  table_.integral_conditions = 0;
  table_.first_at_points = nullptr;
  table_.second_at_points = nullptr;
  table_.first_in_lanes = nullptr;
}

}  // namespace tchat
