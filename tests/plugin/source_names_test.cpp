#include "plugin/problem_setup.hpp"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

using namespace tchat;
using Names = std::vector<std::string>;

TEST_CASE("names of parameters are read from C++ as it is written") {
  CHECK(parameter_names_in_cpp("static constexpr const char* parameter_names[] = {\"alpha\", \"omega\"};") ==
        Names{"alpha", "omega"});
  CHECK(parameter_names_in_cpp("std::array<const char*, 2> parameter_names = {{\"a\",\n \"b\"}};") == Names{"a", "b"});
  CHECK(parameter_names_in_cpp("const char* parameter_names[2]{\"a\", // the \"first\"\n /* \"no\" */ \"b\",};") ==
        Names{"a", "b"});
  CHECK(parameter_names_in_cpp("// parameter_names[] = {\"old\"};\nchar* parameter_names[] = {\"new\"};") ==
        Names{"new"});
  CHECK(parameter_names_in_cpp("int my_parameter_names = 1; char* parameter_names[] = {\"a\"};") == Names{"a"});
}

TEST_CASE("what is no list of plain strings has no names") {
  for (const char* text : {"", "parameter_names", "parameter_names[] = {", "parameter_names[] = {\"a",
                           "parameter_names[] = {NAMES}", "parameter_names[] = {\"a\\n\"}",
                           "parameter_names[] = {\"a b\"}", "parameter_names[] = {\"\"}", "/* x", "'", "/"})
    CHECK(parameter_names_in_cpp(text).empty());
  std::string many = "parameter_names[] = {";
  for (int k = 0; k < 100'000; ++k) many += "\"p\",";
  CHECK(parameter_names_in_cpp(many + "}").size() == 100'000);
}
