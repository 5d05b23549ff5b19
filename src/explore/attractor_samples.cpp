#include "explore/attractor_samples.hpp"

#include <fmt/format.h>

#include <cmath>

#include "text/words.hpp"

namespace tchat {

void AttractorSamples::for_each(const std::function<void(const AttractorSample&)>& use) const {
  if (table_.rows() == 0) return;
  const std::vector<double>& index = *table_.column("index");
  const std::vector<double>& start = *table_.column("start");
  const std::vector<double>& attractor = *table_.column("attractor");
  const std::vector<double>& time = *table_.column("time");
  const std::vector<double>& value = *table_.column(table_.over.front().column());
  for (std::size_t row = 0; row < table_.rows(); ++row) {
    if (row > 0 && index[row] == index[row - 1] && start[row] == start[row - 1]) continue;
    if (attractor[row] >= 1.0)
      use({&table_.attractors[static_cast<std::size_t>(attractor[row]) - 1], row, value[row], time[row]});
  }
}

std::string AttractorSamples::state_of(const AttractorSample& sample) const {
  std::string text;
  for (int k = 1; k <= system_->dimension(); ++k) {
    const std::vector<double>* column = table_.column(system_->state_name(k));
    if (column == nullptr || !std::isfinite((*column)[sample.row])) return "";
    text += fmt::format("{}{}", k > 1 ? "," : "", (*column)[sample.row]);
  }
  return text;
}

std::string AttractorSamples::words_of(const SweepAttractor& attractor) {
  std::string words = "--state ";
  for (Eigen::Index k = 0; k < attractor.state.size(); ++k)
    words += fmt::format("{}{}", k > 0 ? "," : "", attractor.state(k));
  if (!attractor.mode.empty()) words += " --mode " + quoted_for_shell(attractor.mode);
  return words;
}

double AttractorSamples::value_of(const SweepAttractor& attractor) const {
  return table_.over.front().value(static_cast<long>(attractor.index));
}

SignatureWord signature_word(const SweepAttractor& attractor) {
  SignatureWord word;
  for (const IndexVector& v : parse_signature(attractor.signature)) word.push_back({v.field, v.event, v.jump});
  return word;
}

}  // namespace tchat
