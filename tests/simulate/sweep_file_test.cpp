// Records of journals are read back to the last bit; O.sweep as written by hand, and what is wrong with others.
#include "simulate/sweep_file.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "base/messages.hpp"
#include "simulate/sample_record.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;

namespace {

const char* const good =
    "# tchat sweep of Oscillator\n"
    "# over mu from -0.5 to 0.5, 3 values\n"
    "# over x1 from 0 to 1, 2 values, initial state\n"
    "# PAR r = 0.8\n"
    "# start 1: x = (0, 1)\n"
    "# attractor 1: periodic, signature {(1,2,2), (1,1,1)^3}^2, impacts 1, period 6.5, index 0, mode 1,1,1;1,2,2, "
    "state "
    "0.25,-3\n"
    "# attractor 2: chaotic, index 4, state 1,2\n"
    "index mu x1(0) start attractor kind period time impacts x1 x2\n"
    "0 -0.5 0 1 1 periodic 2 6.5 1 0.25 -3\n"
    "4 0 1 1 2 chaotic nan nan nan 1 2\n";

std::string replaced(const std::string& old, const std::string& text) {
  std::string all = good;
  all.replace(all.find(old), old.size(), text);
  return all;
}

}  // namespace

TEST_CASE("values of a swept quantity meet their ends") {
  const SweptQuantity quantity{"mu", -0.82, -0.79, 301, false};
  CHECK(quantity.value(0) == -0.82);
  CHECK(quantity.value(300) == -0.79);
  CHECK(quantity.value(150) == Approx(-0.805).epsilon(1e-15));
  CHECK(quantity.column() == "mu");
  CHECK(SweptQuantity{"x1", 0, 1, 2, true}.column() == "x1(0)");
}

TEST_CASE("a sweep written by hand is read") {
  const test_support::TemporaryFolder folder;
  folder.write("a.sweep", good);
  const SweepTable table = read_sweep_file(folder.file("a.sweep"));
  CHECK(table.problem == "Oscillator");
  REQUIRE(table.over.size() == 2);
  CHECK(table.over[0].name == "mu");
  CHECK(table.over[0].count == 3);
  CHECK_FALSE(table.over[0].is_state);
  CHECK(table.over[1].is_state);
  REQUIRE(table.parameters.size() == 1);
  CHECK(table.parameters[0].second == 0.8);
  REQUIRE(table.starts.size() == 1);
  REQUIRE(table.attractors.size() == 2);
  CHECK(table.attractors[0].signature == "{(1,2,2), (1,1,1)^3}^2");
  CHECK(table.attractors[0].period == 6.5);
  CHECK(table.attractors[0].mode == "1,1,1;1,2,2");
  CHECK(table.attractors[0].state(1) == -3.0);
  CHECK(table.attractors[1].kind == AttractorKind::chaotic);
  CHECK(std::isnan(table.attractors[1].period));
  CHECK(table.rows() == 2);
  REQUIRE(table.column("x1") != nullptr);
  CHECK((*table.column("x1"))[0] == 0.25);
  CHECK(std::isnan((*table.column("time"))[1]));
  CHECK(table.kinds[1] == AttractorKind::chaotic);
  CHECK(table.column("penetration") == nullptr);
  // what is written of the heading is what is read
  std::string heading(good);
  heading.resize(heading.find("index mu"));
  CHECK(sweep_heading(table) == heading);
}

TEST_CASE("recorded states are found by their place: one is called as another column, one has a blank") {
  const test_support::TemporaryFolder folder;
  folder.write("a.sweep",
               "# tchat sweep of Belt\n"
               "# over mu from 0 to 1, 2 values\n"
               "index mu start attractor kind period time impacts frame_velocity time\n"
               "0 0 1 0 chaotic nan 6.5 nan 0.25 -3\n");
  const SweepTable table = read_sweep_file(folder.file("a.sweep"));
  const std::vector<std::string> states{"frame velocity", "time"};
  REQUIRE(table.state(1, states) != nullptr);
  REQUIRE(table.state(2, states) != nullptr);
  CHECK((*table.state(1, states))[0] == 0.25);
  CHECK((*table.state(2, states))[0] == -3.0);
  CHECK((*table.column("time"))[0] == 6.5);
  CHECK(table.column("frame velocity") == table.state(1, states));
  CHECK(table.state(1, {"x1", "x2"}) == nullptr);
}

