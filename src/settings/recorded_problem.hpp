/// The problem that constants name (PROBLEM), so that commands on the files of a run need no -p.
#pragma once

#include <optional>
#include <string>

#include "settings/run_settings.hpp"

namespace tchat {

/// The problem as a name or path from the current folder; `constants`: path of the file that the settings are from.
/// Nothing where they name none.
std::optional<std::string> recorded_problem(const RunSettings& settings, const std::string& constants);

/// PROBLEM of constants that are written to the path `constants`, for a problem named from the current folder.
std::string problem_to_record(const std::string& problem, const std::string& constants);

}  // namespace tchat
