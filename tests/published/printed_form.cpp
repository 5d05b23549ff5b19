#include "published/printed_form.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

namespace test_support {

PrintedForm printed_form(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    const std::size_t at = note.find("normal form ");
    const std::size_t equals = note.find(" = ", at), plus_minus = note.find(" +- ", at);
    if (at == std::string::npos || equals == std::string::npos || plus_minus == std::string::npos) continue;
    PrintedForm form;
    form.name = note.substr(at + 12, equals - at - 12);
    form.value = std::stod(note.substr(equals + 3));
    std::size_t length = 0;
    form.uncertainty = std::stod(note.substr(plus_minus + 4), &length);
    form.verdict = note.substr(plus_minus + 4 + length);
    return form;
  }
  return {};
}

PrintedForm form_at(const Workspace& workspace, const std::string& name, const std::string& type) {
  const std::vector<DiagnosticPoint> points = of_type(read_diagnostics(workspace.read("d." + name)), type);
  REQUIRE(!points.empty());
  INFO(workspace.read("d." + name));
  return printed_form(points.front().notes);
}

void simulate(const Workspace& workspace, const std::string& name, const std::string& formulas,
              const std::string& words) {
  workspace.write(name + ".tch", formulas);
  workspace.succeed("simulate " + name + " -o " + name + " --dat -q " + words);
}

double at_zero(const std::vector<double>& x, const std::vector<double>& y, int degree) {
  Eigen::MatrixXd powers(static_cast<Eigen::Index>(x.size()), degree + 1);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int k = 0; k <= degree; ++k) powers(static_cast<Eigen::Index>(i), k) = std::pow(x[i], k);
  const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(y.data(), static_cast<Eigen::Index>(y.size()));
  return powers.colPivHouseholderQr().solve(values)(0);
}

}  // namespace test_support
