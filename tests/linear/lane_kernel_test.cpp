// Elimination of four blocks side by side: against the elimination of one block, to the last bit; against Eigen's dense
// LU; on each set of vector instructions that this processor has.
#include <catch2/catch.hpp>
#include <random>

#include "linear/lane_kernel.hpp"
#include "linear/partial_lu.hpp"
#include "support/upper_halves.hpp"

using namespace tchat;
using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Sizes {
  int rows, pivots, width, border;
};

std::size_t place(int i) { return static_cast<std::size_t>(i); }

Block random_block(std::mt19937& generator, int rows, int columns) {
  std::normal_distribution<double> normal;
  Block a(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) a(i, j) = normal(generator);
  return a;
}

/// Blocks whose pivots are found in other rows in every lane: rows, from 1e-6 to 1e6, in another order in each.
std::vector<Block> badly_pivoted(std::mt19937& generator, const Sizes& k) {
  std::vector<Block> blocks;
  for (int l = 0; l < lanes; ++l) {
    blocks.push_back(random_block(generator, k.rows + k.border, k.width));
    for (int i = 0; i < k.rows; ++i) {
      const int order = (i * (2 * l + 1) + l) % k.rows;
      blocks.back().row(i) *= std::pow(10.0, 12.0 * order / k.rows - 6.0);
    }
  }
  return blocks;
}

std::vector<Block> random_blocks(std::mt19937& generator, const Sizes& k) {
  std::vector<Block> blocks;
  for (int l = 0; l < lanes; ++l) blocks.push_back(random_block(generator, k.rows + k.border, k.width));
  return blocks;
}

/// `stride` entries from one row to the next, those beyond the blocks' own not finite; 0: as many as there are columns.
LaneArray side_by_side(const std::vector<Block>& blocks, int stride = 0) {
  const int rows = static_cast<int>(blocks[0].rows()), columns = static_cast<int>(blocks[0].cols());
  if (stride == 0) stride = columns;
  LaneArray all(place(rows * stride * lanes), NAN);
  for (int l = 0; l < lanes; ++l)
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) all[place((i * stride + j) * lanes + l)] = blocks[place(l)](i, j);
  return all;
}

VectorXd lane_of(const LaneArray& all, int lane) {
  VectorXd result(static_cast<Eigen::Index>(all.size()) / lanes);
  for (int i = 0; i < result.size(); ++i) result(i) = all[place(i * lanes + lane)];
  return result;
}

Block block_of(const LaneArray& all, int lane, const Block& like) {
  const VectorXd values = lane_of(all, lane);
  return Eigen::Map<const Block>(values.data(), like.rows(), values.size() / like.rows()).leftCols(like.cols());
}

std::vector<double*> places_of(std::vector<LaneArray>& arrays) {
  std::vector<double*> places;
  for (LaneArray& array : arrays) places.push_back(array.data());
  return places;
}

struct Eliminated {
  LaneArray blocks;
  std::vector<int> swaps;
  unsigned failed = 0;
};

Eliminated eliminated(const Sizes& k, const std::vector<Block>& blocks, VectorSet set) {
  const LaneKernel kernel(k.rows, k.pivots, k.width, set);
  Eliminated result{side_by_side(blocks, kernel.stride()), std::vector<int>(place(k.pivots * lanes + 1))};
  REQUIRE(static_cast<std::ptrdiff_t>(result.blocks.size()) == kernel.block_size(k.border));
  result.failed = kernel.eliminate(result.blocks.data(), k.border, result.swaps.data());
  return result;
}

/// Sizes of intervals (n, c) and joins, with two scalar columns.
std::vector<Sizes> all_sizes() {
  std::vector<Sizes> sizes;
  for (const int n : {1, 2, 3, 4, 5, 7, 10})
    for (const int border : {0, 1, 2}) {
      for (const int c : {1, 2, 4, 5}) sizes.push_back({c * n, (c - 1) * n, (c + 1) * n + 2, border});
      sizes.push_back({2 * n, n, 3 * n + 2, border});
    }
  sizes.push_back({80, 60, 102, 1});
  return sizes;
}

