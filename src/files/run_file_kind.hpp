/// Which of a run's files a file is.
#pragma once

#include <string>

namespace tchat {

enum class RunFileKind { points, solutions, diagnostics, other };

/// By the first line: of a q-file it holds 12 or 16 integers, of a p-file it is a header line or a point; otherwise by
/// the name (d.NAME, q.NAME, p.NAME, fort.9 and the like). `other` when neither tells, and for a file that is missing.
RunFileKind run_file_kind(const std::string& path);

}  // namespace tchat
