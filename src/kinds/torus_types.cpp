/// The problem types of invariant tori (IPS = 182) and of tori in grazing contact (IPS = 152): the equations are those
/// of orbit/torus_system.hpp (dissertation, 2.4, 3.3, 4.3). rho may be one of the free parameters.
#include "kinds/families.hpp"
#include "kinds/problem_types.hpp"
#include "run/branch_setup.hpp"
#include "run/torus_start.hpp"

namespace tchat {

namespace {

ProblemFacts torus_facts(const ProblemId& id, const char* solutions, const char* title, int free_parameters) {
  return {.number = id.number,
          .branch_mode = id.branch_mode,
          .curve = 0,
          .family = torus_family,
          .solutions = solutions,
          .title = title,
          .free_parameters = free_parameters,
          .in_two_parameters = free_parameters > 2,  // a family has two itself, rho among them
          .switches_branch = id.branch_mode < 0};
}

}  // namespace

std::vector<const ProblemType*> torus_types() {
  static const TorusProblem tori(torus_facts(invariant_torus, "invariant tori",
                                             "invariant tori, rho and one parameter free, or two with rho fixed", 2),
                                 free_torus);
  ProblemFacts births_at_torus =
      torus_facts(torus_birth, "invariant tori", "the torus that is born at a TR label of periodic orbits", 2);
  births_at_torus.starts_from = periodic_orbit.number;
  births_at_torus.start_words = "'ICP=[{},rho]'";
  static const SwitchRow births(births_at_torus, {PointType::torus}, begin_torus);
  ProblemFacts grazing =
      torus_facts(grazing_torus, "invariant tori in grazing contact",
                  "invariant tori in grazing contact, rho and two parameters free, or three with rho fixed", 3);
  grazing.stability = StabilityMeaning::without_contact;
  static const TorusProblem in_contact(grazing, touching_torus);
  return {&tori, &births, &in_contact};
}

}  // namespace tchat
