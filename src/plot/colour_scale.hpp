/// Colours that stand for numbers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tchat {

/// `count` colours (2 or more) from dark to light, in equal steps for the eye, also for the colour-blind and in grey.
std::vector<std::string> rising_colours(std::size_t count);

/// From blue over a pale grey to red, for numbers of both signs: the middle is zero.
std::vector<std::string> signed_colours(std::size_t count);

/// Round a circle of hues, all of them equally light: for angles, the last colour goes over into the first.
std::vector<std::string> cyclic_colours(std::size_t count);

}  // namespace tchat
