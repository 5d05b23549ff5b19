#include "plugin/function_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tchat::formulas {

namespace {

using Nature = BuiltInFunction::Nature;

double heaviside(double x) { return x >= 0.0 ? 1.0 : 0.0; }
double sign_of(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }
double remainder_of(double a, double b) { return a - b * std::floor(a / b); }
double larger_of(double a, double b) { return a < b ? b : a; }
double smaller_of(double a, double b) { return b < a ? b : a; }

constexpr BuiltInFunction smooth(const char* name, double (*function)(double), const char* cpp = nullptr) {
  return {name, 1, Nature::smooth, cpp != nullptr ? cpp : name, function, nullptr};
}

const std::array<BuiltInFunction, 33> functions = {{
    smooth("sin", std::sin),
    smooth("cos", std::cos),
    smooth("tan", std::tan),
    smooth("asin", std::asin),
    smooth("acos", std::acos),
    smooth("atan", std::atan),
    smooth("sinh", std::sinh),
    smooth("cosh", std::cosh),
    smooth("tanh", std::tanh),
    smooth("asinh", std::asinh),
    smooth("acosh", std::acosh),
    smooth("atanh", std::atanh),
    smooth("exp", std::exp),
    smooth("log", std::log),
    smooth("ln", std::log, "log"),
    smooth("log10", std::log10),
    smooth("log2", std::log2),
    smooth("sqrt", std::sqrt),
    smooth("cbrt", std::cbrt),
    {"pow", 2, Nature::smooth, "pow", nullptr, std::pow},
    {"atan2", 2, Nature::smooth, "atan2", nullptr, std::atan2},
    {"hypot", 2, Nature::smooth, "hypot", nullptr, std::hypot},
    {"abs", 1, Nature::kinked, "fabs", std::fabs, nullptr},
    {"fabs", 1, Nature::kinked, "fabs", std::fabs, nullptr},
    {"max", 2, Nature::kinked, "larger<T>", nullptr, larger_of},
    {"min", 2, Nature::kinked, "smaller<T>", nullptr, smaller_of},
    {"sign", 1, Nature::stepped, "sign_of<T>", sign_of, nullptr},
    {"sgn", 1, Nature::stepped, "sign_of<T>", sign_of, nullptr},
    {"heav", 1, Nature::stepped, "heaviside<T>", heaviside, nullptr},
    {"heaviside", 1, Nature::stepped, "heaviside<T>", heaviside, nullptr},
    {"floor", 1, Nature::stepped, "floor_of<T>", std::floor, nullptr},
    {"flr", 1, Nature::stepped, "floor_of<T>", std::floor, nullptr},
    {"mod", 2, Nature::stepped, "remainder_of<T>", nullptr, remainder_of},
}};

}  // namespace

const BuiltInFunction* find_function(std::string_view name) {
  const auto found = std::find_if(functions.begin(), functions.end(),
                                  [name](const BuiltInFunction& function) { return function.name == name; });
  return found != functions.end() ? &*found : nullptr;
}

std::vector<std::string> function_names() {
  std::vector<std::string> names;
  for (const BuiltInFunction& function : functions) names.emplace_back(function.name);
  return names;
}

}  // namespace tchat::formulas
