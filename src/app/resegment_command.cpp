#include "app/resegment_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>

#include "base/user_error.hpp"
#include "base/warnings.hpp"
#include "base/words.hpp"
#include "resegment/resegment.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

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

}  // namespace tchat