/// Sizes on both sides of everything that is done several at a time: pivots, rows below them, columns right of them.
std::vector<Sizes> sizes_about_borders() {
  std::vector<Sizes> sizes;
  for (const int pivots : {3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 32, 33})
    for (const int below : {1, 3, 4, 5, 8})
      for (const int right : {1, 2, 3, 47, 48, 49})
        sizes.push_back({pivots + below, pivots, pivots + right, right % 2});
  for (const int width : {252, 253}) sizes.push_back({200, 150, width, 1});  // n = 50, with a residual and without
  return sizes;
}

void check_against_one_block(const Sizes& k, const std::vector<Block>& blocks, VectorSet set) {
  const Eliminated e = eliminated(k, blocks, set);
  CHECK(e.failed == 0);
  const BlockKernel single(k.rows, k.pivots, k.width);
  for (int l = 0; l < lanes; ++l) {
    Block alone = blocks[place(l)];
    std::vector<int> swaps(place(k.pivots) + 1);
    REQUIRE(single.eliminate(alone.data(), k.border, swaps.data()));
    CHECK(block_of(e.blocks, l, alone) == alone);
    for (int p = 0; p < k.pivots; ++p) CHECK(e.swaps[place(p * lanes + l)] == swaps[place(p)]);
  }
}

/// The rows A y = b with the columns of their pivots eliminated, and conditions on the rest that make the matrix
/// square: solved by Eigen whole, and in steps.
void check_against_eigen(const Sizes& k, const std::vector<Block>& blocks, VectorSet set) {
  std::mt19937 generator(12);
  const int rest = k.width - k.pivots;
  const int conditions = k.width - k.rows;
  const Eliminated e = eliminated(k, blocks, set);
  const LaneKernel kernel(k.rows, k.pivots, k.width, set);
  std::vector<VectorXd> wanted;
  std::vector<Block> right;
  std::vector<MatrixXd> closing;
  for (int l = 0; l < lanes; ++l) {
    wanted.push_back(random_block(generator, k.width, 1));
    closing.push_back(random_block(generator, conditions, rest));
    right.push_back(blocks[place(l)] * wanted.back());
  }
  LaneArray rhs = side_by_side(right);
  kernel.forward(e.blocks.data(), k.border, e.swaps.data(), rhs.data());
  LaneArray x(place(k.width * lanes), 0.0);
  for (int l = 0; l < lanes; ++l) {
    const Block lu = block_of(e.blocks, l, blocks[place(l)]);
    MatrixXd reduced(rest, rest);
    reduced << lu.block(k.pivots, k.pivots, k.rows - k.pivots, rest), closing[place(l)];
    VectorXd known(rest);
    known << lane_of(rhs, l).segment(k.pivots, k.rows - k.pivots), closing[place(l)] * wanted[place(l)].tail(rest);
    const VectorXd ends = reduced.fullPivLu().solve(known);
    for (int i = 0; i < rest; ++i) x[place((k.pivots + i) * lanes + l)] = ends(i);
  }
  kernel.backward(e.blocks.data(), rhs.data(), x.data());
  for (int l = 0; l < lanes; ++l) {
    MatrixXd whole = MatrixXd::Zero(k.width, k.width);
    whole.topRows(k.rows) = blocks[place(l)].topRows(k.rows);
    whole.bottomRightCorner(conditions, rest) = closing[place(l)];
    VectorXd b(k.width);
    b << right[place(l)].col(0).head(k.rows), closing[place(l)] * wanted[place(l)].tail(rest);
    // Both are solved backward stably: rows are scaled to size 1 before they are asked for the error.
    const VectorXd by_eigen = whole.fullPivLu().solve(b);
    const VectorXd found = lane_of(x, l);
    const VectorXd size = whole.cwiseAbs() * found.cwiseAbs();
    CHECK(((whole * found - b).cwiseAbs().array() <= 1e-10 * size.array()).all());
    if (k.rows < 60) CHECK((found - by_eigen).norm() <= 1e-5 * by_eigen.norm());
    // Border rows: what they say of the solution is what is left of them.
    const Block lu = block_of(e.blocks, l, blocks[place(l)]);
    for (int r = 0; r < k.border; ++r) {
      const auto row = lu.row(k.rows + r).tail(rest);
      CHECK(std::abs(row.dot(found.tail(rest)) - rhs[place((k.rows + r) * lanes + l)]) <=
            1e-7 * (1.0 + row.norm() * found.norm()));
    }
  }
}

}  // namespace

