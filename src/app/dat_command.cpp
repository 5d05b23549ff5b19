#include "app/dat_command.hpp"

#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "app/problem_argument.hpp"
#include "run/data_start.hpp"

namespace tchat {

void add_dat_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("dat", "convert NAME.dat to label 1 of q.NAME");
  const auto request = std::make_shared<RunRequest>();
  command->add_option("NAME", request->name, "problem NAME.cpp or NAME.tch; reads NAME.dat, gc.NAME; writes q.NAME")
      ->required();
  command->add_option("-c,--constants", request->constants, "dimension, signature and mesh from gc.C [gc.NAME]")
      ->type_name("C");
  command->add_option("-p,--problem", request->problem, "problem P.cpp, P.tch, P.f or P.so [NAME]")->type_name("P");
  command->add_option("-d,--data", request->data, "read D.dat [NAME.dat]")->type_name("D");
  command->add_option("-o,--output", request->output, "write q.O [q.NAME]")->type_name("O");
  command->add_option("KEY=VALUE", request->overrides, "constants and parameters, as for tchat run");
  command->footer("Example: tchat dat linosc -c impacting -d impacting -o start");
  command->callback([&chosen, request] {
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      fmt::print("{} written, label 1\n", convert_data(*request, std::cerr));
      return 0;
    };
  });
}

}  // namespace tchat
