/// Vectors and matrices for the time of a call, whose entries are on the stack while they are few: a function that is
/// called at every point of a branch then allocates nothing, without a workspace that its caller has to keep.
#pragma once

#include <Eigen/Core>
#include <boost/container/small_vector.hpp>

namespace tchat {

namespace stack_array {

/// Comes before the Map, which needs the address.
template <std::size_t Most>
struct Entries {
  explicit Entries(Eigen::Index count) : entries(static_cast<std::size_t>(count), boost::container::default_init_t()) {}
  boost::container::small_vector<double, Most> entries;
};

}  // namespace stack_array

/// Not set to anything when it is made.
class StackVector : private stack_array::Entries<32>, public Eigen::Map<Eigen::VectorXd> {
 public:
  explicit StackVector(Eigen::Index size) : Entries(size), Map(entries.data(), size) {}
  ~StackVector() = default;
  StackVector(const StackVector&) = delete;
  StackVector& operator=(const StackVector&) = delete;
  using Map::operator=;
};

/// Column by column.
template <std::size_t Most = 256>
class StackMatrix : private stack_array::Entries<Most>, public Eigen::Map<Eigen::MatrixXd> {
 public:
  StackMatrix(Eigen::Index rows, Eigen::Index columns)
      : stack_array::Entries<Most>(rows * columns), Map(this->entries.data(), rows, columns) {}
  ~StackMatrix() = default;
  StackMatrix(const StackMatrix&) = delete;
  StackMatrix& operator=(const StackMatrix&) = delete;
  using Map::operator=;
};

}  // namespace tchat
