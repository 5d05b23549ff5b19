#include "settings/constants_guide.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "settings/constants_writer.hpp"
#include "settings/family.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

constexpr std::size_t keyword_width = 10;

std::string limits_line(const Constant& constant) {
  const std::string effect = constant.effect.empty() ? "" : fmt::format("; {}", constant.effect);
  return fmt::format("{:{}}   allowed: {}{}\n", "", keyword_width, allowed_text(constant), effect);
}

std::string segment_text(int number, const SegmentSettings& segment, bool ends_in_event) {
  std::string text = fmt::format("  segment {}: field {}", number, segment.index.field);
  if (!ends_in_event) return text + "\n";
  text += segment.index.event == no_function
              ? " for one period, fixed by the integral phase condition"
              : fmt::format(" until event function {} falls to zero{}", segment.index.event,
                            segment.type == 2 ? " in grazing contact (h = 0 and h_x f = 0)" : "");
  text += segment.index.jump == no_function ? ", no jump" : fmt::format(", then jump {}", segment.index.jump);
  if (!segment.monitor.empty())
    text += fmt::format("; watched along it: event functions {}", fmt::join(segment.monitor, ", "));
  return text + "\n";
}

/// The contacts that GCIPSI counts: through the monitored event functions of all segments, in order.
std::string contacts_text(const RunSettings& settings) {
  std::string text;
  int k = 0;
  for (std::size_t s = 0; s < settings.segments.size(); ++s)
    for (const int event : settings.segments[s].monitor)
      text += fmt::format("  test function {}: contact with event function {} on segment {}\n", ++k, event, s + 1);
  return text;
}

}  // namespace

std::string constants_guide() {
  std::string text =
      "Constants files gc.NAME hold KEY = value lines (comments with #), what is left out has its default;\n"
      "or the values alone in this order, one record a line. KEY=VALUE on the command line overrides both.\n\n";
  for (const Constant& constant : constants_table()) {
    const std::string value = default_text(constant);
    text += fmt::format("{:<{}} {}{}\n", constant.keyword, keyword_width, constant.meaning,
                        value.empty() ? "" : fmt::format(" (default {})", value));
    text += limits_line(constant);
    text += fmt::format("{:{}}   example: {} = {}\n", "", keyword_width, constant.keyword, constant.example);
  }
  return text;
}

std::string explained_text(const RunSettings& settings) {
  std::string text = "The signature:\n";
  for (std::size_t s = 0; s < settings.segments.size(); ++s)
    text += segment_text(static_cast<int>(s + 1), settings.segments[s], signature_rules(settings).ends_in_events);
  const std::string contacts = contacts_text(settings);
  if (!keeps_contact(settings.problem_type) && !contacts.empty()) text += "GCIPSI chooses from these:\n" + contacts;
  text += "\n";
  for (const Constant& constant : constants_table()) {
    const std::string value = value_text(constant, settings);
    if (value.empty()) continue;
    text += fmt::format("{} = {}\n{:{}}   {}\n", constant.keyword, value, "", keyword_width, constant.meaning);
    text += limits_line(constant);
  }
  return text;
}

}  // namespace tchat
