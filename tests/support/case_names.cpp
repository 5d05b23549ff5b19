/// Writes the name of each test case that begins: a sanitizer that ends the program does not know it.
#define CATCH_CONFIG_EXTERNAL_INTERFACES
#include <catch2/catch.hpp>
#include <cstdio>

namespace {

struct CaseNames : Catch::TestEventListenerBase {
  using TestEventListenerBase::TestEventListenerBase;

  void testCaseStarting(const Catch::TestCaseInfo& info) override {
    TestEventListenerBase::testCaseStarting(info);
    std::fprintf(stderr, "%s\n", info.name.c_str());
  }
};

}  // namespace

CATCH_REGISTER_LISTENER(CaseNames)
