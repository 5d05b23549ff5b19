/// The class of problems/linosc/linosc.cpp, compiled into a test instead of registered as a plugin.
#pragma once

#include <tchat/problem.hpp>

#pragma push_macro("TCHAT_PROBLEM")
#undef TCHAT_PROBLEM
#define TCHAT_PROBLEM(PROBLEM) static_assert(PROBLEM::dimension == 4);
#include "../../problems/linosc/linosc.cpp"
#pragma pop_macro("TCHAT_PROBLEM")
