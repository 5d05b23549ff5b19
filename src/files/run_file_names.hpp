/// How the files of one run are called.
#pragma once

#include <string>
#include <string_view>

namespace tchat {

/// What the names of constants files begin with.
inline constexpr std::string_view constants_prefix = "gc.";
/// gc.NAME in the folder of NAME: "models/mems" -> "models/gc.mems".
std::string constants_file_of(const std::string& name);

/// The name of another file of the same run: "p.mems" -> "q.mems" ("b.x" -> "s.x", "fort.7" -> "fort.8"); letter 'p',
/// 'q', 'd' or 'r' (the constants). Empty when the name does not tell.
std::string sibling_path(const std::string& path, char letter);

/// `path`, or LETTER.NAME in the same folder when there is no file NAME but that one: "mems" -> "q.mems".
std::string resolve_run_file(const std::string& path, char letter);

/// "results/p.mems" -> "mems".
std::string run_name(const std::string& path);
/// "results/p.mems" -> "results/mems", where the problem of a run is looked for.
std::string run_path(const std::string& path);

}  // namespace tchat
