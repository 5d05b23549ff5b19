#include "app/commands.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <CLI/Validators.hpp>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>

#include "app/command_options.hpp"
#include "base/messages.hpp"
#include "base/words.hpp"
#include "explore/explorer.hpp"
#include "maps/analyse_grazing.hpp"
#include "resegment/resegment.hpp"
#include "run/run_problem.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

int do_run(const RunRequest& request) {
  std::ostream* const progress = ::isatty(STDERR_FILENO) != 0 && !request.quiet ? &std::cerr : nullptr;
  return run_interruptibly([&](const std::function<bool()>& interrupted) {
    return run_problem(request, std::cout, std::cerr, interrupted, progress);
  });
}

}  // namespace

void add_run_options(CLI::App& command, RunRequest& request) {
  command.add_option("-c,--constants", request.constants, "constants gc.C, or a path [gc.NAME]")->type_name("C");
  command.add_option("-p,--problem", request.problem, "problem P.cpp, P.tch, P.f or P.so [NAME]")->type_name("P");
  command.add_option("-d,--data", request.data, "start from D.dat, or a path [NAME.dat]")->type_name("D");
  command.add_option("-s,--start", request.start, "restart from the label IRS of q.S [q.NAME if IRS > 0]")
      ->type_name("S");
  command.add_option("-o,--output", request.output, "write p.O q.O d.O r.O [NAME]")->type_name("O");
  command.add_flag("-q,--quiet", request.quiet, "print no table and no summary");
  command.add_flag("--both", request.both_directions, "both directions of DS, each a branch of its own");
  command.add_flag("--append", request.append, "add to the files instead of replacing them");
  command.add_flag("--clip", request.clip, "end on RL0, RL1, A0, A1, not at the first point beyond them");
  command.add_flag("--strict", request.strict, "exit status 3 if a branch ends by MX");
  command
      .add_option("-j,--jobs", request.threads,
                  "threads for the linear algebra of large problems; they do not change the files")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command.add_option("KEY=VALUE", request.overrides,
                     "constants and parameters, as DS=-0.01 IRS=PD1 'PAR(omega)=0.8' 'UZR={1: [2.5, 3.0]}'");
}

void add_run_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("run", "compute a branch of orbits");
  const auto request = std::make_shared<RunRequest>();
  command
      ->add_option("NAME", request->name,
                   "problem NAME.cpp or NAME.tch; reads gc.NAME, NAME.dat; writes p.NAME q.NAME d.NAME r.NAME")
      ->required();
  add_run_options(*command, *request);
  command->footer(
      "The table shows the first point, special points, and where orbits become inadmissible; p.O has all.\n"
      "Example: tchat run linosc -c impacting -d impacting -o up NMX=50\n"
      "Exit status: 0 a branch was computed, even if it ended by MX; 1 no convergence at the first point\n"
      "or step; 2 bad usage or input; 3 ended by MX with --strict; 4 nothing begins at the label; 130 or 143\n"
      "interrupted (complete files).");
  command->callback([&chosen, request] {
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      return do_run(*request);
    };
  });
}

namespace {

ResegmentKind resegment_kind(const std::string& text) {
  const std::map<std::string, ResegmentKind> kinds{{"grazing-curve", ResegmentKind::grazing_curve},
                                                   {"impacting", ResegmentKind::impacting},
                                                   {"signature", ResegmentKind::signature},
                                                   {"rotate", ResegmentKind::rotate},
                                                   {"double", ResegmentKind::repeat}};
  if (const auto found = kinds.find(text); found != kinds.end()) return found->second;
  throw UserError(fmt::format(
      "--to {}: there is no such kind; allowed: grazing-curve, impacting, signature, rotate, double", in_quotes(text)));
}

int do_resegment(ResegmentRequest request, const std::string& kind, bool quiet) {
  request.kind = resegment_kind(kind);
  std::ostringstream unseen;
  std::ostream& screen = quiet ? static_cast<std::ostream&>(unseen) : std::cout;
  print_warnings(std::cerr, resegment(request, screen, quiet ? screen : std::cerr));
  return 0;
}

}  // namespace

