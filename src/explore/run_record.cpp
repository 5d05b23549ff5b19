#include "explore/run_record.hpp"

#include <cstdlib>

#include "base/levels.hpp"
#include "files/solution_file_reader.hpp"

namespace tchat {

RunRecord run_record(const std::string& path) {
  RunRecord record;
  bool some_beyond = false, some_left = false;
  for (const DiagnosticPoint& point : read_diagnostics_file(path)) {
    ++record.points;
    record.inadmissible += point.admissible ? 0 : 1;
    if (std::abs(point.point) > 1) {
      some_beyond = true;
      some_left = some_left || point.admissible;
    }
    if (point.label > 0) record.admissible[point.label] = point.admissible;
    if (point.end) record.ends.push_back(*point.end);
    record.lost.insert(record.lost.end(), point.lost.begin(), point.lost.end());
  }
  record.only_at_start = some_beyond && !some_left;
  return record;
}

int other_field_at_rest(const HybridSystem& system, const LabelledSolution& solution, int field) {
  constexpr double at_rest = level::located;  // a located point is known to EPSS
  const LabelledSolution own = in_layout(solution, system.layout());
  const int n = system.dimension();
  if (own.states.rows() < n || own.states.cols() < 1) return 0;
  const Eigen::VectorXd x = own.states.col(0).head(n);
  for (int i = 1; i <= system.count(FunctionKind::field); ++i) {
    if (i == field) continue;
    Eigen::VectorXd f(n);
    Eigen::MatrixXd by_state(n, n);
    system.first(FunctionKind::field, i, x.data(), own.parameters.data(), {}, f.data(), by_state.data(), nullptr);
    const Eigen::VectorXd terms = by_state.cwiseAbs() * x.cwiseAbs();
    if ((f.cwiseAbs().array() <= at_rest * terms.array()).all()) return i;
  }
  return 0;
}

}  // namespace tchat
