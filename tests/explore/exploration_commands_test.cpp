// The commands of an exploration as a user would type them.
#include "explore/exploration_commands.hpp"

#include <catch2/catch.hpp>

#include "support/van_der_pol.hpp"

using namespace tchat;

TEST_CASE("one direction of a switch that goes in both") {
  ExploreRequest request;
  request.name = "osc";
  request.over = "1=0:1";
  request.output = "my osc";
  request.overrides = {"DS=0.01", "NMX=7"};
  const ExplorationCommands commands(request, test::system_of<test::VanDerPol>(), false);
  const CommandJob both = commands.switching({"a1", 4, "BP", 0.5, "tchat run osc -s 'my osc/a1' -o 'my osc/a1_BP4'"});
  REQUIRE(ExplorationCommands::goes_in_both_directions(both));
  const CommandJob forward = commands.one_direction(both, std::nullopt);
  CHECK(forward.name == "a1_BP4_forward");
  CHECK(forward.lines.back() == "tchat run osc -s 'my osc/a1' -o 'my osc/a1_BP4_forward' --clip DS=0.01 NMX=7");
  CHECK(forward.outputs.front() == "my osc/p.a1_BP4_forward");
  const CommandJob backward = commands.one_direction(both, -0.01);
  CHECK(backward.lines.back() == "tchat run osc -s 'my osc/a1' -o 'my osc/a1_BP4_backward' --clip NMX=7 DS=-0.01");
  CHECK(backward.inputs == both.inputs);
  CHECK_FALSE(ExplorationCommands::goes_in_both_directions(backward));
}
