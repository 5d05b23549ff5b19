// Numbers of attractors: continued along a parameter, new at a jump, the same orbit in a basin, whatever comes between.
#include "simulate/attractor_numbering.hpp"

#include <catch2/catch.hpp>

using namespace tchat;

namespace {

/// A periodic orbit with these states after its events, range 1.
AttractorSample orbit(const std::vector<double>& states, const IndexVector& index = {1, 1, 1}) {
  AttractorSample sample;
  sample.kind = AttractorKind::periodic;
  sample.identity.resize(1, static_cast<Eigen::Index>(states.size()));
  for (std::size_t s = 0; s < states.size(); ++s) sample.identity(0, static_cast<Eigen::Index>(s)) = states[s];
  sample.signature.assign(states.size(), index);
  sample.sizes = Eigen::VectorXd::Ones(1);
  sample.last.x = sample.identity.col(0);
  return sample;
}

std::vector<int> numbers(const std::vector<SampleRecord>& records, const SweptQuantity& over,
                         const std::vector<AttractorSample>& known = {}) {
  return number_attractors(records, known, SweepGrid({over})).of_record;
}

}  // namespace

TEST_CASE("an orbit whose period is a repeated signature is the same wherever it is cut") {
  CHECK(attractor_distance(orbit({0.1, 0.4}), orbit({0.4, 0.1})) < 1e-12);
  CHECK(is_same_attractor(orbit({0.1, 0.4}), orbit({0.4001, 0.1})));
  CHECK_FALSE(is_same_attractor(orbit({0.1, 0.4}), orbit({0.1, 0.1})));
  CHECK_FALSE(is_same_attractor(orbit({0.1}), orbit({0.1, 0.1})));
  CHECK_FALSE(is_same_attractor(orbit({0.1}), orbit({0.1}, {1, 2, 2})));
}

TEST_CASE("along a parameter an attractor keeps its number, and a jump gives a new one") {
  const SweptQuantity mu{"mu", 0, 1, 6, false};
  const std::vector<SampleRecord> records = {
      {0, 1, orbit({0.10})},
      {0, 2, orbit({0.90})},  // two that coexist
      {1, 1, orbit({0.15})},
      {1, 2, orbit({0.86})},
      {2, 1, orbit({0.20})},
      {2, 2, orbit({0.20})},  // the second is gone: both starts come to the first
      {3, 1, orbit({0.24})},
      {3, 2, orbit({0.24})},
      {4, 1, orbit({0.60})},
      {4, 2, orbit({0.60})},  // further than a tenth of the range: another one
      {5, 1, {}},
      {5, 2, orbit({0.61})},
  };
  CHECK(numbers(records, mu) == std::vector<int>{1, 2, 1, 2, 1, 1, 1, 1, 3, 3, 0, 3});
}

TEST_CASE("two branches that come near each other do not change numbers") {
  const SweptQuantity mu{"mu", 0, 1, 3, false};
  const std::vector<SampleRecord> records = {{0, 1, orbit({0.50})}, {0, 2, orbit({0.58})}, {1, 1, orbit({0.57})},
                                             {1, 2, orbit({0.52})}, {2, 1, orbit({0.56})}, {2, 2, orbit({0.53})}};
  CHECK(numbers(records, mu) == std::vector<int>{1, 2, 2, 1, 2, 1});
}

TEST_CASE("a branch that is steep in the parameter has one number, also where it bends") {
  const SweptQuantity mu{"mu", 0, 1, 5, false};
  // Steps of 0.15 to 0.3 of the range; then a jump, with steps as before behind it.
  const std::vector<SampleRecord> records = {{0, 1, orbit({0.10})},
                                             {1, 1, orbit({0.25})},
                                             {2, 1, orbit({0.45})},
                                             {3, 1, orbit({0.75})},
                                             {4, 1, orbit({-0.20})}};
  CHECK(numbers(records, mu) == std::vector<int>{1, 1, 1, 1, 2});
}

TEST_CASE("in a basin the same orbit has one number, captured or not") {
  const SweptQuantity x{"x1", 0, 1, 5, true};
  AttractorSample captured;
  captured.known = 2;
  const std::vector<AttractorSample> known = {orbit({0.1}), orbit({0.9})};
  const std::vector<SampleRecord> records = {
      {0, 1, captured}, {1, 1, orbit({0.1000001})}, {2, 1, orbit({0.9})}, {3, 1, orbit({0.5})}, {4, 1, captured}};
  CHECK(numbers(records, x, known) == std::vector<int>{1, 2, 1, 3, 1});
}

TEST_CASE("over two parameters a number stands for kind and signature") {
  const SweepGrid grid({{"mu", 0, 1, 2, false}, {"r", 0, 1, 2, false}});
  AttractorSample chaos;
  chaos.kind = AttractorKind::chaotic;
  AttractorSample escape;
  escape.kind = AttractorKind::escape;
  const std::vector<SampleRecord> records = {{0, 1, orbit({0.1})}, {1, 1, chaos}, {2, 1, escape}, {3, 1, orbit({0.9})}};
  const AttractorNumbers numbered = number_attractors(records, {}, grid);
  CHECK(numbered.of_record == std::vector<int>{1, 2, 0, 1});
  CHECK(numbered.attractors.size() == 2);
  CHECK(grid.values(2)(0) == 0.0);
  CHECK(grid.values(2)(1) == 1.0);
}
