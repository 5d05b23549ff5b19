/// The rows that tie the ends of segments together, as a problem type gives them to the condensed system.
#pragma once

#include <vector>

#include "orbit/orbit.hpp"

namespace tchat {

/// The unknowns that are left when each segment is condensed: x_s(0), x_s(1), T_s of one segment after the other, then
/// the free problem parameters.
struct EndUnknowns {
  int dimension;
  int segments;

  int start(int s) const { return s * (2 * dimension + 1); }
  int end(int s) const { return start(s) + dimension; }
  int duration(int s) const { return start(s) + 2 * dimension; }
  int global(int g) const { return segments * (2 * dimension + 1) + g; }
};

/// Collects where the derivatives of rows stand. Their values are given later in the order of these calls, row by row
/// within each of them. `row` counts from `first_row`.
class CouplingPattern {
 public:
  CouplingPattern(const EndUnknowns& unknowns, int globals, int first_row, std::vector<int>& rows,
                  std::vector<int>& columns)
      : unknowns_(unknowns), globals_(globals), first_row_(first_row), rows_(rows), columns_(columns) {}

  /// `count` rows in all of x_s(0), of x_s(1), in T_s, in the free problem parameters, in one of them.
  void start(int row, int count, int s) { dense(row, count, unknowns_.start(s), unknowns_.dimension); }
  void end(int row, int count, int s) { dense(row, count, unknowns_.end(s), unknowns_.dimension); }
  void duration(int row, int count, int s) { dense(row, count, unknowns_.duration(s), 1); }
  void globals(int row, int count) { dense(row, count, unknowns_.global(0), globals_); }
  void global(int row, int count, int g) { dense(row, count, unknowns_.global(g), 1); }
  /// n rows, each in its own component of x_s(0).
  void start_components(int row, int s) {
    for (int a = 0; a < unknowns_.dimension; ++a) put(row + a, unknowns_.start(s) + a);
  }

 private:
  void dense(int row, int count, int column, int columns) {
    for (int a = 0; a < count; ++a)
      for (int b = 0; b < columns; ++b) put(row + a, column + b);
  }
  void put(int row, int column) {
    rows_.push_back(first_row_ + row);
    columns_.push_back(column);
  }

  EndUnknowns unknowns_;
  int globals_;
  int first_row_;
  std::vector<int>& rows_;
  std::vector<int>& columns_;
};

}  // namespace tchat
