#include "continuation/predictor.hpp"

#include <algorithm>

#include "continuation/hermite_predictor.hpp"
#include "continuation/path_follower.hpp"

namespace tchat {

void Predictor::accepted(const PathPoint& from, const std::vector<int>& free_parameters, PathPoint& to) const {
  to.trail.follow(from, free_parameters);
}

bool Predictor::rejected(const Prediction& prediction, double correction) const {
  // Smaller changes than this lead to no other branch.
  constexpr double small_change = 1e-6;
  constexpr double largest_share = 0.5;
  return !(correction <= std::max(largest_share * prediction.change, small_change));
}

std::unique_ptr<Predictor> make_predictor(const std::vector<int>& free_parameters) {
  return std::make_unique<HermitePredictor>(free_parameters);
}

}  // namespace tchat
