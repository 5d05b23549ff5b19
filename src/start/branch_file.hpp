/// A p-file with what the q-file and d-file beside it add: names of UZ points, values of fixed parameters, and which
/// points violate the model.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "start/point_file_reader.hpp"

namespace tchat {

/// One continuous branch: rows [begin, end) of a section.
struct BranchPiece {
  std::size_t section = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct BranchFile {
  std::string path;
  std::string name;  ///< without folder and "p."
  std::vector<PointSection> sections;
  std::vector<BranchPiece> pieces;
  std::vector<std::vector<std::string>> types;  ///< letters of each point by section and row; "" for an ordinary point
  std::vector<std::vector<bool>> admissible;    ///< true where the d-file does not say otherwise
  std::map<int, std::vector<int>> xi_zeros;     ///< by label: the n of every xi_n that vanishes there
  std::vector<std::map<int, double>> parameters;  ///< by section: PAR(k) at one of its labels, if the q-file is there
  std::vector<std::string> warnings;
};

/// Reads p.NAME, and q.NAME and d.NAME if they are beside it and can be read (a warning if not).
BranchFile read_branch_file(const std::string& path);

}  // namespace tchat
