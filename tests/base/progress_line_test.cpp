// The line on a terminal that shows progress.
#include <catch2/catch.hpp>
#include <sstream>
#include <thread>

#include "base/messages.hpp"

using namespace tchat;

TEST_CASE("the line is renewed in place, and nothing of it is left") {
  std::ostringstream terminal;
  {
    ProgressLine line(&terminal);
    line.clear();
    CHECK(terminal.str().empty());
    line.show("1 of 2");
    CHECK_THAT(terminal.str(), Catch::EndsWith("1 of 2") && !Catch::Contains("\n"));
  }
  CHECK_THAT(terminal.str(), Catch::EndsWith("\r\033[K"));
}

TEST_CASE("a text is due after half a second, and never without a terminal") {
  std::ostringstream terminal;
  ProgressLine line(&terminal);
  ProgressLine none(nullptr);
  CHECK_FALSE(line.is_due());
  std::this_thread::sleep_for(std::chrono::milliseconds(520));
  CHECK(line.is_due());
  CHECK_FALSE(none.is_due());
  line.show("1 of 2");
  CHECK_FALSE(line.is_due());
}
