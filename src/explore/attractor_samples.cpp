#include "explore/attractor_samples.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/number.hpp"
#include "base/words.hpp"

namespace tchat {

namespace {

/// The state of "up from x = (0.1, -2)".
std::vector<double> numbers_of_start(const std::string& text) {
  std::vector<double> numbers;
  const std::size_t open = text.find("x = (");
  if (open == std::string::npos) return numbers;
  for (std::size_t at = open + 5; at < text.size();) {
    const std::size_t end = text.find_first_of(",)", at);
    if (end == std::string::npos) break;
    numbers.push_back(parse_real(std::string(trimmed(std::string_view(text).substr(at, end - at)))).value_or(NAN));
    at = end + 1;
  }
  return numbers;
}

/// What is watched on the first segment.
std::string mode_words(const SweepAttractor& attractor) {
  return attractor.mode.empty() ? "" : " --mode " + quoted_for_shell(attractor.mode);
}

/// The least box around numbers of each state.
struct StateBox {
  explicit StateBox(int n) : low(Eigen::VectorXd::Constant(n, INFINITY)), high(-low) {}
  void add(int k, double value) {
    if (!std::isfinite(value)) return;
    low(k) = std::min(low(k), value);
    high(k) = std::max(high(k), value);
  }
  Eigen::VectorXd low, high;
};

}  // namespace

std::vector<std::size_t> AttractorSamples::first_rows() const {
  std::vector<std::size_t> rows;
  if (table_.rows() == 0) return rows;
  const std::vector<double>& index = *table_.column("index");
  const std::vector<double>& start = *table_.column("start");
  for (std::size_t row = 0; row < table_.rows(); ++row)
    if (row == 0 || index[row] != index[row - 1] || start[row] != start[row - 1]) rows.push_back(row);
  return rows;
}

void AttractorSamples::for_each(const std::function<void(const SweptAttractor&)>& use) const {
  for (const std::size_t row : first_rows()) {
    const double found = (*table_.column("attractor"))[row];
    const std::size_t number = found >= 1.0 ? static_cast<std::size_t>(found) : 0;
    if (number >= 1 && number <= table_.attractors.size())
      use({&table_.attractors[number - 1], row, (*table_.column(table_.over.front().column()))[row],
           (*table_.column("time"))[row]});
  }
}

std::vector<double> AttractorSamples::values_of(const SweptAttractor& sample,
                                                const std::vector<std::string>& names) const {
  std::vector<double> values;
  for (const std::string& name : names) {
    const std::vector<double>* const column = table_.column(name);
    values.push_back(column == nullptr ? std::numeric_limits<double>::quiet_NaN() : (*column)[sample.row]);
  }
  return values;
}

std::map<AttractorKind, int> AttractorSamples::kinds() const {
  std::map<AttractorKind, int> counts;
  for (const std::size_t row : first_rows()) ++counts[table_.kinds[row]];
  return counts;
}

std::optional<Eigen::VectorXd> AttractorSamples::numbers_of(const SweptAttractor& sample) const {
  const auto n = static_cast<int>(state_names_.size());
  Eigen::VectorXd state(n);
  for (int k = 1; k <= n; ++k) {
    const std::vector<double>* column = table_.state(k, state_names_);
    if (column == nullptr || !std::isfinite((*column)[sample.row])) return std::nullopt;
    state(k - 1) = (*column)[sample.row];
  }
  return state;
}

std::string AttractorSamples::words_of(const SweptAttractor& sample) const {
  const std::optional<Eigen::VectorXd> state = numbers_of(sample);
  if (!state) return "";
  std::string words = fmt::format("--state {}", fmt::join(state->begin(), state->end(), ","));
  if (sample.attractor->kind != AttractorKind::periodic) return words;
  return words + mode_words(*sample.attractor) + " --before-event";
}

std::vector<std::string> AttractorSamples::further_starts(int count) const {
  const auto n = static_cast<int>(state_names_.size());
  StateBox box(n);
  for (const std::string& start : table_.starts)
    if (const std::vector<double> numbers = numbers_of_start(start); std::ssize(numbers) == n)
      for (int k = 0; k < n; ++k) box.add(k, numbers[static_cast<std::size_t>(k)]);
  for (int k = 0; k < n; ++k)
    if (const std::vector<double>* column = table_.state(k + 1, state_names_))
      for (const double value : *column) box.add(k, value);
  if (!box.low.allFinite()) return {};
  double base = 2.0;  // the sequence of Roberts: additive, with powers of the root of g^(n+1) = g + 1
  for (int step = 0; step < 100; ++step) base = std::pow(1.0 + base, 1.0 / (n + 1));
  std::vector<std::string> states;
  for (int number = 1; number <= count; ++number) {
    Eigen::VectorXd state(n);
    for (int k = 0; k < n; ++k) {
      const double place = 0.5 + number * std::pow(base, -(k + 1));
      state(k) = box.low(k) + (place - std::floor(place)) * (box.high(k) - box.low(k));
    }
    states.push_back(fmt::format("{:.4g}", fmt::join(state.begin(), state.end(), ",")));
  }
  return states;
}

std::string AttractorSamples::words_of(const SweepAttractor& attractor) {
  std::string words = "--state ";
  for (Eigen::Index k = 0; k < attractor.state.size(); ++k)
    words += fmt::format("{}{}", k > 0 ? "," : "", attractor.state(k));
  return words + mode_words(attractor);
}

double AttractorSamples::value_of(const SweepAttractor& attractor) const {
  return table_.over.front().value(static_cast<long>(attractor.index));
}

SignatureWord signature_word(const SweepAttractor& attractor) {
  SignatureWord word;
  if (attractor.signature.empty()) return word;
  for (const IndexVector& v : parse_signature(attractor.signature)) word.push_back({v.field, v.event, v.jump});
  return word;
}

}  // namespace tchat
