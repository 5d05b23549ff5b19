#include "simulate/sweep_grid.hpp"

#include <fmt/format.h>

#include <optional>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "plugin/problem_setup.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

namespace {

constexpr double most_values = 1e7;

[[noreturn]] void refuse_over(const std::string& text, const std::string& what) {
  throw UserError(fmt::format("--over {}: {}; an example is --over mu=-0.82:-0.79:301", text, what));
}

double read_end(const std::string& word, const char* which, const std::string& text) {
  if (const std::optional<double> value = parse_real(word)) return *value;
  refuse_over(text, fmt::format("{} '{}' is no finite number", which, word));
}

/// Index of the state of this name; nothing when there is none.
std::optional<int> find_state(const HybridSystem& system, const std::string& name) {
  for (int k = 1; k <= system.dimension(); ++k)
    if (name == system.state_name(k) || name == fmt::format("U({})", k)) return k;
  return std::nullopt;
}

}  // namespace

std::string bare_name(const std::string& name) {
  const bool is_par = (name.starts_with("PAR(") || name.starts_with("par(")) && name.ends_with(")");
  return is_par ? name.substr(4, name.size() - 5) : name;
}

SweepTarget parse_over(const HybridSystem& system, const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::string range = equals == std::string::npos ? "" : text.substr(equals + 1);
  const std::size_t first = range.find(':');
  const std::size_t second = first == std::string::npos ? first : range.find(':', first + 1);
  if (equals == std::string::npos || equals == 0 || second == std::string::npos)
    refuse_over(text, "it is not of the form NAME=FROM:TO:COUNT");
  const std::string given = text.substr(0, equals);
  const std::string name = bare_name(given);

  SweepTarget target;
  SweptQuantity& quantity = target.quantity;
  const bool is_parameter = name != given || system.parameter_index(name) > 0;
  const std::optional<int> state = is_parameter ? std::nullopt : find_state(system, name);
  if (state) {
    target.position = *state;
    quantity.name = system.state_name(*state);
    quantity.is_state = true;
  } else {
    std::string states;
    for (int k = 1; k <= system.dimension(); ++k) states += (k > 1 ? ", " : "") + system.state_name(k);
    target.position = parameter_index(system, name, fmt::format("--over {} (states: {})", text, states));
    if (target.position > system.parameters() && target.position >= system.layout().first_duration())
      refuse_over(text, "a duration is no parameter of a simulation");
    quantity.name = system.parameter_name(target.position);
  }
  quantity.from = read_end(range.substr(0, first), "FROM", text);
  quantity.to = read_end(range.substr(first + 1, second - first - 1), "TO", text);
  const std::optional<int> count = parse_integer(range.substr(second + 1));
  if (!count || *count < 1 || *count > most_values)
    refuse_over(text,
                fmt::format("COUNT '{}' is no whole number from 1 to {:g}", range.substr(second + 1), most_values));
  quantity.count = *count;
  if (quantity.count == 1 && quantity.from != quantity.to)
    refuse_over(text, "one value has two ends; give COUNT at least 2, or FROM the same as TO");
  if (quantity.count > 1 && quantity.from == quantity.to)
    refuse_over(text, "FROM and TO are the same; give COUNT 1, or two ends");
  return target;
}

std::vector<SweepTarget> parse_overs(const HybridSystem& system, const std::vector<std::string>& texts) {
  if (texts.empty())
    throw UserError("nothing to sweep over; give --over NAME=FROM:TO:COUNT, as in --over mu=-0.82:-0.79:301");
  if (texts.size() > 2)
    throw UserError(fmt::format("--over is given {} times; a sweep is over one or two quantities", texts.size()));
  std::vector<SweepTarget> targets;
  double values = 1.0;
  for (const std::string& text : texts) {
    targets.push_back(parse_over(system, text));
    values *= static_cast<double>(targets.back().quantity.count);
  }
  if (targets.size() == 2 && targets[0].position == targets[1].position &&
      targets[0].quantity.is_state == targets[1].quantity.is_state)
    throw UserError(
        fmt::format("--over {} and --over {}: the same quantity twice; give two different ones", texts[0], texts[1]));
  if (values > most_values)
    throw UserError(
        fmt::format("a sweep of {:g} values; at most {:g} go into one, cut it into several", values, most_values));
  return targets;
}

void set_swept_values(const std::vector<SweepTarget>& over, const Eigen::VectorXd& values, Eigen::VectorXd& state,
                      Eigen::VectorXd& par) {
  for (std::size_t q = 0; q < over.size(); ++q)
    (over[q].quantity.is_state ? state : par)(over[q].position - 1) = values(static_cast<Eigen::Index>(q));
}

std::size_t SweepGrid::size() const {
  std::size_t size = 1;
  for (const SweptQuantity& quantity : over_) size *= static_cast<std::size_t>(quantity.count);
  return size;
}

Eigen::VectorXd SweepGrid::values(std::size_t index) const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(over_.size()));
  for (std::size_t q = 0; q < over_.size(); ++q) {
    const auto count = static_cast<std::size_t>(over_[q].count);
    values(static_cast<Eigen::Index>(q)) = over_[q].value(static_cast<long>(index % count));
    index /= count;
  }
  return values;
}

}  // namespace tchat
