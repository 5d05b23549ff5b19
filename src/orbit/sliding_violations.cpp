#include "orbit/sliding_violations.hpp"

#include <algorithm>
#include <cmath>

#include "model/sliding_modes.hpp"

namespace tchat {

namespace {

/// Whether an orbit meets the surface at a start, or has another reason to change the field there.
constexpr double meets_surface = 1e-6;

}  // namespace

void add_sliding_violations(std::vector<Violation>& violations, const HybridSystem& system, const Signature& signature,
                            const std::vector<int>& monitored, const Orbit& x, int s, double leaving) {
  const std::size_t m = signature.size();
  const IndexVector& v = signature[static_cast<std::size_t>(s)];
  const int before = signature[(static_cast<std::size_t>(s) + m - 1) % m].field;
  const double* start = x.start(s);
  const double* par = x.par.data();
  for (const tchat_sliding& mode : system.sliding_modes()) {
    const bool on_surface = is_on_surface(system, mode, start, par, meets_surface);
    if (v.field == mode.field) {
      if (!on_surface)
        violations.push_back(
            {Violation::off_surface, s + 1, mode.surface, 0.0, system.event(mode.surface, start, par)});
      for (const int side : {mode.minus, mode.plus}) {
        const int event = ends_with(mode, side);
        if (v.event == event || std::find(monitored.begin(), monitored.end(), event) != monitored.end()) continue;
        const SideRate rate = side_rate(system, mode, side, start, par);
        if (rate.away > leaving * rate.sizes)
          violations.push_back({Violation::side_leads_away, s + 1, side, 0.0, rate.away});
      }
    } else if (is_side(mode, v.field) && before == other_side(mode, v.field) && on_surface) {
      const SideRate rate = side_rate(system, mode, v.field, start, par);
      if (-rate.away > leaving * rate.sizes)
        violations.push_back({Violation::crosses_where_it_slides, s + 1, v.field, 0.0, -rate.away});
    }
  }
}

}  // namespace tchat
