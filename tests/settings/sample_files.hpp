/// Constants files that several tests start from.
#pragma once

#include <string>

#include "settings/run_settings.hpp"

namespace tchat::testing {

/// The dissertation's Appendix B, character for character.
inline std::string appendix_b() {
  return "5 180 1 1\tNDIM, IPS, IRS, ILP\n"
         "3 1 61 62\tNICP, (ICP(I), I=1, NICP)\n"
         "50 2 3 2 1 0 0 0\tNTST, NCOL, IAD, ISP, ISW, IPLT, NBC, NINT\n"
         "1000 0.0 1.0 0.0 100.0\tNMX, RLO, RL1, A0, A1\n"
         "1 0 2 10 8 3 0\tNPR, MXBF, IID, ITMX, ITNW, NWTN, JAC\n"
         "1.e-10 1.e-10 1.e-10\tEPSL, EPSU, EPSS\n"
         "0.0001 0.0 0.005 1\tDS, DSMIN, DSMAX, IADS\n"
         "2\tNTHL, ((ITHL(I), THL(I)), I=1, NTHL)\n"
         "61 0.0\t\n"
         "62 0.0\t\n"
         "0\tNTHU, ((ITHU(I), THU(I)), I=1, NTHU)\n"
         "0\tNUZR, ((IUZR(I), UZR(I)), I=1, NUZR)\n"
         "0 1\tGCISTART, GCIDIFF\n"
         "3 1 2 3\tGCNPSI, (GCIPSI(I), I=1, GCNPSI)\n"
         "0\tGCNFIXED, (GCIFIXED(I), I=1, GCNFIXED)\n"
         "2 1 0\tGCNOSEG, (GCSEGTY(I), I=1, GCNOSEG)\n"
         "1 2\t(GCFIND(I), I=1, GCNOSEG)\n"
         "1 2\t(GCHIND(I), I=1, GCNOSEG)\n"
         "1 2\t(GCGIND(I), I=1, GCNOSEG)\n"
         "1 1\tGCHNO(1), (GCHGRZIND(I), I=1, GCHNO(1))\n"
         "2 2 1\tGCHNO(2), (GCHGRZIND(I+GCHNO(1)), I=1, GCHNO(2))\n";
}

/// The same with line `number` (from 1) replaced.
inline std::string appendix_b_with(int number, const std::string& line) {
  std::string text = appendix_b();
  std::size_t begin = 0;
  for (int i = 1; i < number; ++i) begin = text.find('\n', begin) + 1;
  return text.replace(begin, text.find('\n', begin) - begin, line);
}

/// Every constant equal; parameter values of the command line are none.
inline bool same_constants(const RunSettings& a, const RunSettings& b) {
  const auto numbers = [](const RunSettings& s) {
    return std::vector<double>{static_cast<double>(s.dimension),
                               static_cast<double>(s.problem_type),
                               static_cast<double>(s.start.number),
                               static_cast<double>(s.detect_folds),
                               static_cast<double>(s.mesh_intervals),
                               static_cast<double>(s.collocation_points),
                               static_cast<double>(s.adapt_mesh_every),
                               static_cast<double>(s.detect_bifurcations),
                               static_cast<double>(s.branch_mode),
                               static_cast<double>(s.measure),
                               static_cast<double>(s.boundary_conditions),
                               static_cast<double>(s.integral_conditions),
                               static_cast<double>(s.max_points),
                               s.parameter_min,
                               s.parameter_max,
                               s.measure_min,
                               s.measure_max,
                               static_cast<double>(s.print_every),
                               static_cast<double>(s.max_bifurcations),
                               static_cast<double>(s.diagnostics_level),
                               static_cast<double>(s.max_location_iterations),
                               static_cast<double>(s.max_newton),
                               static_cast<double>(s.full_newton),
                               static_cast<double>(s.jacobian),
                               s.tolerance_parameters,
                               s.tolerance_states,
                               s.tolerance_special,
                               s.step,
                               s.step_min,
                               s.step_max,
                               static_cast<double>(s.adapt_step_every),
                               static_cast<double>(s.grazing_start),
                               static_cast<double>(s.derivative_order),
                               s.stop_at_grazing ? 1.0 : 0.0,
                               static_cast<double>(s.grazing_jump),
                               s.stop_when_closed ? 1.0 : 0.0};
  };
  const auto pairs = [](const RunSettings& s) {
    std::vector<double> result;
    for (const auto& w : s.parameter_weights) result.insert(result.end(), {1.0, double(w.index), w.value});
    for (const auto& w : s.state_weights) result.insert(result.end(), {2.0, double(w.index), w.value});
    for (const auto& u : s.user_values)
      result.insert(result.end(), {3.0, double(u.parameter), u.value, u.stop ? 1.0 : 0.0});
    return result;
  };
  const auto segments = [](const RunSettings& s) {
    std::vector<int> result;
    for (const auto& segment : s.segments) {
      result.insert(result.end(), {segment.type, segment.index.field, segment.index.event, segment.index.jump});
      result.push_back(static_cast<int>(segment.monitor.size()));
      result.insert(result.end(), segment.monitor.begin(), segment.monitor.end());
    }
    return result;
  };
  const auto rules = [](const RunSettings& s) {
    std::string result = s.start.type;
    for (const auto& rule : s.stop_rules) result += " " + rule.type + std::to_string(rule.count);
    return result;
  };
  return numbers(a) == numbers(b) && pairs(a) == pairs(b) && segments(a) == segments(b) && rules(a) == rules(b) &&
         a.free_parameters == b.free_parameters && a.test_functions == b.test_functions && a.fixed == b.fixed;
}

}  // namespace tchat::testing
