/// Of which known branch the orbits of a run are a part.
///
/// Numbers of the catalogue tell which branches are near. Among those the last labelled orbit of the run that is no
/// bifurcation, and no impact of velocity zero, decides: the known branch's orbit at exactly the same parameter value,
/// which it has as a label or which a further run from its nearest label corrects, is the same one or not
/// (explore/orbit_identity.hpp). Where there is no such orbit, as when the known branch ends before, the numbers decide
/// alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "explore/command_job.hpp"
#include "explore/exploration_commands.hpp"
#include "explore/orbit_catalogue.hpp"
#include "explore/orbit_identity.hpp"

namespace tchat {

/// Of which branch a section is a part.
struct KnownBranch {
  std::string name;       ///< "" where there is none
  bool is_whole = false;  ///< an orbit has the same states, and the branch has the value at which the section begins
};

class BranchRecognition {
 public:
  /// Views of all of them, which outlive this object.
  BranchRecognition(const OrbitCatalogue& catalogue, const ExplorationCommands& commands, const HybridSystem& system,
                    JobRunner& runner)
      : catalogue_(catalogue), commands_(commands), system_(system), runner_(runner) {}

  /// Nothing where a run was not begun, as the time limit was reached.
  std::optional<KnownBranch> branch_of(const CataloguedSection& section) const;

 private:
  enum class Verdict { same, different, unknown, interrupted };
  struct OwnOrbit;
  struct KnownStart;
  std::optional<OwnOrbit> last_regular_orbit(const CataloguedSection& section) const;
  Verdict compare(const OwnOrbit& own, const std::string& branch) const;
  Verdict compare_with_labels(const OwnOrbit& own, const std::string& branch) const;
  std::vector<KnownStart> starts_near(const OwnOrbit& own, const std::string& branch) const;
  Verdict compare_with_run(const OwnOrbit& own, const KnownStart& start) const;
  bool is_same(const OwnOrbit& own, const CataloguedSection& known, const LabelledSolution& other) const;

  const OrbitCatalogue& catalogue_;
  const ExplorationCommands& commands_;
  const HybridSystem& system_;
  JobRunner& runner_;
};

}  // namespace tchat