TEST_CASE("each lane is eliminated as one block alone would be, to the last bit, with every set of instructions") {
  for (const VectorSet set : available_vector_sets()) {
    std::mt19937 generator(3);
    for (const Sizes& k : all_sizes()) {
      CAPTURE(static_cast<int>(set), k.rows, k.pivots, k.width, k.border);
      check_against_one_block(k, random_blocks(generator, k), set);
      check_against_one_block(k, badly_pivoted(generator, k), set);
    }
  }
}

TEST_CASE("what is eliminated several rows, columns or pivots at a time has the same bits as what is left of them") {
  for (const VectorSet set : available_vector_sets()) {
    std::mt19937 generator(4);
    for (const Sizes& k : sizes_about_borders()) {
      CAPTURE(static_cast<int>(set), k.rows, k.pivots, k.width, k.border);
      check_against_one_block(k, random_blocks(generator, k), set);
      check_against_one_block(k, badly_pivoted(generator, k), set);
    }
  }
}

TEST_CASE("systems solved in lanes agree with Eigen's dense LU, badly pivoted ones too") {
  for (const VectorSet set : available_vector_sets()) {
    std::mt19937 generator(5);
    for (const Sizes& k : all_sizes()) {
      CAPTURE(static_cast<int>(set), k.rows, k.pivots, k.width, k.border);
      check_against_eigen(k, random_blocks(generator, k), set);
      check_against_eigen(k, badly_pivoted(generator, k), set);
    }
  }
}

TEST_CASE("badly pivoted blocks have other pivots in every lane") {
  std::mt19937 generator(5);
  const Sizes k{16, 12, 22, 1};
  const Eliminated e = eliminated(k, badly_pivoted(generator, k), VectorSet::baseline);
  int different = 0;
  for (int p = 0; p < k.pivots; ++p)
    for (int l = 1; l < lanes; ++l) different += e.swaps[place(p * lanes)] != e.swaps[place(p * lanes + l)] ? 1 : 0;
  CHECK(different > 2 * k.pivots);
}

TEST_CASE("a lane without a pivot, or with NaN or infinity, is told and leaves its neighbours as they are") {
  const Sizes k{16, 12, 22, 1};
  for (const VectorSet set : available_vector_sets())
    for (int l = 0; l < lanes; ++l)
      for (const int fault : {0, 1, 2, 3}) {
        CAPTURE(static_cast<int>(set), l, fault);
        std::mt19937 generator(6);
        const std::vector<Block> good = badly_pivoted(generator, k);
        std::vector<Block> bad = good;
        Block& block = bad[place(l)];
        if (fault == 0) block.col(7).setZero();
        if (fault == 1)
          block.row(3).setZero(), block.row(9).setZero(), block.row(2).setZero(), block.row(4).setZero(),
              block.row(5).setZero();
        if (fault == 2) block.col(3).setConstant(NAN);
        if (fault == 3) block(3, 1) = INFINITY;
        const Eliminated alone = eliminated(k, good, set);
        const Eliminated e = eliminated(k, bad, set);
        CHECK(alone.failed == 0);
        CHECK(e.failed == 1u << l);
        for (int other = 0; other < lanes; ++other) {
          if (other == l) continue;
          CHECK(block_of(e.blocks, other, block) == block_of(alone.blocks, other, block));
          for (int p = 0; p < k.pivots; ++p)
            CHECK(e.swaps[place(p * lanes + other)] == alone.swaps[place(p * lanes + other)]);
        }
      }
}

