#include "explore/coverage.hpp"

#include <fmt/format.h>

#include <map>

namespace tchat {

namespace {

void count_kinds(const Sweep& sweep, ExploredDiagram& diagram) {
  for (const auto& [kind, count] : sweep.samples.kinds())
    if (kind == AttractorKind::periodic)
      diagram.periodic += count;
    else if (kind == AttractorKind::rest)
      diagram.at_rest += count;
    else
      diagram.others[kind == AttractorKind::none ? "without attractor" : to_string(kind)] += count;
}

}  // namespace

bool is_followed(const SweepAttractor& attractor) {
  return attractor.kind == AttractorKind::periodic || attractor.kind == AttractorKind::rest;
}

std::vector<std::string> branches_of(const OrbitCatalogue& catalogue, const Sweep& sweep,
                                     const SweptAttractor& sample) {
  if (sample.attractor->kind == AttractorKind::rest) {
    const auto state = sweep.samples.numbers_of(sample);
    const std::string branch = state ? catalogue.branch_with_state(sample.value, *state) : "";
    return branch.empty() ? std::vector<std::string>{} : std::vector<std::string>{branch};
  }
  const SignatureWord word = sweep.is_cut ? SignatureWord{{1, 0, 0}} : signature_word(*sample.attractor);
  return catalogue.branches_with(word, sample.value, sample.period, sweep.samples.values_of(sample, sweep.monitors));
}

void measure_coverage(const Sweep& sweep, const OrbitCatalogue& catalogue, const ExplorationCommands& commands,
                      ExploredDiagram& diagram) {
  count_kinds(sweep, diagram);
  std::map<int, UnexplainedAttractor> missing;
  sweep.samples.for_each([&](const SweptAttractor& sample) {
    const SweepAttractor& known = *sample.attractor;
    const std::size_t branches = is_followed(known) ? branches_of(catalogue, sweep, sample).size() : 0;
    if (branches > 1) ++diagram.on_several;
    if (branches > 0) {
      ++diagram.on_branches;
      return;
    }
    UnexplainedAttractor& one = missing[known.number];
    if (one.count++ == 0) {
      const std::string words = sweep.samples.words_of(sample);
      one.attractor = fmt::format("{}{}", sweep.letter, known.number);
      one.kind = to_string(known.kind);
      one.first = sample.value;
      one.command = words.empty() ? "" : commands.show(sample.value, words);
    }
    one.segments = known.kind == AttractorKind::periodic ? static_cast<int>(signature_word(known).size()) : 0;
    one.last = sample.value;
  });
  for (auto& [number, one] : missing) diagram.unexplained.push_back(std::move(one));
}

}  // namespace tchat
