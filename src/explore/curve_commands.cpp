#include "explore/curve_commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numeric>

#include "base/user_error.hpp"
#include "base/words.hpp"
#include "plugin/plugin_build.hpp"

namespace tchat {

CurveCommands::CurveCommands(const ExploreRequest& request, const ExplorationCommands& commands,
                             const HybridSystem& system, const ParameterVector& par)
    : commands_(commands),
      returns_(request.returns.value_or(4)),
      second_(read_swept_range("--and", *request.second, false)) {
  index_ = find_parameter("--and", system, second_);
  if (second_.parameter == commands.range().parameter)
    throw UserError(fmt::format("--and {}: this is the parameter of --over; another one is needed", second_.parameter));
  const double value = par(index_ - 1);
  if (value < second_.from || value > second_.to)
    throw UserError(
        fmt::format("--and {0}={1}:{2}: the diagram is at {0} = {3}, outside of this range; give it another "
                    "value, as 'PAR({0})={4}'",
                    second_.parameter, second_.from, second_.to, value, std::midpoint(second_.from, second_.to)));
}

std::string CurveCommands::free_parameters(bool rests) const {
  std::string names = commands_.range().parameter + "," + second_.parameter;
  if (!rests)
    for (const std::string& monitor : commands_.monitors()) names += "," + monitor;
  return fmt::format("ICP=[{}]", names);
}

/// Between what either range alone would have.
double CurveCommands::largest_step() const {
  const SweptRange& first = commands_.range();
  return std::sqrt((first.to - first.from) * (second_.to - second_.from)) / 20.0;
}

CommandJob CurveCommands::curve(const std::string& name, const std::string& command, const std::string& source,
                                bool rests) const {
  CommandJob job{name, {}, {commands_.file('q', source), commands_.file('r', source)}, commands_.files_of(name)};
  const std::size_t both = command.find(" && ");
  const bool has_start = both != std::string::npos;
  const SweptRange& first = commands_.range();
  if (has_start)
    job.lines.push_back(command.substr(0, both) + " -q" +
                        shell_words({fmt::format("ICP=[{},{}]", first.parameter, second_.parameter)}));
  std::vector<std::string> words{free_parameters(rests),
                                 fmt::format("RL0={}", first.from),
                                 fmt::format("RL1={}", first.to),
                                 fmt::format("BOUNDS={{{}: [{}, {}]}}", second_.parameter, second_.from, second_.to),
                                 fmt::format("DS={:g}", largest_step() / 10.0),
                                 fmt::format("DSMAX={:g}", largest_step()),
                                 "NMX=400"};
  std::vector<int> returns(static_cast<std::size_t>(returns_));
  std::iota(returns.begin(), returns.end(), 1);
  if (command.starts_with("tchat resegment")) words.push_back(fmt::format("GCIPSI=[{}]", fmt::join(returns, ",")));
  words.insert(words.end(), commands_.constants().begin(), commands_.constants().end());
  job.lines.push_back((has_start ? command.substr(both + 4) : command) + " --both --clip" + shell_words(words));
  return job;
}

CommandJob CurveCommands::slice(const ResonantPoint& at, int sign) const {
  const std::string name =
      fmt::format("{}_XI{}_in{}{}", at.curve, at.label, at.returns, sign > 0 ? "_forward" : "_backward");
  const std::string beside = name + "_beside";
  const double step = largest_step() / 5.0;
  const std::string curve = quoted_for_shell(commands_.path(at.curve));
  CommandJob job{name, {}, {commands_.file('q', at.curve), commands_.file('r', at.curve)}, commands_.files_of(name)};
  job.lines = {
      fmt::format("tchat run {} -c {} -s {} IRS={} NMX=2 DS={:g} DSMAX={:g} ILP=0 ISP=0 GCIPSI=[] -o {} --clip "
                  "-q",
                  problem_arguments(commands_.problem()), quoted_for_shell(commands_.file('r', at.curve)), curve,
                  at.label, sign * step, step, quoted_for_shell(commands_.path(beside)))};
  for (const std::string& line : commands_.born_lines(beside, "EP1", at.returns, name)) job.lines.push_back(line);
  return job;
}

}  // namespace tchat