TEST_CASE("border rows are no pivots in any lane, however large") {
  std::mt19937 generator(6);
  const Sizes k{8, 4, 14, 2};
  std::vector<Block> blocks = random_blocks(generator, k);
  for (Block& block : blocks) block.bottomRows(2) *= 1e9;
  for (const VectorSet set : available_vector_sets())
    for (const int row : eliminated(k, blocks, set).swaps) CHECK(row < k.rows);
}

TEST_CASE("several solutions at once are those found one by one, to the last bit") {
  for (const VectorSet set : available_vector_sets()) {
    std::mt19937 generator(8);
    for (const Sizes& k : all_sizes()) {
      CAPTURE(static_cast<int>(set), k.rows, k.pivots, k.width);
      const Eliminated e = eliminated(k, random_blocks(generator, k), set);
      const LaneKernel kernel(k.rows, k.pivots, k.width, set);
      const LaneArray zero(place(k.rows * lanes));
      for (const int count : {2, 3, 4, 5}) {
        std::vector<LaneArray> together;
        for (int solution = 0; solution < count; ++solution) {
          std::vector<Block> known;
          for (int l = 0; l < lanes; ++l) known.push_back(random_block(generator, k.width, 1));
          together.push_back(side_by_side(known));
        }
        std::vector<LaneArray> alone = together;
        kernel.backward_of_several(e.blocks.data(), places_of(together));
        for (LaneArray& x : alone) kernel.backward(e.blocks.data(), zero.data(), x.data());
        CHECK(together == alone);
      }
    }
  }
}

TEST_CASE("a block that comes next is left as it is and changes nothing") {
  for (const VectorSet set : available_vector_sets()) {
    std::mt19937 generator(10);
    for (const Sizes& k : all_sizes()) {
      CAPTURE(static_cast<int>(set), k.rows, k.pivots, k.width);
      const std::vector<Block> blocks = random_blocks(generator, k);
      const Eliminated e = eliminated(k, blocks, set);
      const LaneKernel kernel(k.rows, k.pivots, k.width, set);
      const LaneArray next(e.blocks.size(), 2.5);
      LaneArray again = side_by_side(blocks, kernel.stride());
      std::vector<int> swaps(e.swaps.size());
      CHECK(kernel.eliminate(again.data(), k.border, swaps.data(), next.data()) == 0);
      CHECK(swaps == e.swaps);
      for (int l = 0; l < lanes; ++l)
        CHECK(block_of(again, l, blocks[place(l)]) == block_of(e.blocks, l, blocks[place(l)]));

      LaneArray forward_alone(place((k.rows + k.border) * lanes), 0.5);
      LaneArray forward_before_next = forward_alone;
      kernel.forward(e.blocks.data(), k.border, e.swaps.data(), forward_alone.data());
      kernel.forward(e.blocks.data(), k.border, e.swaps.data(), forward_before_next.data(), next.data());
      CHECK(forward_alone == forward_before_next);

      const LaneArray right(place(k.rows * lanes), 0.5);
      std::vector<LaneArray> alone(3, LaneArray(place(k.width * lanes), 1.5));
      std::vector<LaneArray> before_next = alone;
      kernel.backward(e.blocks.data(), right.data(), alone[0].data());
      kernel.backward(e.blocks.data(), right.data(), before_next[0].data(), next.data());
      CHECK(alone == before_next);
      kernel.backward_of_several(e.blocks.data(), places_of(alone));
      kernel.backward_of_several(e.blocks.data(), places_of(before_next), next.data());
      CHECK(alone == before_next);
      CHECK(next == LaneArray(e.blocks.size(), 2.5));
    }
  }
}

