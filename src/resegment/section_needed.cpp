#include "resegment/section_needed.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "hybrid/identity_jump.hpp"
#include "hybrid/index_vector.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

/// NAME of q.NAME, with its folder.
std::string name_of(const std::string& path) {
  std::filesystem::path name(path);
  const std::string file = name.filename().string();
  if (file.starts_with("q.")) name.replace_filename(file.substr(2));
  return name.string();
}

/// The first identity jump; the next new one if there is none.
int first_identity_jump(const HybridSystem& system) {
  const int count = system.count(FunctionKind::jump);
  for (int k = 1; k <= count; ++k)
    if (is_identity_jump(system, k)) return k;
  return count + 1;
}

}  // namespace

void require_section(const LabelledSolution& solution, const RunSettings& settings, const HybridSystem& system,
                     const std::string& what, const std::string& problem, const std::string& path) {
  if (settings.segments.size() != 1 || settings.segments.front().index.event != no_function) return;
  const std::string name = name_of(path);
  const double middle = 0.5 * (solution.states.row(0).minCoeff() + solution.states.row(0).maxCoeff());
  throw UserError(fmt::format(
      "label {} of {}: the orbit has no section, and {} needs one: a phase condition says where it begins, so that it "
      "cannot be cut at a contact\n"
      "  Give the problem one more event function, which falls through zero once in each period, as {} - {:.4g}, and "
      "an identity jump unless it has one; then the branch with that section is\n"
      "    tchat simulate {} -s {} IRS=1 --signature {},{},{} --dat {}_cut\n"
      "    tchat run {} -c {}_cut -d {}_cut -o {}_cut\n"
      "  and its labels are of orbits with a section.",
      solution.label, path, what, system.state_name(1), middle, problem, name, settings.segments.front().index.field,
      system.count(FunctionKind::event) + 1, first_identity_jump(system), name, problem, name, name, name));
}

}  // namespace tchat
