// tchat sweep refuses what it cannot use: exit status 2, one message with what is wrong and the cure.
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

TEST_CASE("sweep: bad options") {
  const Workspace workspace;
  for (const char* arguments : {"", "linosc --nosuch", "linosc --over alpha=1:2:3 -j 0",
                                "linosc --over alpha=1:2:3 -j x", "linosc --over alpha=1:2:3 --events 0",
                                "linosc --over alpha=1:2:3 --tolerance 1", "linosc --over alpha=1:2:3 --lyapunov -1"}) {
    INFO("tchat sweep " << arguments);
    check_refused(workspace.tchat(std::string("sweep ") + arguments), {"--help"});
  }
  const Outcome help = workspace.tchat("sweep --help");
  CHECK(help.status == 0);
  CHECK(contains(help.out, "tchat sweep linosc --over"));
}

TEST_CASE("sweep: what is swept") {
  const Workspace workspace;
  const auto refused = [&](const std::string& arguments, const std::vector<std::string>& parts) {
    INFO("tchat sweep linosc " << arguments);
    check_refused(workspace.tchat("sweep linosc " + arguments), parts);
    CHECK_FALSE(workspace.has("linosc.sweep"));
    CHECK_FALSE(workspace.has("linosc.sweep.journal"));
  };
  refused("", {"nothing to sweep over", "--over mu=-0.82:-0.79:301"});
  refused("--over alpha", {"--over alpha", "NAME=FROM:TO:COUNT"});
  refused("--over alpha=1:2", {"NAME=FROM:TO:COUNT"});
  refused("--over =1:2:3", {"NAME=FROM:TO:COUNT"});
  refused("--over alpha=1:2:x", {"COUNT 'x'", "whole number"});
  refused("--over alpha=1:2:0", {"COUNT '0'"});
  refused("--over alpha=1:2:3.5", {"COUNT '3.5'"});
  refused("--over alpha=nan:2:3", {"FROM 'nan'", "finite"});
  refused("--over alpha=1:inf:3", {"TO 'inf'", "finite"});
  refused("--over alpha=1:2:1", {"COUNT at least 2"});
  refused("--over alpha=1:1:2", {"FROM and TO are the same"});
  refused("--over gamma=1:2:3", {"PAR(gamma) is no parameter", "alpha, omega, zeta, r", "x1, x2, y1, y2"});
  refused("--over PAR(9)=1:2:3", {"PAR(9) is no parameter"});
  refused("--over PAR(61)=1:2:3", {"duration"});
  refused("--over alpha=1:2:3 --over alpha=1:3:4", {"the same quantity twice"});
  refused("--over alpha=1:2:3 --over PAR(1)=1:3:4", {"the same quantity twice"});
  refused("--over alpha=1:2:3 --over omega=1:2:3 --over r=0:1:3", {"3 times", "one or two"});
  refused("--over alpha=1:2:100000 --over omega=1:2:100000", {"1e+10 values", "1e+07"});
  refused("--over alpha=1:2:3 --follow sideways", {"--follow sideways", "up, down, both"});
  refused("--over x1=0:1:3 --follow up", {"x1 is an initial state", "along a parameter"});
  refused("--over alpha=1:2:3 --section 7", {"--section 7", "no such event function", "1 (wall)"});
  refused("--over alpha=1:2:3 --penetration floor", {"--penetration floor", "1 (wall)"});
  refused("--over alpha=1:2:3 --lyapunov 5", {"--lyapunov 5", "4 states"});
  refused("--over alpha=1:2:3 --state x1=0,q=1", {"no state 'q'"});
  refused("--over alpha=1:2:3 --state 0,0", {"2 values", "4 states"});
  refused("--over alpha=1:2:3 --mode 9,1,1", {"--mode 9,1,1"});
  refused("--over alpha=1:2:3 PAR(gamma)=1", {"gamma"});
  refused("--over alpha=1:2:3 --part 0/3", {"--part 0/3", "1 <= I <= N"});
  refused("--over alpha=1:2:3 --part 4/3", {"--part 4/3"});
  refused("--over alpha=1:2:3 --part 2", {"--part 2", "--part 3/7"});
  refused("--over alpha=1:2:3 --part 1/2 --gather", {"--part and --gather"});
  refused("--over alpha=1:2:3 --gather", {"no part linosc.sweep.1", "--part 1/N"});
  refused("--over alpha=1:2:3 -o nosuch/found", {"nosuch"});
  refused("--over alpha=1:2:3 -o ..", {"no name for output files"});
}

TEST_CASE("sweep: files in the way that are none of a sweep") {
  const Workspace workspace;
  workspace.write("taken.sweep.journal", "a diary\n");
  check_refused(workspace.tchat("sweep linosc --over alpha=1:2:3 -o taken"), {"taken.sweep.journal", "no journal"});
  CHECK(workspace.read("taken.sweep.journal") == "a diary\n");
  workspace.write("cut.sweep.1", "nothing\n");
  check_refused(workspace.tchat("sweep linosc --over alpha=1:2:3 -o cut --gather"), {"cut.sweep.1", "no journal"});
}