TEST_CASE("forward elimination in lanes and its transpose agree") {
  for (const VectorSet set : available_vector_sets()) {
    std::mt19937 generator(9);
    for (const Sizes& with_border : all_sizes()) {
      const Sizes k{with_border.rows, with_border.pivots, with_border.width, 0};
      CAPTURE(static_cast<int>(set), k.rows, k.pivots);
      const Eliminated e = eliminated(k, random_blocks(generator, k), set);
      const LaneKernel kernel(k.rows, k.pivots, k.width, set);
      std::vector<Block> weights, right;
      for (int l = 0; l < lanes; ++l) {
        weights.push_back(random_block(generator, k.rows, 1));
        weights.back().topRows(k.pivots).setZero();
        right.push_back(random_block(generator, k.rows, 1));
      }
      LaneArray w = side_by_side(weights);
      LaneArray b = side_by_side(right);
      kernel.forward_transposed(e.blocks.data(), e.swaps.data(), w.data());
      kernel.forward(e.blocks.data(), 0, e.swaps.data(), b.data());
      for (int l = 0; l < lanes; ++l) {
        const double condensed = weights[place(l)].col(0).dot(lane_of(b, l));
        const VectorXd original = lane_of(w, l);
        CHECK(std::abs(condensed - original.dot(right[place(l)].col(0))) <=
              1e-9 * (1.0 + original.norm() * right[place(l)].norm()));
      }
    }
  }
}

TEST_CASE("arrays of lanes are gathered and scattered, but for lanes that have none") {
  for (const VectorSet set : available_vector_sets())
    for (int count = 1; count < 11; ++count) {
      CAPTURE(static_cast<int>(set), count);
      const LaneAssembly assembly(set);
      std::vector<std::vector<double>> arrays;
      const double* from[lanes];
      for (int l = 0; l < lanes; ++l) {
        arrays.emplace_back();
        for (int k = 0; k < count; ++k) arrays.back().push_back(10.0 * k + l);
      }
      for (int l = 0; l < lanes; ++l) from[l] = arrays[place(l)].data();
      LaneArray together(place(count * lanes));
      assembly.gather(from, count, together.data());
      for (int k = 0; k < count; ++k)
        for (int l = 0; l < lanes; ++l) CHECK(together[place(k * lanes + l)] == 10.0 * k + l);
      std::vector<std::vector<double>> back(lanes, std::vector<double>(place(count + 1), -1.0));
      double* const to[lanes] = {back[0].data(), back[1].data(), nullptr, back[3].data()};
      assembly.scatter(together.data(), count, to);
      for (int l = 0; l < lanes; ++l) {
        CHECK(back[place(l)].back() == -1.0);  // not beyond the end
        back[place(l)].pop_back();
        CHECK(back[place(l)] == (l == 2 ? std::vector<double>(place(count), -1.0) : arrays[place(l)]));
      }
    }
}

