/// What most families do.
#include <fmt/format.h>

#include "base/user_error.hpp"
#include "files/orbit_trace.hpp"
#include "files/solution_file.hpp"
#include "kinds/orbit_check.hpp"
#include "settings/family.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

std::string SolutionFamily::mismatch(const LabelledSolution& label, const RunSettings& settings) const {
  const auto states = static_cast<Eigen::Index>(settings.segments.size()) * settings.dimension;
  if (!is_same_problem_type(label.problem_type, settings.problem_type))
    return fmt::format("computed with IPS = {}, the constants have {}", label.problem_type, settings.problem_type);
  if (label.states.rows() == states) return "";
  return fmt::format("has {} states, the constants {} segments of {}", label.states.rows(), settings.segments.size(),
                     settings.dimension);
}

OrbitTrace SolutionFamily::trace(const LabelledSolution& label, const std::string& name, int dimension,
                                 const std::string& path) const {
  return orbit_trace(label, name, dimension, path);
}

OrbitTrace SolutionFamily::section_trace(const LabelledSolution& label, const std::string&, int,
                                         const std::string& path) const {
  throw UserError(
      fmt::format("--section: label {} of {} is no torus (IPS = {}), and its orbit no curve on a section; leave "
                  "--section out",
                  label.label, path, label.problem_type));
}

std::map<int, LineKind> SolutionFamily::label_kinds(const std::string& solution_path) const {
  return tchat::label_kinds(solution_path);
}

}  // namespace tchat
