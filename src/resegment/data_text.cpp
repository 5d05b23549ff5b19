#include "resegment/data_text.hpp"

#include <fmt/format.h>

#include "setup/parameter_values.hpp"

namespace tchat {

std::string data_text(const Orbit& x, const HybridSystem& system) {
  std::string text = parameter_lines(system, x.par);
  for (int s = 0; s < x.shape.segments; ++s) text += fmt::format("# PAR({}) = {}\n", first_duration + s, x.duration(s));
  for (int k = 0; k < x.shape.nodes(); ++k) {
    text += fmt::format("{:.15g}", x.tau(k));
    for (int s = 0; s < x.shape.segments; ++s)
      for (int i = 0; i < x.shape.dimension; ++i) text += fmt::format(" {:.15g}", x.node(s, k)[i]);
    text += '\n';
  }
  return text;
}

}  // namespace tchat
