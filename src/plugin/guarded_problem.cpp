#include "plugin/guarded_problem.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "plugin/plugin_call.hpp"

namespace tchat {

namespace {

const char* place_of(std::int32_t kind) {
  if (kind == TCHAT_FIELD) return "in field";
  if (kind == TCHAT_EVENT) return "in event function";
  return kind == TCHAT_JUMP ? "in jump" : "in the integrand of segment";
}

void set_nan(double* values, int count) { std::fill(values, values + count, NAN); }

/// The text of the exception that is being caught.
std::string caught_text() {
  try {
    throw;
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "no std::exception";
  }
}

}  // namespace

struct GuardedProblem::Calls {
  static const GuardedProblem& object(const void* self) { return *static_cast<const GuardedProblem*>(self); }

  /// A function of the table that is called with a kind and an index; `fail` sets what it would have computed.
  template <auto function, auto fail, class... Arguments>
  static void evaluate(const void* self, std::int32_t kind, std::int32_t index, Arguments... arguments) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), place_of(kind), index);
    try {
      (plugin.*function)(plugin.self, kind, index, arguments...);
    } catch (...) {
      fail(plugin, kind, arguments...);
    }
  }

  static void fail_value(const tchat_problem& plugin, std::int32_t kind, const double*, const double*, double* out) {
    set_nan(out, rows(plugin, kind));
  }

  static void fail_first(const tchat_problem& plugin, std::int32_t kind, const double* x, const double* par,
                         const std::int32_t* active, std::int32_t count, double* out, double* dx, double* dp) {
    fail_points(plugin, kind, 1, x, par, active, count, out, dx, dp);
  }

  static void fail_second(const tchat_problem& plugin, std::int32_t kind, const double* x, const double* par,
                          const std::int32_t* active, std::int32_t count, const double*, double* out, double* dx,
                          double* dp) {
    fail_points(plugin, kind, 1, x, par, active, count, out, dx, dp);
  }

  static void fail_third(const tchat_problem& plugin, std::int32_t kind, const double* x, const double* par,
                         double* out) {
    fail_third_at_points(plugin, kind, 1, x, par, out);
  }

  static void fail_third_at_points(const tchat_problem& plugin, std::int32_t kind, std::int32_t points, const double*,
                                   const double*, double* out) {
    set_nan(out, points * 8 * rows(plugin, kind));
  }

  static void fail_points(const tchat_problem& plugin, std::int32_t kind, std::int32_t points, const double*,
                          const double*, const std::int32_t*, std::int32_t count, double* out, double* dx, double* dp) {
    const int numbers = points * rows(plugin, kind);
    set_nan(out, numbers);
    set_nan(dx, numbers * plugin.dimension);
    if (count > 0) set_nan(dp, numbers * count);
  }

  static void fail_lanes(const tchat_problem& plugin, std::int32_t kind, std::int32_t sets, const double* x,
                         const double* par, const std::int32_t* active, std::int32_t count, double* out, double* dx,
                         double* dp) {
    fail_points(plugin, kind, sets * TCHAT_POINTS_OF_SET, x, par, active, count, out, dx, dp);
  }

  static void fail_second_at_points(const tchat_problem& plugin, std::int32_t kind, std::int32_t points,
                                    std::int32_t directions, const double*, const double*, const std::int32_t*,
                                    std::int32_t count, const double*, const double*, const double*, double* out,
                                    double* gradient) {
    set_nan(out, points * directions * rows(plugin, kind));
    set_nan(gradient, points * (plugin.dimension + count));
  }

  static std::int32_t successors(const void* self, const std::int32_t from[3], const double* x, const double* par,
                                 std::int32_t* to, std::int32_t capacity) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the index jump function (successors)");
    try {
      return plugin.successors(plugin.self, from, x, par, to, capacity);
    } catch (...) {
      return -1;
    }
  }

  static void boundary(const void* self, std::int32_t segments, const double* starts, const double* ends,
                       const double* par, double* out) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the boundary conditions");
    try {
      plugin.boundary(plugin.self, segments, starts, ends, par, out);
    } catch (...) {
      set_nan(out, plugin.boundary_conditions);
    }
  }

  static void boundary_first(const void* self, std::int32_t segments, const double* starts, const double* ends,
                             const double* par, const std::int32_t* active, std::int32_t count, double* out,
                             double* dstarts, double* dends, double* dp) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the boundary conditions");
    try {
      plugin.boundary_first(plugin.self, segments, starts, ends, par, active, count, out, dstarts, dends, dp);
    } catch (...) {
      const int rows = plugin.boundary_conditions;
      set_nan(out, rows);
      set_nan(dstarts, rows * plugin.dimension * segments);
      set_nan(dends, rows * plugin.dimension * segments);
      if (count > 0) set_nan(dp, rows * count);
    }
  }

  static void user_value(const void* self, const double* x, const double* par, double* out) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the user functions (user_value)");
    try {
      plugin.user_value(plugin.self, x, par, out);
    } catch (...) {
      set_nan(out, plugin.user_values);
      note_thrown(self, "user_value");
    }
  }

  static void output_parameters(const void* self, std::int32_t segment, const double* x, double* par) {
    const tchat_problem& plugin = object(self).plugin_;
    const PluginCall call(object(self).path_.c_str(), "in the output parameters (GCPVLS) of segment", segment);
    try {
      plugin.output_parameters(plugin.self, segment, x, par);
    } catch (...) {
      note_thrown(self, "output_parameters");
    }
  }

 private:
  static int rows(const tchat_problem& plugin, std::int32_t kind) {
    if (kind == TCHAT_EVENT) return 1;
    return kind == TCHAT_INTEGRAND ? plugin.integral_conditions : plugin.dimension;
  }

  static void note_thrown(const void* self, const char* function) {
    if (object(self).thrown_.empty()) object(self).thrown_ = std::string(function) + ": " + caught_text();
  }
};

