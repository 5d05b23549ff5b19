#include "app/new_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "app/problem_template.hpp"

namespace tchat {

namespace {

int translate(const std::string& path, const std::string& formulas) {
  const std::vector<NewFile> files = create_problem(path, formulas);
  fmt::print("{} is {} in C++, to be changed from here on:\n", path, formulas);
  for (const NewFile& file : files) fmt::print("  {}\n", file.name);
  const std::string name = files.front().name.substr(0, files.front().name.rfind('.'));
  fmt::print("\nTry it:   cd {0} && tchat simulate {1} --dat found && tchat run {1} -c found -d found -o found\n", path,
             name);
  return 0;
}

int create(const std::string& path) {
  const std::vector<NewFile> files = create_problem(path);
  fmt::print("{} is a driven mass with a wall on one side, to be changed into your own system:\n", path);
  for (const NewFile& file : files) fmt::print("  {}\n", file.name);
  fmt::print(
      "\nTry it:   cd {} && make\nThen edit the .cpp file; `tchat check` compares its derivatives, `tchat simulate` "
      "finds orbits to\n"
      "start from, `tchat constants` explains the constants file; the page tutorial.md of the\n"
      "documentation goes through a study.\n",
      path);
  return 0;
}

}  // namespace

void add_new_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("new", "create a problem: plugin, constants, data, Makefile");
  const auto path = std::make_shared<std::string>();
  command->add_option("NAME", *path, "new folder, with NAME.cpp, NAME.dat, gc.NAME and a Makefile")->required();
  command->footer("Example: tchat new two_walls && make -C two_walls");
  const auto formulas = std::make_shared<std::string>();
  command->add_option("--from", *formulas, "translate this file of formulas to NAME.cpp")->type_name("FILE.tch");
  command->callback([&chosen, path, formulas] {
    chosen = [path, formulas] { return formulas->empty() ? create(*path) : translate(*path, *formulas); };
  });
}

}  // namespace tchat