TEST_CASE("files that are no sweep, or damaged, are refused with their line") {
  const test_support::TemporaryFolder folder;
  const auto message = [&](const std::string& text) {
    folder.write("a.sweep", text);
    try {
      read_sweep_file(folder.file("a.sweep"));
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("nothing wrong");
  };
  const auto says = [&](const std::string& text, const std::string& part) {
    INFO(message(text));
    CHECK(message(text).find(part) != std::string::npos);
  };
  says("", "it is empty");
  says("1 2 3\n", "a.sweep:1: it does not begin with");
  says("# tchat sweep journal 1\n# end of heading\n", "--gather");
  says(replaced("0 -0.5 0 1 1 periodic 2", "0 -0.5 0 1 1 periodic"),
       "a.sweep:9: there are 10 words, the columns are 11");
  says(replaced("0.25 -3\n4", "0.25 three\n4"), "a.sweep:9: 'three' is no number");
  says(replaced("1 1 periodic", "1 1 periodical"), "a.sweep:9: 'periodical' is no kind");
  says(replaced("index mu x1(0)", "mu x1(0)"), "a.sweep:8: these are not the columns");
  says(replaced(" from -0.5", ""), "a.sweep:2: the heading lacks");
  // Numbers that pictures count and find cells by.
  says(replaced("3 values", "0 values"), "a.sweep:2: the number of values is '0', a whole number from 1 to 10000000");
  says(replaced("3 values", "1e18 values"), "a.sweep:2: the number of values is '1e18'");
  says(replaced("3 values", "2.5 values"), "a.sweep:2: the number of values is '2.5'");
  says(replaced("0 -0.5 0 1 1 periodic 2", "-1 -0.5 0 1 1 periodic 2"), "a.sweep:9: the index is '-1'");
  says(replaced("0 -0.5 0 1 1 periodic 2", "1e9 -0.5 0 1 1 periodic 2"), "a.sweep:9: the index is '1e9'");
  says(replaced("# attractor 1", "# attractor 1e99"), "the number of an attractor is '1e99'");
  says(std::string(good).substr(0, std::string(good).size() - 3), "ends within a line");
  says(std::string(good).substr(0, std::string(good).find("index mu")), "column names is missing");
  CHECK_THROWS_AS(read_sweep_file(folder.file("none.sweep")), UserError);
}

TEST_CASE("a record of a journal is read back to the last bit, and a damaged one is not") {
  const bool has_largest = GENERATE(false, true);
  SampleRecord record{123456789, 2, {}};
  AttractorSample& sample = record.sample;
  sample.kind = AttractorKind::periodic;
  sample.signature = {{1, 2, 2}, {2, 1, 1}};
  sample.period = 0.1 + 0.2;
  sample.impacts = 1;
  sample.penetration = std::numeric_limits<double>::quiet_NaN();
  sample.exponents = Eigen::Vector2d(1.0 / 3.0, -std::numeric_limits<double>::infinity());
  sample.errors = Eigen::Vector2d(5e-324, 1.7976931348623157e308);
  sample.sections = Eigen::MatrixXd::Random(3, 4);
  sample.section_events = {1, 2, 1, 1};
  sample.section_penetrations = Eigen::VectorXd::Random(4);
  sample.identity = Eigen::MatrixXd::Random(3, 2);
  if (has_largest) sample.largest = Eigen::MatrixXd::Random(3, 4);
  if (has_largest) sample.without_chatter = {{2, 1, 1}};
  sample.sizes = Eigen::VectorXd::Random(3);
  sample.last = {Eigen::VectorXd::Random(3), {{1, 1, 1}, {1, 2, 2}}};
  sample.known = 3;
  sample.message = "two\nlines of it";
  const std::string line = record_line(record);
  REQUIRE(line.back() == '\n');
  REQUIRE(line.find('\n') == line.size() - 1);
  const std::string text = line.substr(0, line.size() - 1);
  const std::optional<SampleRecord> read = read_record(text);
  REQUIRE(read);
  CHECK(read->index == record.index);
  CHECK(read->start == 2);
  CHECK(read->sample.signature == sample.signature);
  CHECK(read->sample.period == sample.period);
  CHECK(std::isnan(read->sample.penetration));
  CHECK(read->sample.exponents == sample.exponents);
  CHECK(read->sample.errors == sample.errors);
  CHECK(read->sample.sections == sample.sections);
  CHECK(read->sample.section_events == sample.section_events);
  CHECK(read->sample.section_penetrations == sample.section_penetrations);
  CHECK(read->sample.identity == sample.identity);
  CHECK(read->sample.largest == sample.largest);
  CHECK(read->sample.without_chatter == sample.without_chatter);
  CHECK(read->sample.last.x == sample.last.x);
  CHECK(read->sample.last.watched == sample.last.watched);
  CHECK(read->sample.known == 3);
  CHECK(read->sample.message == "two lines of it");
  CHECK(record_line(*read) == line);
  for (std::size_t cut = 0; cut < text.size(); cut += 7) CHECK_FALSE(read_record(text.substr(0, cut)));
  for (std::size_t at = 0; at < text.size(); at += 11) {
    std::string damaged = text;
    damaged[at] = damaged[at] == '1' ? '2' : '1';
    CHECK_FALSE(read_record(damaged));
  }
}
