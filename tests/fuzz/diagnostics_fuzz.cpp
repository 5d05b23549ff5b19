// d-files: lines that are not understood are skipped, so every text is accepted.

#include <cmath>

#include "files/diagnostics_file.hpp"
#include "fuzz_target.hpp"

using namespace tchat;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const DiagnosticPoint& point : parse_diagnostics(fuzz::text_of(data, size)))
    for (const auto& multiplier : point.multipliers)
      fuzz::require(std::isfinite(multiplier.real()) && std::isfinite(multiplier.imag()), "finite multipliers");
  return 0;
}
