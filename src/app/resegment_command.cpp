#include "app/resegment_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>

#include "constants/constant_value.hpp"
#include "resegment/resegment.hpp"
#include "setup/warnings.hpp"
#include "text/user_error.hpp"
#include "text/words.hpp"

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
  CLI::App* command = app.add_subcommand(
      "resegment", "starting data and constants where the signature changes: at grazing, rotated, doubled");
  const auto request = std::make_shared<ResegmentRequest>();
  const auto kind = std::make_shared<std::string>();
  const auto quiet = std::make_shared<bool>(false);
  command->add_option("FILE", request->solutions, "q-file; `mems` is taken for q.mems when there is no file mems")
      ->required();
  command->add_option("LABEL", request->label, "label number, or a type with its count: GR1, UZ2, PD1")->required();
  command
      ->add_option("--to", *kind,
                   "what the new run is to continue: grazing-curve, impacting, signature, rotate or double")
      ->required();
  command->add_option("-o,--output", request->output, "write q.O and gc.O")->type_name("O")->required();
  command->add_option("-p,--problem", request->problem, "plugin P.so, P.cpp or P.tch (default: the name of the q-file)")
      ->type_name("P");
  command
      ->add_option("-c,--constants", request->constants,
                   "constants of the run that wrote the label (default: its r-file)")
      ->type_name("C");
  command->add_option("--signature", request->signature,
                      "index vectors of the new orbit, as \"1,1,1;2,2,2\"; those beyond the segments that there are "
                      "are segments of zero duration after the contact");
  command->add_option("--jump", request->jump,
                      "jump at the contact (default: the identity on a grazing curve, else what the problem says of "
                      "that event, or GRJUMP)");
  command->add_option("--contact", request->contact,
                      "--to impacting: the index vector beyond a surface where another field holds, as 2,2,1 (default: "
                      "what the problem's index jump function says)");
  command
      ->add_option("--repeat", request->repeats,
                   "--to impacting: the orbit N times over, with an impact in the first period only")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--by", request->rotation, "segments that --to rotate moves from the beginning to the end")
      ->capture_default_str();
  command->add_flag("-q,--quiet", *quiet, "no summary on the screen");
  command->add_flag("--dat", request->data, "write O.dat instead of q.O");
  command->add_option("KEY=VALUE", request->overrides, "constants for gc.O, e.g. ICP=[1,61,62] DS=0.01 NMX=50");
  command->footer(
      "From a grazing point (label GR, or any label of a grazing curve):\n"
      "  --to grazing-curve   the segment is cut at the contact and ends there (IPS 150)\n"
      "  --to impacting       it ends there in the event's own jump; what must follow an impact at once becomes "
      "segments\n"
      "                       of zero duration (--signature, or the problem's index jump function); with --repeat N\n"
      "                       in the first of N periods only\n"
      "A Poincare section that the contact lies on is replaced. From any label:\n"
      "  --to signature       the same orbit with --signature: where two events come at once they change places, "
      "segments\n"
      "                       of zero duration vanish or appear; where a contact that another field holds in is lost, "
      "the\n"
      "                       segments before and after it are joined (--signature may be left out)\n"
      "  --to rotate          the cyclic order of segments: another one first\n"
      "  --to double          the signature twice; from a PD label the run switches to the doubled orbit\n"
      "Example: tchat resegment q.to_grazing GR1 --to impacting -o born -p mems ICP=[1,61,62]\n"
      "         tchat run mems -c born -s born -o impacting");
  command->callback([&chosen, request, kind, quiet] {
    chosen = [request, kind, quiet] { return do_resegment(*request, *kind, *quiet); };
  });
}

}  // namespace tchat