void add_resegment_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("resegment", "start a run with another signature: at grazing, rotated, doubled");
  const auto request = std::make_shared<ResegmentRequest>();
  const auto kind = std::make_shared<std::string>();
  const auto quiet = std::make_shared<bool>(false);
  command->add_option("FILE", request->solutions, "q-file; `mems` means q.mems")->required();
  command->add_option("LABEL", request->label, "label, as 5, GR1 or PD1")->required();
  command->add_option("--to", *kind, "grazing-curve, impacting, signature, rotate or double, see below")->required();
  command->add_option("-o,--output", request->output, "write q.O and gc.O")->type_name("O")->required();
  command->add_option("-p,--problem", request->problem, "problem P.cpp, P.tch, P.f or P.so [the name of the q-file]")
      ->type_name("P");
  command->add_option("-c,--constants", request->constants, "constants of the run that wrote the label [its r-file]")
      ->type_name("C");
  command->add_option("--signature", request->signature,
                      "index vectors of the new orbit, as '1,1,1;2,2,2'; additional ones are segments of zero duration "
                      "after the contact");
  command->add_option("--jump", request->jump,
                      "jump at the contact [identity on a grazing curve, else the problem's, or GRJUMP]");
  command->add_option("--contact", request->contact,
                      "impacting: index vector beyond a surface where the field changes, as 2,2,1 [the problem's]");
  command->add_option("--repeat", request->repeats, "impacting: so many periods, with an impact in the first only")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--by", request->rotation, "rotate: number of segments to move from the start to the end")
      ->capture_default_str();
  command->add_flag("-q,--quiet", *quiet, "print no summary");
  command->add_flag("--dat", request->data, "write O.dat instead of q.O");
  command->add_option("KEY=VALUE", request->overrides, "constants for gc.O, as ICP=[1,61,62] NMX=50");
  command->footer(
      "From a grazing point (label GR, or any label of a grazing curve):\n"
      "  --to grazing-curve  the segment ends at the contact, with the identity jump (IPS 150)\n"
      "  --to impacting      the segment ends at the contact, with the event's jump\n"
      "From any label:\n"
      "  --to signature      the same orbit with the index vectors of --signature\n"
      "  --to rotate         another segment first\n"
      "  --to double         the signature twice; from PD, the run switches to the doubled orbit\n"
      "Example: tchat resegment q.to_grazing GR1 --to impacting -o born -p mems ICP=[1,61,62]\n"
      "         tchat run mems -c born -s born -o impacting");
  command->callback([&chosen, request, kind, quiet] {
    chosen = [request, kind, quiet] { return do_resegment(*request, *kind, *quiet); };
  });
}

namespace {

int do_explore(const ExploreRequest& request) {
  std::ostream* const progress = ::isatty(STDERR_FILENO) != 0 && !request.quiet ? &std::cerr : nullptr;
  return run_interruptibly(
      [&](const std::function<bool()>& interrupted) { return explore(request, interrupted, std::cout, progress); });
}

}  // namespace

void add_explore_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("explore", "the whole diagram over a parameter: attractors, branches, switches");
  const auto request = std::make_shared<ExploreRequest>();
  command->add_option("NAME", request->name, "problem NAME.cpp or NAME.tch")->required();
  command->add_option("-c,--constants", request->constants, "constants of the simulations from gc.C")->type_name("C");
  command->add_option("-p,--problem", request->problem, "problem P.cpp, P.tch, P.f or P.so [NAME]")->type_name("P");
  command
      ->add_option("-o,--output", request->output,
                   "folder of the files; O.txt, O.json, O.png, O.svg, O.html, Makefile.O [NAME.diagram]")
      ->type_name("O");
  command->add_option("--over", request->over, "range of the parameter, and the number of values of the sweep [201]")
      ->required()
      ->type_name("P=FROM:TO[:COUNT]");
  command->add_option("--and", request->second, "range of a second parameter: curves of the special points in both")
      ->type_name("Q=FROM:TO");
  command->add_option("--state", request->states, "initial state of the sweep, as 0,0.1,-2; may be repeated")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("-y", request->quantity, "y-axis of the picture [the max(X) that varies most]")
      ->type_name("QUANTITY");
  command->add_option("-j,--jobs", request->workers, "commands at a time; they do not change the result")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->capture_default_str();
  command
      ->add_option("--starts", request->starts, "further initial states, from each of which every value is simulated")
      ->type_name("N")
      ->check(whole_number(0, 1000))
      ->capture_default_str();
  command->add_option("--segments", request->segments, "most segments of a signature that is followed")
      ->type_name("N")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  command->add_option("--doublings", request->doublings, "period doublings to follow, one after the other")
      ->type_name("N")
      ->check(whole_number(0, 16))
      ->capture_default_str();
  command->add_option("--branches", request->branches, "most branches; with --and, most curves too")
      ->type_name("N")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  command
      ->add_option("--returns", request->returns,
                   "at grazing, orbits with one impact in up to K returns [1; 4 where xi_n = 0 on a grazing curve]")
      ->type_name("K")
      ->check(whole_number(1, 64));
  command->add_option("--time", request->seconds, "seconds after which no command is begun; the same command goes on")
      ->type_name("T")
      ->check(CLI::PositiveNumber);
  command->add_flag("--tori", request->tori, "follow the tori that are born at TR");
  command->add_flag("-q,--quiet", request->quiet, "print nothing");
  command->add_option("KEY=VALUE", request->overrides,
                      "parameters of all commands, constants of the runs, as 'PAR(omega)=0.8' NMX=100");
  command->footer(
      "A sweep finds attractors. Each is followed in both directions, and at special points the command\n"
      "that `tchat run` proposes follows what begins there, until nothing new is found.\n"
      "With --and, each special point is then followed as a curve in both parameters.\n"
      "All commands are in Makefile.O, which makes the same files without tchat explore.\n"
      "Example: tchat explore linosc --over alpha=1.5:4 'PAR(omega)=2.0072' -j 2\n"
      "Exit status: 0 branches were found, 1 none, 2 bad usage or input, 130 or 143 interrupted.");
  command->callback([&chosen, request] {
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      return do_explore(*request);
    };
  });
}