namespace {

/// A part's text with word `place` (from 0) of its first record replaced and the line's hash (FNV-1a) made right again.
std::string with_word(const std::string& text, std::size_t place, const std::string& word) {
  const std::string end_of_heading = "# end of heading\n";
  const std::size_t begin = text.find(end_of_heading) + end_of_heading.size();
  const std::size_t end = text.find('\n', begin);
  std::string line = text.substr(begin, text.rfind(' ', end) - begin);
  std::size_t at = 0;
  for (std::size_t k = 0; k < place; ++k) at = line.find(' ', at) + 1;
  line.replace(at, line.find(' ', at) - at, word);
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : line) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  std::ostringstream hexadecimal;
  hexadecimal << std::hex << std::setfill('0') << std::setw(16) << hash;
  return text.substr(0, begin) + line + " " + hexadecimal.str() + text.substr(end);
}

}  // namespace

TEST_CASE("sweep: a part or journal with numbers out of range is refused with file, line, number and cure") {
  const Workspace workspace;
  const std::string sweep = "sweep linosc --over alpha=2:6:5 PAR(zeta)=0.3 --section 1 -o cut ";
  REQUIRE(workspace.tchat(sweep + "--part 1/2").status == 0);
  REQUIRE(workspace.tchat(sweep + "--part 2/2").status == 0);
  const std::string part = workspace.read("cut.sweep.1");
  struct Forgery {
    std::size_t place;
    const char* word;
    const char* said;
  };
  // Words of a record: index, start, known attractor, kind, length of the signature, field, event, jump, ...
  for (const Forgery& forged :
       {Forgery{0, "1000000000", "index is 1000000000; allowed are 0 to 4"},
        Forgery{0, "-1", "index is -1; allowed are 0 to 4"}, Forgery{1, "7", "start is 7; allowed are 0 to 1"},
        Forgery{2, "999", "known is 999; allowed are 0 to 0"}, Forgery{2, "-1", "known is -1; allowed are 0 to 0"},
        Forgery{7, "3", "a jump in the signature is 3; allowed are 0 to 2"}}) {
    INFO(forged.said);
    workspace.write("cut.sweep.1", with_word(part, forged.place, forged.word));
    check_refused(workspace.tchat(sweep + "--gather"), {"cut.sweep.1:22: ", forged.said, "--part 1/2"});
    CHECK_FALSE(workspace.has("cut.sweep"));
    workspace.write("cut.sweep.1.journal", workspace.read("cut.sweep.1"));
    check_refused(workspace.tchat(sweep + "--part 1/2"), {"cut.sweep.1.journal:22: ", forged.said, "rm cut.sweep.1"});
    std::filesystem::remove(workspace.file("cut.sweep.1.journal"));
  }
  // What is no value of this part does not count, even if it is one of the sweep.
  workspace.write("cut.sweep.1", with_word(part, 0, "1"));
  check_refused(workspace.tchat(sweep + "--gather"), {"cut.sweep.1: it holds 2 of 3 values", "--part 1/2"});
  workspace.write("cut.sweep.1", with_word(part, 0, "0"));
  CHECK(workspace.tchat(sweep + "--gather").status == 0);
}

TEST_CASE("sweep: numbers of parts have a limit, and gathering does not wait for what is no file") {
  const Workspace workspace;
  const std::string sweep = "sweep linosc --over alpha=2:6:5 -o cut ";
  check_refused(workspace.tchat(sweep + "--part 1/2147483647"), {"--part 1/2147483647", "at most 100000 parts"});
  CHECK_FALSE(workspace.has("cut.sweep.1"));
  REQUIRE(mkfifo(workspace.file("cut.sweep.1").c_str(), 0600) == 0);
  check_refused(workspace.tchat(sweep + "--gather"), {"cut.sweep.1", "no file", "rm cut.sweep.1"});
  std::filesystem::remove(workspace.file("cut.sweep.1"));
  REQUIRE(workspace.tchat(sweep + "--part 1/100000").status == 0);
  const std::string part = workspace.read("cut.sweep.1");
  check_refused(workspace.tchat(sweep + "--gather"), {"99999 of 100000 parts are missing", "and 99979 more"});
  const std::size_t number = part.find("1 of 100000");
  REQUIRE(number != std::string::npos);
  workspace.write("cut.sweep.1", part.substr(0, number) + "1 of 2147483647" + part.substr(number + 11));
  check_refused(workspace.tchat(sweep + "--gather"), {"cut.sweep.1", "no part of a sweep"});
}

TEST_CASE("sweep: a journal is not written through a symbolic link") {
  const Workspace workspace;
  workspace.write("precious", "");
  std::filesystem::create_symlink("precious", workspace.file("linosc.sweep.journal"));
  check_refused(workspace.tchat("sweep linosc --over alpha=2:6:5"), {"linosc.sweep.journal", "symbolic link", "-o"});
  CHECK(workspace.read("precious").empty());
  CHECK_FALSE(workspace.has("linosc.sweep"));
}
