/// The normal form that a label prints, as tests read it.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "published/chain.hpp"

namespace test_support {

/// "normal form NAME = VALUE +- UNCERTAINTY, ..." of a label.
struct PrintedForm {
  std::string name, verdict;
  double value = NAN, uncertainty = NAN;
};

/// Of the note that has one; a value that is not a number where none has.
PrintedForm printed_form(const std::vector<std::string>& notes);

/// That of the first label of a type in d.NAME, which there has to be.
PrintedForm form_at(const Workspace& workspace, const std::string& name, const std::string& type);

/// Writes NAME.tch and the start NAME.dat of a short simulation; `words` are further ones of `tchat simulate`.
void simulate(const Workspace& workspace, const std::string& name, const std::string& formulas,
              const std::string& words);

/// The constant term of the polynomial of this degree through points, by least squares.
double at_zero(const std::vector<double>& x, const std::vector<double>& y, int degree);

}  // namespace test_support
