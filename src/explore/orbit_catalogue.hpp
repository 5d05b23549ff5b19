/// The orbits of the branches that are there, by numbers that do not depend on where an orbit begins nor on how often
/// it is run round: its period, and mean and largest value of each state in time.
///
/// An orbit is on a branch where the branch has one at the same parameter with the same numbers, up to the error of
/// interpolation between its points (cubic, compared with quadratic). Two different orbits may share these numbers in
/// principle; mirror images differ in their means.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "files/point_file_reader.hpp"

namespace tchat {

using SignatureWord = std::vector<std::array<int, 3>>;

/// The part that a signature repeats, beginning where that is least in the order of index vectors, and how often.
struct PrimitiveWord {
  SignatureWord word;
  int repetitions = 1;
};
PrimitiveWord primitive_word(const SignatureWord& signature);

/// The points of one direction of a branch.
struct CataloguedSection {
  std::string branch;
  int number = 1;  ///< of the section in its file
  PrimitiveWord signature;
  std::vector<double> parameter;
  bool rests = false;
  Eigen::MatrixXd numbers;  ///< a column for each point: period of one repetition, then the other numbers;
                            ///< of an equilibrium its states
};

/// The sections of a p-file, whose columns have the names `monitors` and PERIOD, or those of states on branches of
/// equilibria. Sections without these are left out.
std::vector<CataloguedSection> catalogued_sections(const std::string& branch, const PointFile& file,
                                                   const std::vector<std::string>& monitors);

class OrbitCatalogue {
 public:
  void add(CataloguedSection section) { sections_.push_back(std::move(section)); }
  const std::vector<CataloguedSection>& sections() const { return sections_; }

  /// The branch of which `section`, or all of it but its beginning, is a part; "" where there is none.
  std::string branch_of(const CataloguedSection& section) const;
  /// The branch with an orbit of this signature and period at the parameter value, whose monitors are about these (NaN:
  /// not known); "" where there is none.
  std::string branch_with(const SignatureWord& signature, double parameter, double period,
                          const std::vector<double>& monitors) const;
  /// The branch with this equilibrium.
  std::string branch_with_state(double parameter, const Eigen::VectorXd& state) const;

 private:
  std::string branch_at(const CataloguedSection& like, double parameter, const Eigen::VectorXd& numbers) const;

  std::vector<CataloguedSection> sections_;
};

}  // namespace tchat
