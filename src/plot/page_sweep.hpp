/// A sweep as JSON, for the script of a page: all that its rows say.
#pragma once

#include <string>

#include "plot/sweep_layer.hpp"

namespace tchat {

/// Columns by name, among them `kind` in words; of a sweep with more than 400,000 numbers the names alone, so that a
/// page stays small.
std::string sweep_json(const SweepFile& file);

}  // namespace tchat
