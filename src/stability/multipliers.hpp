/// The multipliers of a point of a branch, however they are computed.
#pragma once

#include <algorithm>
#include <complex>
#include <span>
#include <vector>

namespace tchat {

/// What is printed for a multiplier that is infinite (grazing) or too large for files.
inline constexpr double infinite_multiplier = 1e99;

/// det(1 - t M) a_1 ... a_m, see floquet_multipliers.hpp.
struct MultiplierProduct {
  double value = 0.0;
  /// What errors of the size `no_transversality` make of it where an a_s is about zero; 0 elsewhere.
  double uncertainty = 0.0;
};

struct FloquetMultipliers {
  /// n multipliers, the structural zero among them: the one closest to 1 first, then by | |mu| - 1 |. Of an orbit
  /// without a section the trivial one stands before these, in place of the zero.
  std::vector<std::complex<double>> values;
  bool has_trivial = false;
  int of_conserved = 0;     ///< how many more are 1 on every orbit; they come after the trivial one
  double structural = 0.0;  ///< size of the structural zero, or distance of the trivial one from 1
  bool valid = false;       ///< false: not computed, or the eigenvalue iteration failed
  /// They are the eigenvalues of f_x at an equilibrium (equilibrium_eigenvalues.hpp): stable on the left of the
  /// imaginary axis.
  bool are_eigenvalues = false;
  /// Nontrivial multipliers that are left out of `values`: where h_x f = 0 they may be 0/0, and what comes out is
  /// noise.
  int undetermined = 0;
  MultiplierProduct with_one = {};        ///< t = 1: vanishes with a multiplier +1
  MultiplierProduct with_minus_one = {};  ///< t = -1: vanishes with a multiplier -1

  /// How many are the same for every orbit, besides the structural zero.
  int known() const { return (has_trivial ? 1 : 0) + of_conserved; }
  /// All but those; the structural zero is among them.
  std::span<const std::complex<double>> nontrivial() const {
    return std::span(values).subspan(std::min(values.size(), static_cast<std::size_t>(known())));
  }
  bool determined() const { return valid && undetermined == 0; }

  /// All |mu| <= 1 + 1e-5 of those that are known; of eigenvalues all real parts <= 0 but for rounding.
  bool stable() const;
  int stable_count() const;
};

}  // namespace tchat
