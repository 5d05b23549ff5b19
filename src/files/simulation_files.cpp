#include "files/simulation_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "files/output_lock.hpp"
#include "files/temporary_file.hpp"

namespace tchat {

namespace {

constexpr int column = 24;  // 16 significant digits
constexpr std::size_t segments_in_any_case = 32;

/// Headings without blanks inside, so that they stay one word for each column.
std::string names(const HybridSystem& system, const char* ending) {
  std::string text;
  for (int k = 1; k <= system.dimension(); ++k) {
    std::string name = system.state_name(k) + ending;
    std::replace(name.begin(), name.end(), ' ', '_');
    text += fmt::format(" {:>{}}", name, column);
  }
  return text;
}

std::string numbers(const Eigen::VectorXd& x) {
  std::string text;
  for (const double value : x) text += fmt::format(" {:{}.15e}", value, column);
  return text;
}

std::string indices(long segment, const IndexVector& index) {
  return fmt::format("{:7} {:3} {:3} {:3}", segment, index.field, index.event, index.jump);
}

/// Of an unfinished segment only the field is known.
IndexVector index_of(const SimulatedSegment& segment) {
  if (segment.index.field != 0) return segment.index;
  return {segment.mode.index_vectors.empty() ? 0 : segment.mode.field(), 0, 0};
}

const char* word(SegmentMark::Kind kind) {
  switch (kind) {
    case SegmentMark::Kind::contact:
      return "contact";
    case SegmentMark::Kind::section:
      return "section";
    case SegmentMark::Kind::violation:
      return "violation";
    default:
      return "beyond";
  }
}

/// What killed simulations of this name have left is removed.
std::unique_ptr<FileLock> lock_simulation(const std::string& name) {
  const std::string trajectory = SimulationFiles::trajectory_path(name);
  auto lock = lock_output(trajectory);
  remove_abandoned({trajectory, SimulationFiles::events_path(name)});
  return lock;
}

}  // namespace

SimulationFiles::SimulationFiles(const HybridSystem& system, const std::string& name, const std::string& heading,
                                 const Eigen::VectorXd& par, std::size_t trajectory_bytes)
    : system_(system),
      par_(par),
      lock_(lock_simulation(name)),
      trajectory_(trajectory_path(name)),
      events_(events_path(name)),
      most_bytes_(trajectory_bytes) {
  trajectory_.write(fmt::format("# {}\n#segment  i   j   k {:>{}}{}\n", heading, "t", column, names(system, "")));
  events_.write(fmt::format("# {}\n#segment  i   j   k {:>{}} {:>{}} {:>{}}{}{} what\n", heading, "t", column, "h",
                            column, "h_x_f", column, names(system, ""), names(system, "_after")));
}

void SimulationFiles::write(const SimulatedSegment& segment) {
  std::string rows;
  const std::string head = indices(segment.number, index_of(segment));
  for (const Sample& sample : segment.samples)
    rows += fmt::format("{} {:{}.15e}{}\n", head, sample.time, column, numbers(sample.state));
  write_rows(std::move(rows));

  std::string lines;
  const auto line = [&](const IndexVector& index, double t, double h, double rate, const Eigen::VectorXd& before,
                        const Eigen::VectorXd& after, const std::string& what) {
    lines += fmt::format("{} {:{}.15e} {:{}.15e} {:{}.15e}{}{} {}\n", indices(segment.number, index), t, column, h,
                         column, rate, column, numbers(before), numbers(after), what);
  };
  for (const SegmentMark& mark : segment.marks)
    line({segment.mode.field(), mark.event, 0}, mark.time, mark.h, mark.rate, mark.state, mark.state, word(mark.kind));
  if (segment.ended_by == SegmentEnd::event) {
    std::string what = "event";
    for (const IndexVector& other : segment.simultaneous) what += fmt::format("+{}", other.event);
    line(segment.index, segment.end_time(), system_.event(segment.index.event, segment.end.data(), par_.data()),
         segment.event_velocity, segment.end, segment.after, what);
  }
  events_.write(lines);
}

void SimulationFiles::put_rows(const std::string& rows) {
  if (!is_first_) trajectory_.write("\n");
  trajectory_.write(rows);
  is_first_ = false;
}

void SimulationFiles::write_rows(std::string rows) {
  ++segments_;
  if (most_bytes_ == everything) return put_rows(rows);
  bytes_ += rows.size() + 1;
  last_rows_.push_back(std::move(rows));
  while (bytes_ > most_bytes_ && last_rows_.size() > segments_in_any_case) {
    bytes_ -= last_rows_.front().size() + 1;
    last_rows_.pop_front();
    ++dropped_;
  }
}

void SimulationFiles::finish() {
  for (const std::string& rows : last_rows_) put_rows(rows);
  trajectory_.finish();
  events_.finish();
}

}  // namespace tchat
