// The commands of an exploration as data and as a user would type them.
#include "explore/exploration_commands.hpp"

#include <catch2/catch.hpp>

#include "support/temporary_folder.hpp"
#include "support/van_der_pol.hpp"

using namespace tchat;

TEST_CASE("one direction of a switch that goes in both") {
  const test_support::TemporaryFolder place;
  ExploreRequest request;
  request.name = "osc";
  request.over = "1=0:1";
  request.output = place.file("osc");
  request.overrides = {"DS=0.01", "NMX=7"};
  const std::string folder = *request.output;
  const ExplorationCommands commands(request, test::system_of<test::VanDerPol>(), false, {{"osc.tch"}, {}});
  const auto made = [&](const std::string& name) {
    const Command run{"run", "osc", "-s", folder + "/b1", "-o", folder + "/" + name};
    return commands.switching(name, {"b1", 4, "BP", {run}});
  };
  const CommandJob both = made("b4");
  REQUIRE(ExplorationCommands::goes_in_both_directions(both));
  const CommandJob forward = commands.one_direction(made("b5"), std::nullopt);
  CHECK(forward.name == "b5");
  CHECK(shell_line(forward.commands) == "tchat run osc -s " + folder + "/b1 -o " + folder + "/b5 --clip DS=0.01 NMX=7");
  CHECK(forward.outputs.front() == folder + "/p.b5");
  CHECK(forward.given == std::vector<std::string>{"osc.tch"});
  const CommandJob backward = commands.one_direction(made("b6"), -0.01);
  CHECK(shell_line(backward.commands) ==
        "tchat run osc -s " + folder + "/b1 -o " + folder + "/b6 --clip NMX=7 DS=-0.01");
  CHECK(backward.inputs == both.inputs);
  CHECK_FALSE(ExplorationCommands::goes_in_both_directions(backward));
  CHECK(commands.limits_points());
  CHECK(shell_line(ExplorationCommands::with_points(forward, 28).commands).ends_with(" --clip DS=0.01 NMX=28"));
}

TEST_CASE("a word that the shell would split or expand is one word") {
  CHECK(shell_line(Command{"run", "my ball", "UZR={r:[1,2]}", "it's"}) ==
        "tchat run 'my ball' 'UZR={r:[1,2]}' 'it'\\''s'");
  CHECK(shell_line(Commands{}) == "");
  CHECK(shell_line(Commands{{"a"}, {"b"}}) == "tchat a && tchat b");
}
