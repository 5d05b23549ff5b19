/// One `tchat simulate`: what the command line says, before any file is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/simulation_run.hpp"

namespace tchat {

struct SimulationRequest {
  std::string name;
  std::optional<std::string> constants;  ///< -c
  std::optional<std::string> problem;    ///< -p
  std::optional<std::string> data;       ///< -d
  std::optional<std::string> start;      ///< -s
  std::optional<std::string> output;     ///< -o
  std::vector<std::string> overrides;    ///< KEY=VALUE

  std::optional<std::string> state;      ///< "0,0.1" or "x1=0.1,x2=3"
  std::optional<std::string> modes;      ///< "1,2,1;1,3,2"
  std::optional<std::string> signature;  ///< "1,1,1;2,2,2", followed cyclically
  bool follow_signature = false;         ///< of the constants file, even where there is an index jump function

  StartSide side;  ///< --after-event, --before-event; else of a label or .dat after, of other states not given

  SimulationPlan plan;
  double tolerance = 1e-10;  ///< relative, of one integration step
  double wait = 1000.0;      ///< longest time without an event
  double contact = 1e-3;
  int rows = 200;  ///< of the trajectory, for each segment
  bool stiff = false;
  bool quiet = false;

  std::optional<int> lyapunov;  ///< --lyapunov: how many exponents; 0 all
  int section = 0;              ///< --section: event function of a return map; 0: exponents of the flow
  double accuracy = 1e-3;       ///< of the exponents, where no length is given

  bool refine = false;                   ///< --refine: the motion recorded begins with about one period of an orbit
  bool hand_over = false;                ///< --dat: write the orbit for `tchat run`
  bool without_sections = false;         ///< Poincare sections end no segments of the orbit
  std::string orbit_name;                ///< its NAME2; empty: that of the output
  std::optional<std::string> parameter;  ///< --free: the continuation parameter
};

}  // namespace tchat
