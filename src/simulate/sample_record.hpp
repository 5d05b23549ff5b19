/// A computed value as one line of a journal: what is read back is the same to the last bit.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "simulate/sweep_point.hpp"

namespace tchat {

struct SampleRecord {
  std::size_t index = 0;
  int start = 1;
  AttractorSample sample;
};

/// `text` with its hash behind it and a newline: a line of a journal.
std::string hashed_line(const std::string& text);
/// Ends in a hash of the line and a newline.
std::string record_line(const SampleRecord& record);
/// Nothing for a line that is damaged or cut.
std::optional<SampleRecord> read_record(const std::string& line);

}  // namespace tchat
