#include "kinds/problem_types.hpp"

namespace tchat {

std::span<const ProblemType* const> problem_types() {
  static const std::vector<const ProblemType*> all = [] {
    std::vector<const ProblemType*> list;
    for (const auto& types :
         {periodic_orbit_types(), grazing_types(), torus_types(), boundary_value_types(), equilibrium_types()})
      list.insert(list.end(), types.begin(), types.end());
    return list;
  }();
  return all;
}

}  // namespace tchat
