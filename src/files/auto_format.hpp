/// The conventions of AUTO's files: their names, and the layout of numbers and columns.
#pragma once

#include <string>
#include <string_view>

namespace tchat {

// Numbers and columns as AUTO's files have them.

/// Stands for values that are not finite: files never hold NaN or inf, which AUTO's programs cannot read.
inline constexpr double capped_value = 1e99;

/// `value`, +-capped_value for +-inf, capped_value for NaN, 0 for -0 and for numbers below 2.2251e-308, at which many
/// readers stop.
double finite(double value);

/// 19 columns: `  1.2345678901E+000`, ten decimals and three exponent digits. Not finite: capped.
std::string e19(double value);
void append_e19(std::string& line, double value);

/// 26 columns: `  1.2345678901234567E+000`, sixteen decimals, from which the number is read back exactly.
void append_e26(std::string& line, double value);

/// `width` columns with four or more decimals as Fortran's ESw.d prints them: `  1.0000E-01`, `-1.7976+308`.
std::string es(double value, int width, int decimals);

/// With so many significant digits at most, as C prints it with %.*g: `-5.0022`, `1.3e-07`.
void append_short(std::string& line, double value, int digits);

/// As C prints it with %.*E: `-1.2345E-07`.
void append_scientific(std::string& line, double value, int decimals);

/// Right-justified in `width` columns with at least one blank before it, so that neighbours never touch.
std::string integer_field(int value, int width);
void append_integer_field(std::string& line, int value, int width);

/// What lines of p- and d-files begin with: the branch in 4 columns, the point as files show it, `sign` times, in 6.
void append_branch_and_point(std::string& line, int branch, int point, int sign = 1);

/// The point number that files show: 1, ..., 9999, 1, ...
int wrapped_point(int point);

/// `name` as a heading of a column `width` wide: right-justified two columns before its end, cut to leave a blank,
/// every character outside printable ASCII replaced by '_'.
std::string heading_field(std::string_view name, int width);

/// `name` without quotes and unprintable characters, for `names = {1: 'alpha'}` in headers.
std::string plain_name(std::string_view name);

// How the files of one run are called.

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