namespace {

LaneArray in_lanes(const std::vector<MatrixXd>& of_lanes) {
  const int count = static_cast<int>(of_lanes.front().size());
  LaneArray result(place(count * lanes));
  for (int l = 0; l < lanes; ++l)
    for (int k = 0; k < count; ++k) result[place(k * lanes + l)] = of_lanes[place(l)].data()[k];
  return result;
}

void check_filling(int n, int c, int scalars) {
  CAPTURE(n, c, scalars);
  const double tolerance = 1e-14 * 10 * n;
  const int width = (c + 1) * n + scalars + 1, stride = width + 1;
  std::mt19937 generator(10);
  const MatrixXd value = random_block(generator, c, c + 1);
  const MatrixXd slope = random_block(generator, c, c + 1);
  std::vector<MatrixXd> f, fx, fp, nodes;
  for (int l = 0; l < lanes; ++l) {
    f.emplace_back(random_block(generator, n, c));
    fx.emplace_back(random_block(generator, n, n * c));
    fp.emplace_back(random_block(generator, n, (scalars - 1) * c));
    nodes.emplace_back(random_block(generator, n, c + 1));
  }
  const LaneArray field = in_lanes(f), by_state = in_lanes(fx), by_parameter = in_lanes(fp);
  LaneCollocation at{n,  c,  scalars, value.data(), slope.data(), field.data(), by_state.data(), by_parameter.data(),
                     {}, {}, nullptr};
  LaneArray states(place((c + 1) * n * lanes));
  for (int l = 0; l < lanes; ++l) {
    at.h[l] = 0.1 * (l + 1), at.scale[l] = at.h[l] * 0.7;
    for (int i = 0; i < (c + 1) * n; ++i) states[place(i * lanes + l)] = nodes[place(l)].data()[i];
  }
  std::vector<LaneArray> filled;
  for (const VectorSet set : available_vector_sets()) {
    const LaneAssembly assembly(set);
    LaneArray points(place(c * n * lanes)), derivatives = points, residual = points;
    LaneArray blocks(place(c * n * stride * lanes)), jacobian(place(n * n * lanes));
    assembly.interpolate(at, states.data(), points.data(), derivatives.data());
    at.derivatives = derivatives.data();
    REQUIRE(assembly.fill(at, stride, blocks.data(), jacobian.data(), residual.data()));
    filled.push_back(blocks);
    for (int l = 0; l < lanes; ++l) {
      const auto k = place(l);
      const MatrixXd wanted_points = nodes[k] * value.transpose();
      const MatrixXd wanted_rest = nodes[k] * slope.transpose() - at.scale[l] * f[k];
      const VectorXd found_points = lane_of(points, l), found_rest = lane_of(residual, l);
      CHECK((found_points - wanted_points.reshaped()).norm() < tolerance);
      CHECK((found_rest - wanted_rest.reshaped()).norm() < tolerance);
      const Block found = block_of(blocks, l, Block(c * n, width));
      for (int g = 0; g < c; ++g) {
        Block wanted(n, width);
        const MatrixXd jacobian_of_f = -at.scale[l] * fx[k].middleCols(g * n, n);
        const auto node = [&](int i) -> MatrixXd {
          return value(g, i) * jacobian_of_f + slope(g, i) * MatrixXd::Identity(n, n);
        };
        for (int i = 1; i < c; ++i) wanted.middleCols((i - 1) * n, n) = node(i);
        wanted.middleCols((c - 1) * n, 2 * n) << node(0), node(c);
        wanted.col((c + 1) * n) = -at.h[l] * f[k].col(g);
        wanted.middleCols((c + 1) * n + 1, scalars - 1) =
            -at.scale[l] * fp[k].middleCols(g * (scalars - 1), scalars - 1);
        wanted.col(width - 1) = wanted_rest.col(g);
        CHECK((found.middleRows(g * n, n) - wanted).norm() < tolerance);
      }
    }
    for (int k = 0; k < n * n * c; ++k) {
      LaneArray broken = by_state;
      broken[place(k * lanes + 2)] = NAN;
      LaneCollocation with_nan = at;
      with_nan.fx = broken.data();
      CHECK_FALSE(assembly.fill(with_nan, stride, blocks.data(), jacobian.data(), residual.data()));
    }
    for (int k = 0; k < n * c; ++k) {
      LaneArray broken = field;
      broken[place(k * lanes + 1)] = INFINITY;
      LaneCollocation with_infinity = at;
      with_infinity.f = broken.data();
      CHECK_FALSE(assembly.fill(with_infinity, stride, blocks.data(), jacobian.data(), residual.data()));
    }
  }
  for (const LaneArray& blocks : filled) CHECK(blocks == filled.front());
}

}  // namespace

