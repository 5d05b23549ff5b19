#include "resegment/data_text.hpp"

#include <fmt/format.h>

#include "files/dat_file.hpp"
#include "run/orbit_start.hpp"

namespace tchat {

std::string data_text(const Orbit& x, const HybridSystem& system) {
  std::string text = parameter_lines(system, x.par);
  for (int s = 0; s < x.shape.segments; ++s)
    text += fmt::format("# PAR({}) = {}\n", x.par.layout().duration(s), x.duration(s));
  const LabelledSolution rows = labelled_solution(x, {}, {}, {});
  for (Eigen::Index k = 0; k < rows.states.cols(); ++k) {
    text += fmt::format("{:.15g}", rows.tau[static_cast<std::size_t>(k)]);
    for (Eigen::Index i = 0; i < rows.states.rows(); ++i) text += fmt::format(" {:.15g}", rows.states(i, k));
    text += '\n';
  }
  return text;
}

}  // namespace tchat
