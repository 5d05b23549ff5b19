/// The orbits of known branches, interpolated between points.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "files/point_file_reader.hpp"
#include "model/hybrid_system.hpp"
#include "motion/orbit_identity.hpp"

namespace tchat {

// The orbits of the branches that are there, by numbers that do not depend on where an orbit begins nor on how often
// it is run round: its period, and mean and largest value of each state in time.
//
// An orbit is like one of a branch that has the same numbers at the same parameter, up to the error of interpolation
// between its points (cubic, compared with quadratic). Two different orbits may share these numbers: whether they are
// the same is decided by their states (explore/branch_recognition.hpp).

/// The points of one direction of a branch.
struct CataloguedSection {
  std::string branch;
  int number = 1;           ///< of the section in its file
  Signature own_signature;  ///< as its orbits begin
  PrimitiveWord signature;  ///< without impacts up to a limit
  /// Are there any? Numbers have contact in place of those that the limit sums up.
  bool has_chatter() const {
    return own_signature.size() != signature.word.size() * static_cast<std::size_t>(signature.repetitions);
  }
  std::vector<double> parameter;
  std::vector<int> labels;  ///< of each point; 0 without
  bool rests = false;
  Eigen::MatrixXd numbers;  ///< a column for each point: period of one repetition, then the other numbers;
                            ///< of an equilibrium its states
};

/// The sections of a p-file, whose columns have the names `monitors` and PERIOD, or those of states on branches of
/// equilibria. Sections without these are left out.
std::vector<CataloguedSection> catalogued_sections(const HybridSystem& system, const std::string& branch,
                                                   const PointFile& file, const std::vector<std::string>& monitors);

/// Where a branch has an orbit between two of its points.
struct BranchPlace {
  const CataloguedSection* section = nullptr;
  Eigen::Index point = 0;  ///< the one before
};

/// What orbits of this signature, with more impacts or fewer before a limit, have in common.
PrimitiveWord common_word(const HybridSystem& system, const Signature& signature);

class OrbitCatalogue {
 public:
  void add(CataloguedSection section) { sections_.push_back(std::move(section)); }
  const std::vector<CataloguedSection>& sections() const { return sections_; }

  /// The branch of which `section`, or all of it but its beginning, is a part by its numbers, and which has the value
  /// at which it begins; "" where there is none.
  std::string branch_of(const CataloguedSection& section) const;
  /// Branches that it may be a part of: numbers of three of five orbits are near, to 5 errors of interpolation and
  /// 1e-4 of their size. In the order in which they were added.
  std::vector<std::string> branches_near(const CataloguedSection& section) const;
  /// Does a branch have the parameter value at which a section begins?
  bool has_beginning(const std::string& branch, const CataloguedSection& section) const;
  /// Where a branch passes the parameter value of point `row` of `like` with numbers as near as that.
  std::vector<BranchPlace> places_near(const std::string& branch, const CataloguedSection& like,
                                       Eigen::Index row) const;
  /// The branches with an orbit of this signature and period at the parameter value, whose monitors are about these
  /// (NaN: not known), each once.
  std::vector<std::string> branches_with(const PrimitiveWord& signature, double parameter, double period,
                                         const std::vector<double>& monitors) const;
  /// The branch with this equilibrium. `size`: of states.
  std::string branch_with_state(double parameter, const Eigen::VectorXd& state, double size) const;

 private:
  std::vector<std::string> branches_at(const CataloguedSection& like, double parameter,
                                       const Eigen::VectorXd& numbers) const;

  std::vector<CataloguedSection> sections_;
};

// The points of a branch or curve between those that were computed.

struct InterpolatedPoint {
  Eigen::VectorXd numbers;
  Eigen::VectorXd uncertainty;  ///< of each: cubic compared with quadratic interpolation
};

/// The numbers of the point between points i and i + 1 whose coordinate is `at`. `coordinate` has that of each point,
/// and differs between these two; `numbers` has a column for each point.
InterpolatedPoint interpolate(const std::vector<double>& coordinate, const Eigen::MatrixXd& numbers, Eigen::Index i,
                              double at);

/// Are these the numbers of the point, up to its uncertainty and the errors of runs? `size`: of numbers that matter.
bool agrees(const InterpolatedPoint& point, const Eigen::VectorXd& numbers, double size = 0.0);

}  // namespace tchat