TEST_CASE("collocation rows are filled as the formula says, alike with every set of instructions") {
  for (const int n : {1, 2, 3, 4, 5, 9})  // loops over 2, 3 and 4 states are unrolled, and those over four of them
    for (const int c : {1, 2, 4})
      for (const int scalars : {1, 3}) check_filling(n, c, scalars);
}

#ifdef NDEBUG  // an optimised build: below -O2, as sanitized copies are compiled, no compiler sees to it
TEST_CASE("no function in lanes leaves anything in the upper halves of registers", "[slow]") {
  std::mt19937 generator(13);
  for (const VectorSet set : available_vector_sets())
    for (const Sizes& k : {Sizes{16, 12, 22, 1}, Sizes{20, 10, 43, 1}, Sizes{200, 150, 253, 1}}) {
      CAPTURE(static_cast<int>(set), k.rows);
      const LaneKernel kernel(k.rows, k.pivots, k.width, set);
      const LaneAssembly assembly(set);
      LaneArray blocks = side_by_side(random_blocks(generator, k), kernel.stride());
      std::vector<int> swaps(place(k.pivots * lanes));
      LaneArray rhs(place((k.rows + k.border) * lanes), 0.5);
      std::vector<LaneArray> x(3, LaneArray(place(k.width * lanes), 0.25));
      const std::vector<double*> solutions = places_of(x);
      const double* const from[lanes] = {x[0].data(), x[1].data(), x[2].data(), x[0].data()};
      double* const to[lanes] = {x[0].data(), x[1].data(), nullptr, x[2].data()};
      CHECK(leaves_upper_halves_clear([&] { kernel.eliminate(blocks.data(), k.border, swaps.data()); }));
      CHECK(leaves_upper_halves_clear([&] { kernel.forward(blocks.data(), k.border, swaps.data(), rhs.data()); }));
      CHECK(leaves_upper_halves_clear([&] { kernel.forward_transposed(blocks.data(), swaps.data(), rhs.data()); }));
      CHECK(leaves_upper_halves_clear([&] { kernel.backward(blocks.data(), rhs.data(), x[0].data()); }));
      for (const std::size_t count : {2u, 3u})
        CHECK(leaves_upper_halves_clear(
            [&] { kernel.backward_of_several(blocks.data(), std::span(solutions).first(count)); }));
      for (const int count : {3, 4, 9}) {
        CHECK(leaves_upper_halves_clear([&] { assembly.gather(from, count, rhs.data()); }));
        CHECK(leaves_upper_halves_clear([&] { assembly.scatter(rhs.data(), count, to); }));
      }
      const int n = k.rows - k.pivots, c = k.rows / n, stride = (c + 1) * n + 3;
      const LaneArray ones(place(c * n * n * lanes + (c + 1) * n * lanes), 1.0);
      LaneArray rows(place(c * n * stride * lanes)), scratch(place(n * n * lanes)), rest(place(c * n * lanes));
      LaneCollocation at{n, c, 2, ones.data(), ones.data(), ones.data(), ones.data(), ones.data(), {}, {}, ones.data()};
      CHECK(leaves_upper_halves_clear([&] { assembly.interpolate(at, ones.data(), rest.data(), rest.data()); }));
      CHECK(leaves_upper_halves_clear([&] { assembly.fill(at, stride, rows.data(), scratch.data(), rest.data()); }));
      const LanePiece piece{ones.data(), ones.data(), 2 * n + 2};
      LaneArray joined(place((2 * n + 1) * (3 * n + 2) * lanes));
      if ((n + 1) * (2 * n + 2) * lanes <= static_cast<int>(ones.size()))
        CHECK(leaves_upper_halves_clear([&] { assembly.join({n, 2, 1, 3 * n + 2}, piece, piece, joined.data()); }));
    }
}
#endif
