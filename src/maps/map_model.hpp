/// The grazing motion of `tchat sweep --map`: what the command asks for, and the maps made of it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "maps/composite_map.hpp"
#include "maps/discontinuity_map.hpp"
#include "maps/grazing_point.hpp"
#include "maps/torus_return.hpp"
#include "model/hybrid_system.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// One `tchat sweep --map`: what the command line says of the map.

struct MapRequest {
  std::string source;                   ///< q.NAME:LABEL, or a file of section points of a torus
  std::string order = "3/2";            ///< of the discontinuity map: 1/2, 1, 3/2 or exact
  int smooth_order = 1;                 ///< of the smooth return map: 1 or 2
  std::optional<std::string> reduced;   ///< "map" or "ellipse": the phase of a torus alone
  std::optional<std::string> phase;     ///< a state that is an angle, or two states "y1,y2" that go round
  std::optional<std::string> wall;      ///< event function of the contact, by number or name
  std::optional<double> neighbourhood;  ///< of x*, in extents of the torus, in which contact is accounted for
};

// The grazing motion that a composite map stands for, and what its maps are made of.

/// What of the command line a model needs beside the map's options.
struct MapContext {
  ParameterVector par;                   ///< of the plugin and the command line
  std::vector<int> swept;                ///< PAR indices
  std::vector<int> given;                ///< PAR indices whose values the command line has, in `par`
  std::optional<std::string> constants;  ///< -c
  RunSettings settings;                  ///< of the constants file, where there is one
  std::optional<std::string> section;    ///< --section
};

struct MapModel {
  GrazingPoint point;
  std::optional<CrossSection> section;  ///< P', or P
  std::shared_ptr<const SmoothMap> smooth;
  std::shared_ptr<const TorusReturn> torus;  ///< the same, of a torus
  double phase = 0.0;                        ///< of x* on it
  ParameterVector par;                       ///< those of the motion, with the command line's
  IndexVector free;                          ///< a return without contact
  IndexVector contact;                       ///< a return with one
  double neighbourhood = 0.0;
  std::vector<std::string> text;  ///< lines for people: what it is
  std::string identity;           ///< what it has been made of
};

/// Is `source` a label of a q-file, FILE:LABEL?
bool names_label(const std::string& source);

/// `system` outlives the model. Throws UserError for what is wrong with the source, ComputationError when it cannot be
/// integrated.
MapModel map_model(const MapRequest& request, const MapContext& context, const HybridSystem& system);

/// "1/2", "1", "3/2", "exact". Throws UserError.
MapOrder map_order(const std::string& text);

/// The map that is iterated; `system` is the worker's own.
std::unique_ptr<IteratedMap> iterated_map(const MapRequest& request, const MapModel& model, const HybridSystem& system);

}  // namespace tchat