GuardedProblem::GuardedProblem(const tchat_problem& plugin, const std::string& path)
    : plugin_(plugin), path_(path), table_(plugin) {
  table_.self = this;
  table_.value = &Calls::evaluate<&tchat_problem::value, &Calls::fail_value>;
  if (plugin.first != nullptr) table_.first = &Calls::evaluate<&tchat_problem::first, &Calls::fail_first>;
  if (plugin.second != nullptr) table_.second = &Calls::evaluate<&tchat_problem::second, &Calls::fail_second>;
  if (plugin.third != nullptr) table_.third = &Calls::evaluate<&tchat_problem::third, &Calls::fail_third>;
  if (plugin.third_at_points != nullptr)
    table_.third_at_points = &Calls::evaluate<&tchat_problem::third_at_points, &Calls::fail_third_at_points>;
  if (plugin.first_at_points != nullptr)
    table_.first_at_points = &Calls::evaluate<&tchat_problem::first_at_points, &Calls::fail_points>;
  if (plugin.first_in_lanes != nullptr)
    table_.first_in_lanes = &Calls::evaluate<&tchat_problem::first_in_lanes, &Calls::fail_lanes>;
  if (plugin.second_at_points != nullptr)
    table_.second_at_points = &Calls::evaluate<&tchat_problem::second_at_points, &Calls::fail_second_at_points>;
  if (plugin.boundary != nullptr) table_.boundary = &Calls::boundary;
  if (plugin.boundary_first != nullptr) table_.boundary_first = &Calls::boundary_first;
  if (plugin.successors != nullptr) table_.successors = &Calls::successors;
  if (plugin.user_value != nullptr) table_.user_value = &Calls::user_value;
  if (plugin.output_parameters != nullptr) table_.output_parameters = &Calls::output_parameters;
}

}  // namespace tchat
