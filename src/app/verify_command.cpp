#include "app/verify_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <sstream>

#include "verification/verify_solutions.hpp"

namespace tchat {

namespace {

int do_verify(const VerifyRequest& request, bool quiet) {
  std::ostringstream unseen;
  std::ostream& screen = quiet ? static_cast<std::ostream&>(unseen) : std::cout;
  return verify_solutions(request, screen, quiet ? unseen : std::cerr) ? 0 : 1;
}

}  // namespace

void add_verify_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("verify", "labelled orbits of a q-file against forward integration, event by event");
  const auto request = std::make_shared<VerifyRequest>();
  const auto quiet = std::make_shared<bool>(false);
  command->add_option("FILE", request->solutions, "q-file; `mems` is taken for q.mems when there is no file mems")
      ->required();
  command->add_option("LABELS", request->labels, "label numbers, or types with a count: PD1, GR1 (default: all)");
  command->add_option("-p,--problem", request->problem, "plugin P.so, P.cpp or P.tch (default: the name of the q-file)")
      ->type_name("P");
  command
      ->add_option("-c,--constants", request->constants,
                   "constants of the run that wrote the q-file (default: its r-file)")
      ->type_name("C");
  command->add_option("--tolerance", request->tolerance, "largest defect that passes")->capture_default_str();
  command->add_flag("-q,--quiet", *quiet, "nothing on the screen: the exit status tells");
  command->footer(
      "CVODES integrates every segment from its stored start, with all events watched that end or forbid it. Columns:\n"
      "  STATE     distance of the end from the stored one, and of the state after the jump from the next start,\n"
      "            relative to the largest size of each state on the orbit\n"
      "  TIME      between the stored end and the event, relative to the period\n"
      "  GROWTH    how errors of the start grow along the segment, |Phi|\n"
      "  MULTIPL.  largest difference of the multipliers (variational equations, saltation) from those of the d-file\n"
      "  CRITICAL  distance of a multiplier from that which the label must have: +1 of LP and BP, -1 of PD, of modulus "
      "1\n"
      "            with the stored angle of TR, +1 or -1 of GC; also along curves of folds, doublings and tori\n"
      "  EVENT     the one that ends the segment; others that are met before\n"
      "Of a torus there is a row for each segment of the return, the worst over returns from all its phases and from\n"
      "those half way between them; STATE counts how far from the curve, a rotation further, they come back.\n"
      "Exit status: 0 when all defects are below the tolerance, 1 when not. Where errors grow by more than a thousand\n"
      "times the tolerance is 1e-9 GROWTH. Points that the run itself has marked inadmissible pass as such.\n"
      "Example: tchat verify q.impacting PD1 LP1 -p mems");
  command->callback([&chosen, request, quiet] { chosen = [request, quiet] { return do_verify(*request, *quiet); }; });
}

}  // namespace tchat
