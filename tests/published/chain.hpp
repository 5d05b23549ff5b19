/// The chain of runs of problems/linosc/Makefile in a workspace, and what their files tell: labels, multipliers.
#pragma once

#include <complex>
#include <map>
#include <string>
#include <vector>

#include "end_to_end/workspace.hpp"

namespace test_support {

inline constexpr double zeta = 0.05;
inline constexpr double restitution = 0.8;

/// q.grazing, then q.grazing_curve. One test runs them, the others read copies, as of what is below.
void run_to_grazing_curve(const Workspace& workspace);
/// With the above and q.impacting_OMEGA, OMEGA = 20072 or 18901.
void run_impacting(const Workspace& workspace, const std::string& omega);

/// A point of a d-file.
struct DiagnosticPoint {
  int branch = 0, point = 0, label = 0;  ///< point signed
  std::string type;                      ///< PD, GR, ...; empty for an ordinary point
  std::vector<std::complex<double>> multipliers;
  std::vector<std::string> notes;
  std::map<std::string, double> tests;  ///< values of the test functions that are defined
};
std::vector<DiagnosticPoint> read_diagnostics(const std::string& text);
const DiagnosticPoint& with_label(const std::vector<DiagnosticPoint>& points, int label);
/// Points of that type.
std::vector<DiagnosticPoint> of_type(const std::vector<DiagnosticPoint>& points, const std::string& type);

/// The solution of the only point of that type in the files NAME; fails the test when there are none or several.
SolutionEntry only(const Workspace& workspace, const std::string& name, const std::string& type);
/// The smallest distance of a multiplier to `value`.
double distance_to(const std::vector<std::complex<double>>& multipliers, std::complex<double> value);
/// Newton iterations of the first point of a d-file.
int first_iterations(const std::string& diagnostics);
/// Largest difference of time points, states and parameters of two solutions on equal meshes; of a state relative to
/// its size on the orbit, as Newton's method measures its steps.
double difference(const SolutionEntry& a, const SolutionEntry& b);

}  // namespace test_support
