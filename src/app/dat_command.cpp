#include "app/dat_command.hpp"

#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "app/problem_argument.hpp"
#include "start/data_conversion.hpp"

namespace tchat {

void add_dat_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("dat", "starting data NAME.dat as label 1 of q.NAME");
  const auto request = std::make_shared<RunRequest>();
  command->add_option("NAME", request->name, "reads NAME.dat, gc.NAME and the plugin NAME; writes q.NAME")->required();
  command->add_option("-c,--constants", request->constants, "take dimension, signature and mesh from gc.C")
      ->type_name("C");
  command->add_option("-p,--problem", request->problem, "plugin P.so, or P.cpp, P.tch to compile if newer")
      ->type_name("P");
  command->add_option("-d,--data", request->data, "read D.dat")->type_name("D");
  command->add_option("-o,--output", request->output, "write q.O")->type_name("O");
  command->add_option("KEY=VALUE", request->overrides, "constants and parameters, as for tchat run");
  command->callback([&chosen, request] {
    chosen = [request] {
      take_source_as_problem(request->name, request->problem);
      fmt::print("{} written, label 1\n", convert_data(*request, std::cerr));
      return 0;
    };
  });
}

}  // namespace tchat
