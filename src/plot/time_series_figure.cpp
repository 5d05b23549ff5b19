#include <algorithm>

#include "plot/event_surface.hpp"
#include "plot/orbit_figure.hpp"
#include "plot/picture_styles.hpp"

namespace tchat {

namespace {

/// One state of one orbit over a period.
void add_series(Panel& panel, const OrbitTrace& orbit, int state, const Stroke& stroke, const Marker& jump) {
  const StatePlace place = [state](double time, const Eigen::VectorXd& x) { return PicturePoint{time, x(state)}; };
  for (std::size_t s = 0; s < orbit.segments.size(); ++s) {
    panel.curves.push_back(segment_curve(orbit.segments[s], place, stroke));
    if (orbit.jumps_after(s, state)) add_jump(panel, orbit, s, place, jump);
  }
}

void add_levels(Figure& figure, Panel& panel, const EventSurfaces& surfaces, const std::vector<OrbitTrace>& orbits,
                int state, double duration) {
  const auto [low, high] = range_along(orbits, state, 0.5);
  for (const EventSurfaces::Level& level : surfaces.of_state(state, low, high)) {
    std::size_t number = 0;
    auto known = std::find_if(figure.key.begin(), figure.key.end(),
                              [&level](const KeyEntry& entry) { return entry.text.text == level.event.name; });
    if (known == figure.key.end()) {
      for (const KeyEntry& entry : figure.key) number += entry.stroke->colour == surface_entry("", 0).stroke->colour;
      figure.key.push_back(surface_entry(level.event.name, number));
      known = figure.key.end() - 1;
    }
    for (const double value : level.values)
      panel.curves.push_back({{{-duration, value}, {2.0 * duration, value}}, *known->stroke, true});
  }
}

}  // namespace

Figure time_series(const std::vector<OrbitTrace>& orbits, const OrbitFigureOptions& options) {
  const int n = orbits.front().dimension();
  std::vector<int> states;
  for (const std::string& name : options.y) states.push_back(find_state(name, n, options, "-y"));
  if (states.empty())
    for (int k = 0; k < std::min(n, 2); ++k) states.push_back(k);
  double duration = 0.0;
  for (const OrbitTrace& orbit : orbits) duration = std::max(duration, orbit.period());

  Figure figure;
  LabelText all_names;
  const bool one_panel = options.one_panel || states.size() == 1;
  figure.panels.resize(one_panel ? 1 : states.size());
  for (std::size_t k = 0; k < orbits.size(); ++k)
    if ((!one_panel || states.size() == 1) && is_in_key(orbits, options))
      figure.key.push_back(orbit_entry(orbits, k, options));
  for (std::size_t i = 0; i < states.size(); ++i) {
    Panel& panel = figure.panels[one_panel ? 0 : i];
    const LabelText name = mathematical_name(state_name(states[i], options));
    all_names = all_names.empty() ? name : joined(joined(all_names, plain_text(", ")), name);
    panel.y.label = one_panel ? all_names : name;
    panel.x.label = plain_text("time");
    if (options.system != nullptr && options.surfaces)
      add_levels(figure, panel, EventSurfaces(*options.system, orbits, options.events), orbits, states[i], duration);
    for (std::size_t k = 0; k < orbits.size(); ++k) {
      // Several states in one panel: a colour for each state of each orbit, a symbol for each orbit.
      const bool by_state = one_panel && states.size() > 1;
      Stroke stroke = orbit_stroke(orbits, k);
      Marker jump = jump_marker(k, {}, true);
      jump.size = 0.7;
      if (by_state) {
        jump.colour = series_colour(k * states.size() + i);
        stroke = line_stroke(orbits[k].kind, jump.colour, 2.5);
        const LabelText comma = plain_text(", ");
        const std::size_t index = i * orbits.size() + k;
        const LabelText own = index < options.legend.size() ? plain_text(options.legend[index]) : LabelText{};
        const LabelText chosen = orbits.size() > 1 ? joined(joined(name, comma), orbit_name(orbits, k, options)) : name;
        figure.key.push_back({own.empty() ? chosen : own, stroke, std::nullopt});
      }
      add_series(panel, orbits[k], states[i], stroke, jump);
    }
  }
  const bool states_alone = one_panel && states.size() > 1 && orbits.size() == 1;
  if (!options.legend.empty() || states_alone) explain_dashes(figure, orbits);
  return figure;
}

}  // namespace tchat
