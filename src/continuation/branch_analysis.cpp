#include "continuation/branch_analysis.hpp"

namespace tchat {

SpecialPoint BranchAnalysis::shrunk(const Orbit&) const { return {}; }

std::string BranchAnalysis::start_advice(const Orbit&) const {
  return "The largest ones say which part of the start, of the parameters or of the signature is wrong; a better "
         "start, a larger NTST or ITNW may help.";
}

}  // namespace tchat
