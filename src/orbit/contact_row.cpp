#include "orbit/contact_row.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

/// Of the period. A shorter contact takes the mean of h_x f as that of both ends, wrong by T^2 / 12 times its second
/// derivative; in a longer one rounding of h is divided by T. Both are some 1e-10 of h_x f here.
constexpr double short_contact = 3e-6;

bool is_short(const Orbit& x, int s) { return std::abs(x.duration(s)) <= short_contact * std::abs(x.period()); }

}  // namespace

ContactRow::ContactRow(int dimension, int free_count) : start_(dimension, free_count), end_(dimension, free_count) {}

double ContactRow::value(const HybridSystem& system, const IndexVector& v, const Orbit& x, int s,
                         const std::vector<int>& free_parameters) {
  const double* par = x.par.data();
  if (!is_short(x, s))
    return (system.event(v.event, x.end(s), par) - system.event(v.event, x.start(s), par)) / x.duration(s);
  start_.evaluate(system, v, x.start(s), par, free_parameters);
  end_.evaluate(system, v, x.end(s), par, free_parameters);
  return 0.5 * (start_.rate + end_.rate);
}

double* ContactRow::derivatives(const HybridSystem& system, const IndexVector& v, const Orbit& x, int s,
                                const std::vector<int>& free_parameters, double& value, double* entries) {
  const double* par = x.par.data();
  const auto put = [&entries](double first, const Eigen::VectorXd& a, double second, const Eigen::VectorXd& b) {
    for (Eigen::Index k = 0; k < a.size(); ++k) *entries++ = first * a(k) + second * b(k);
  };
  const auto put_one = [&](double factor, const Eigen::VectorXd& a) { put(factor, a, 0.0, a); };
  if (is_short(x, s)) {
    start_.evaluate(system, v, x.start(s), par, free_parameters);
    end_.evaluate(system, v, x.end(s), par, free_parameters);
    value = 0.5 * (start_.rate + end_.rate);
    put_one(0.5, start_.rate_x);
    put_one(0.5, end_.rate_x);
    *entries++ = 0.0;
    put(0.5, start_.rate_p, 0.5, end_.rate_p);
    return entries;
  }
  const auto evaluate = [&](SurfaceRate& at, const double* state) {
    system.first(FunctionKind::event, v.event, state, par, free_parameters, &at.h, at.hx.data(), at.hp.data());
  };
  evaluate(start_, x.start(s));
  evaluate(end_, x.end(s));
  const double inverse = 1.0 / x.duration(s);
  value = (end_.h - start_.h) * inverse;
  put_one(-inverse, start_.hx);
  put_one(inverse, end_.hx);
  *entries++ = -value * inverse;
  put(-inverse, start_.hp, inverse, end_.hp);
  return entries;
}

}  // namespace tchat
