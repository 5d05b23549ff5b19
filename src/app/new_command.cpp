#include "app/new_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "new_problem/problem_template.hpp"

namespace tchat {

namespace {

int create(const std::string& path) {
  const std::vector<NewFile> files = create_problem(path);
  fmt::print("{} is a driven mass with a wall on one side, to be changed into your own system:\n", path);
  for (const NewFile& file : files) fmt::print("  {}\n", file.name);
  fmt::print(
      "\nTry it:   cd {} && make\nThen edit the .cpp file; `tchat check` compares its derivatives, `tchat simulate` "
      "finds orbits to\n"
      "start from, `tchat constants` explains the constants file; src/docs/tutorial.md goes through a study.\n",
      path);
  return 0;
}

}  // namespace

void add_new_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("new", "a problem to start from: plugin, constants, data, Makefile that run");
  const auto path = std::make_shared<std::string>();
  command->add_option("NAME", *path, "the new folder NAME gets NAME.cpp, NAME.dat, gc.NAME and a Makefile")->required();
  command->footer("Example: tchat new two_walls && make -C two_walls");
  command->callback([&chosen, path] { chosen = [path] { return create(*path); }; });
}

}  // namespace tchat