namespace {

void add_options(CLI::App& command, GrazingRequest& request) {
  command.add_option("NAME", request.name, "q-file (`mems` means q.mems); with --state, the problem")->required();
  command.add_option("LABEL", request.label, "label in contact, as GR1, or any label of a grazing curve");
  command.add_option("-p,--problem", request.problem, "problem P.cpp, P.tch, P.f or P.so [the name of the q-file]")
      ->type_name("P");
  command.add_option("-c,--constants", request.constants, "constants of the run that wrote the label [its r-file]")
      ->type_name("C");
  command.add_option("--jump", request.jump, "jump at the contact [the problem's, or GRJUMP]");
  command.add_option("--parameter", request.parameter, "parameter that brings the orbit into contact [first of ICP]");
  command
      .add_option("--section", request.section,
                  "section P' of a second map: an event function, or a state that is constant on it [the orbit's "
                  "section, if the contact is on it]")
      ->type_name("J");
  command.add_option("--xi", request.returns, "number of xi_n")->check(CLI::Range(1, 10000))->capture_default_str();
  command.add_option("--born", request.born, "list impacting orbits with one impact in up to so many returns")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--penetration", request.penetration, "largest penetration of the comparison with the exact map")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  const char* const group = "A contact given by hand, as on a torus";
  command.add_option("--state", request.state, "the state x*, as 0,0.1,-2 or x1=0.1,x2=3")->group(group);
  command.add_option("--mode", request.mode, "field, event function in contact, jump, as 1,1,1")->group(group);
  command.add_flag("--correct", request.correct, "move to the nearest state with h_D = h_P = 0")->group(group);
  command.add_option("KEY=VALUE", request.overrides, "parameters, as 'PAR(mu)=0.8'")->group(group);
}

}  // namespace

void add_grazing_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("grazing", "analyse a grazing contact: discontinuity map, xi_n, verdict, impacting orbits");
  const auto request = std::make_shared<GrazingRequest>();
  add_options(*command, *request);
  command->footer(
      "Prints the contact x* with a*, beta, B, A and xi_n; the discontinuity map beside the exact map; the\n"
      "verdict whether an attractor persists near grazing (continuous) or not (discontinuous); the impacting\n"
      "orbits that are born.\n"
      "Example: tchat grazing q.to_grazing GR1 -p linosc\n"
      "Exit status: 0 done, 1 the orbit cannot be integrated or the map not computed, 2 bad usage or input.");
  command->callback([&chosen, request] {
    if (request->label && request->label->find('=') != std::string::npos) {  // an override behind a problem's name
      request->overrides.insert(request->overrides.begin(), *request->label);
      request->label.reset();
    }
    chosen = [request] {
      if (request->state) take_source_as_problem(request->name, request->problem);
      analyse_grazing(*request, std::cout, std::cerr);
      return 0;
    };
  });
}

}  // namespace tchat
