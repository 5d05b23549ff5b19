#include "two_walls.hpp"

TCHAT_PROBLEM(TwoWalls)
