#include "simulate/largest_values.hpp"

#include <limits>

namespace tchat {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int looks = 4;  // in a piece, beside its start
constexpr int halvings = 40;

}  // namespace

LargestValues::LargestValues(const HybridSystem& system, const VectorXd& par)
    : system_(system),
      par_(par),
      values_(VectorXd::Constant(system.dimension(), -std::numeric_limits<double>::infinity())) {}

void LargestValues::add_piece(int field, const DenseOutput& state, double from, double to) {
  Look before = look(field, state, from);
  values_ = values_.cwiseMax(before.state);
  for (int l = 1; l <= looks; ++l) {
    Look here = look(field, state, l == looks ? to : from + (to - from) * l / looks);
    values_ = values_.cwiseMax(here.state);
    for (Index k = 0; k < values_.size(); ++k)
      if (before.rate(k) > 0.0 && here.rate(k) < 0.0) locate(field, state, k, before.time, here.time);
    before = std::move(here);
  }
}

LargestValues::Look LargestValues::look(int field, const DenseOutput& state, double time) const {
  const Index n = system_.dimension();
  Look result{time, Eigen::Map<const VectorXd>(state(time), n), VectorXd(n)};
  system_.value(FunctionKind::field, field, result.state.data(), par_.data(), result.rate.data());
  return result;
}

void LargestValues::locate(int field, const DenseOutput& state, Index k, double rising, double falling) {
  for (int halving = 0; halving < halvings; ++halving) {
    const double middle = 0.5 * (rising + falling);
    (look(field, state, middle).rate(k) > 0.0 ? rising : falling) = middle;
  }
  values_(k) = std::max(values_(k), state(rising)[k]);
}

}  // namespace tchat
