/// The attractors of a sweep and the orbits of runs: which known branches they belong to, and how many are covered.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "explore/exploration_commands.hpp"
#include "explore/explored_diagram.hpp"
#include "explore/orbit_catalogue.hpp"
#include "files/point_file.hpp"
#include "model/hybrid_system.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

// The attractors of a sweep, value by value.

/// What one value and start lead to.
struct SweptAttractor {
  const SweepAttractor* attractor = nullptr;
  std::size_t row = 0;
  double value = 0.0;   ///< of the parameter
  double period = 0.0;  ///< in time; NaN
};

class AttractorSamples {
 public:
  /// Of no value.
  AttractorSamples() = default;
  /// Throws UserError as read_sweep_file() does.
  AttractorSamples(const std::string& path, const HybridSystem& system)
      : table_(read_sweep_file(path)), state_names_(ProblemNames::of(system).states) {}

  const SweepTable& table() const { return table_; }
  void for_each(const std::function<void(const SweptAttractor&)>& use) const;
  /// How often a value and a start lead to each kind of motion, attractor or not.
  std::map<AttractorKind, int> kinds() const;
  /// The columns of these names, NaN for those that are missing.
  std::vector<double> values_of(const SweptAttractor& sample, const std::vector<std::string>& names) const;
  /// The first recorded state, of a period that in which its first segment ends; nothing where none is recorded.
  std::optional<Eigen::VectorXd> numbers_of(const SweptAttractor& sample) const;
  /// The words of `tchat simulate` that begin there; none where no state is recorded.
  Command words_of(const SweptAttractor& sample) const;
  /// The words of `tchat simulate` that begin on an attractor, where it has been found first.
  static Command words_of(const SweepAttractor& attractor);
  double value_of(const SweepAttractor& attractor) const;
  /// `count` states of low discrepancy in the least box around the starts and the states recorded on attractors, as
  /// --state takes them: those of which `is_inside` is true.
  std::vector<std::string> further_starts(int count,
                                          const std::function<bool(const Eigen::VectorXd&)>& is_inside) const;
  /// The largest modulus of a state in that box.
  double size() const;

 private:
  /// Least and largest value of each state: n x 2.
  Eigen::MatrixX2d box() const;
  /// Rows of a value and start, one of them each.
  std::vector<std::size_t> first_rows() const;

  SweepTable table_;
  std::vector<std::string> state_names_;
};

Signature signature_of(const SweepAttractor& attractor);

// Of which known branch the orbits of a run are a part.
//
// Numbers of the catalogue tell which branches are near. Among those the last labelled orbit of the run that is no
// bifurcation, and no impact of velocity zero, or else the last one at a fold, decides: the known branch's orbit at
// exactly the same parameter value, which it has as a label or which a further run from its nearest label corrects, is
// the same one or not (motion/orbit_identity.hpp). Where there is no such orbit, as when the known branch ends before,
// the numbers decide alone.

/// Of which branch a section is a part.
struct KnownBranch {
  std::string name;       ///< "" where there is none
  bool is_whole = false;  ///< an orbit has the same states, and the branch has the value at which the section begins
};

/// The branch of orbits that are those of another one, reflected.
struct MirroredBranch {
  std::string name;
  std::vector<std::string> states;  ///< that change their signs
};

class BranchRecognition {
 public:
  /// Views of all of them, which outlive this object.
  BranchRecognition(const OrbitCatalogue& catalogue, const ExplorationCommands& commands, const HybridSystem& system,
                    JobRunner& runner)
      : catalogue_(catalogue), commands_(commands), system_(system), runner_(runner) {}

  /// Nothing where a run was not begun, as the time limit was reached.
  std::optional<KnownBranch> branch_of(const CataloguedSection& section) const;
  /// By labels that both have at one parameter value; nothing where there is none.
  std::optional<MirroredBranch> mirror_of(const CataloguedSection& section) const;

 private:
  enum class Verdict { same, different, unknown, interrupted };
  struct OwnOrbit;
  struct KnownStart;
  std::optional<OwnOrbit> last_regular_orbit(const CataloguedSection& section) const;
  Verdict compare(const OwnOrbit& own, const std::string& branch) const;
  Verdict compare_with_labels(const OwnOrbit& own, const std::string& branch) const;
  std::vector<KnownStart> starts_near(const OwnOrbit& own, const std::string& branch) const;
  Verdict compare_with_run(const OwnOrbit& own, const KnownStart& start) const;
  std::optional<MirroredBranch> mirror_in(const CataloguedSection& known, const CataloguedSection& section,
                                          const std::vector<LabelledSolution>& solutions) const;
  bool is_same(const OwnOrbit& own, const CataloguedSection& known, const LabelledSolution& other) const;

  const OrbitCatalogue& catalogue_;
  const ExplorationCommands& commands_;
  const HybridSystem& system_;
  JobRunner& runner_;
};

struct Sweep {
  std::string letter;  ///< before the numbers of its attractors
  AttractorSamples samples;
  std::vector<std::string> monitors;  ///< of branches, which it has columns of in part
  bool is_cut = false;  ///< by tchat (plugin/problem_library.hpp): its orbits are followed without that section
};

/// Does a branch begin at such an attractor? At periodic ones and those at rest.
bool is_followed(const SweepAttractor& attractor);

/// The branches that the attractor of a value lies on: by its state where it rests, else by signature, period and
/// largest values, which several branches may share.
std::vector<std::string> branches_of(const HybridSystem& system, const OrbitCatalogue& catalogue, const Sweep& sweep,
                                     const SweptAttractor& sample);

/// Adds the sweep's counts to the diagram, and its attractors on no branch.
void measure_coverage(const HybridSystem& system, const Sweep& sweep, const OrbitCatalogue& catalogue,
                      const ExplorationCommands& commands, ExploredDiagram& diagram);

}  // namespace tchat
