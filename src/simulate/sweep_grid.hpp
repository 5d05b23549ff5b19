/// The values of a sweep: one or two swept quantities, and the order in which they are counted.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"
#include "simulate/sweep_file.hpp"

namespace tchat {

/// A swept quantity and where its values go.
struct SweepTarget {
  SweptQuantity quantity;
  int position = 1;  ///< index of the parameter or state, from 1
};

/// "mu" of "PAR(mu)", or of "mu".
std::string bare_name(const std::string& name);

/// "mu=-0.82:-0.79:301", "PAR(1)=...", "x1=-2:2:400", a parameter's name before a state's. Throws UserError, one
/// sentence with the cure.
SweepTarget parse_over(const HybridSystem& system, const std::string& text);

/// Both, which must differ; at most ten million values. Throws UserError.
std::vector<SweepTarget> parse_overs(const HybridSystem& system, const std::vector<std::string>& texts);

/// Writes the values of the swept quantities, in their order, into a state and PAR.
void set_swept_values(const std::vector<SweepTarget>& over, const Eigen::VectorXd& values, Eigen::VectorXd& state,
                      Eigen::VectorXd& par);

class SweepGrid {
 public:
  explicit SweepGrid(const std::vector<SweptQuantity>& over) : over_(over) {}

  const std::vector<SweptQuantity>& over() const { return over_; }
  std::size_t size() const;
  /// Values of the first quantity: of a chain of neighbours.
  std::size_t chain_length() const { return static_cast<std::size_t>(over_.front().count); }
  std::size_t chains() const { return size() / chain_length(); }
  /// The first quantity runs fastest.
  Eigen::VectorXd values(std::size_t index) const;

 private:
  std::vector<SweptQuantity> over_;
};

}  // namespace tchat
