#include "app/verify_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <sstream>

#include "kinds/verify_solutions.hpp"

namespace tchat {

namespace {

int do_verify(const VerifyRequest& request, bool quiet) {
  std::ostringstream unseen;
  std::ostream& screen = quiet ? static_cast<std::ostream&>(unseen) : std::cout;
  return verify_solutions(request, screen, quiet ? unseen : std::cerr) ? 0 : 1;
}

}  // namespace

void add_verify_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("verify", "compare labelled orbits of a q-file with forward integration");
  const auto request = std::make_shared<VerifyRequest>();
  const auto quiet = std::make_shared<bool>(false);
  command->add_option("FILE", request->solutions, "q-file; `mems` means q.mems")->required();
  command->add_option("LABELS", request->labels, "labels, as 5, GR1 or PD1 [all]");
  command->add_option("-p,--problem", request->problem, "problem P.cpp, P.tch, P.f or P.so [the name of the q-file]")
      ->type_name("P");
  command->add_option("-c,--constants", request->constants, "constants of the run that wrote the q-file [its r-file]")
      ->type_name("C");
  command->add_option("--tolerance", request->tolerance, "largest defect that passes")->capture_default_str();
  command->add_flag("-q,--quiet", *quiet, "print nothing: the exit status is the result");
  command->footer(
      "CVODES integrates each segment from its stored start, and watches all events that end or forbid it.\n"
      "  STATE     error at the end and after the jump, relative to the size of each state\n"
      "  TIME      error of the time of the event, relative to the period\n"
      "  GROWTH    growth of errors along the segment, |Phi|\n"
      "  MULTIPL.  largest difference of multipliers from those of the d-file\n"
      "  CRITICAL  distance of a multiplier from the value of the label: +1 for LP and BP, -1 for PD, the\n"
      "            stored angle for TR, +1 or -1 for GC\n"
      "  EVENT     the event that ends the segment; others that occur before it\n"
      "For a torus, rows have the worst of returns from all phases; STATE is the distance from the curve.\n"
      "The tolerance is at least 1e-9 GROWTH. Points that the run marked inadmissible pass.\n"
      "Example: tchat verify q.impacting PD1 LP1 -p mems\n"
      "Exit status: 0 all defects are below the tolerance, 1 some are not, 2 bad usage or input.");
  command->callback([&chosen, request, quiet] { chosen = [request, quiet] { return do_verify(*request, *quiet); }; });
}

}  // namespace tchat
