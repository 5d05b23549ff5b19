#include "resegment/orbit_pieces.hpp"

#include <algorithm>

#include "bvp/mesh_adaptation.hpp"

namespace tchat {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Density of the old mesh at tau: intervals per unit of tau.
double density_at(const std::vector<double>& mesh, double tau) {
  const auto right = std::clamp<std::ptrdiff_t>(std::upper_bound(mesh.begin(), mesh.end(), tau) - mesh.begin(), 1,
                                                static_cast<std::ptrdiff_t>(mesh.size()) - 1);
  return 1.0 / (mesh[static_cast<std::size_t>(right)] - mesh[static_cast<std::size_t>(right - 1)]);
}

/// N intervals that follow the old mesh on every piece of positive duration.
std::vector<double> mesh_for(const Orbit& x, const std::vector<OrbitPiece>& pieces) {
  const int fine = 4 * x.shape.intervals;
  const std::vector<double> grid = uniform_mesh(fine);
  Eigen::VectorXd density = Eigen::VectorXd::Constant(fine, 1e-3);
  for (const OrbitPiece& piece : pieces)
    for (int j = 0; j < fine && !piece.empty(); ++j) {
      const double middle = 0.5 * (grid[index(j)] + grid[index(j + 1)]);
      density(j) += density_at(x.mesh, piece.from + (piece.to - piece.from) * middle) * (piece.to - piece.from);
    }
  return equal_parts(grid, density, x.shape.intervals);
}

/// Whole segments in another order, or repeated, and constant ones: of states, or of a direction's.
Eigen::MatrixXd copy_segments(const Eigen::MatrixXd& states, int nodes, const std::vector<OrbitPiece>& pieces) {
  Eigen::MatrixXd result(states.rows(), nodes * static_cast<Eigen::Index>(pieces.size()));
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    auto columns = result.middleCols(static_cast<Eigen::Index>(p) * nodes, nodes);
    if (pieces[p].constant.size() > 0)
      columns.colwise() = pieces[p].constant;
    else
      columns = states.middleCols(pieces[p].segment * nodes, nodes);
  }
  return result;
}

Eigen::MatrixXd resample(const Orbit& x, const std::vector<OrbitPiece>& pieces, const Orbit& target) {
  const CollocationRule rule(x.shape.collocation);
  Eigen::MatrixXd result(target.shape.dimension, target.shape.columns());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const OrbitPiece& piece = pieces[p];
    if (piece.constant.size() > 0) {
      result.middleCols(static_cast<Eigen::Index>(p) * target.shape.nodes(), target.shape.nodes()).colwise() =
          piece.constant;
      continue;
    }
    for (int k = 0; k < target.shape.nodes(); ++k)
      result.col(static_cast<Eigen::Index>(p) * target.shape.nodes() + k) =
          state_at(x, rule, piece.segment, piece.from + (piece.to - piece.from) * target.tau(k));
  }
  return result;
}

/// PAR(61..) of the new orbit; what the old one had beyond is zero.
void set_durations(const Orbit& x, const std::vector<OrbitPiece>& pieces, Orbit& target) {
  make_room(target.par, target.shape.segments);
  target.par.tail(target.par.size() - first_duration + 1).setZero();
  for (std::size_t p = 0; p < pieces.size(); ++p)
    target.duration(static_cast<int>(p)) = (pieces[p].to - pieces[p].from) * x.duration(pieces[p].segment);
}

/// A list of pieces as one segment in the time of their own.
class JoinedPieces {
 public:
  JoinedPieces(const Orbit& x, const std::vector<OrbitPiece>& pieces) : pieces_(pieces) {
    for (const OrbitPiece& piece : pieces)
      ends_.push_back((ends_.empty() ? 0.0 : ends_.back()) + (piece.to - piece.from) * x.duration(piece.segment));
  }

  double duration() const { return ends_.back(); }

  struct Place {
    int segment;
    double tau;
    double rate;  ///< of the old tau by the new one
  };
  Place at(double tau) const {
    const double time = tau * duration();
    std::size_t k = 0;
    while (k + 1 < ends_.size() && time > ends_[k]) ++k;
    const OrbitPiece& piece = pieces_[k];
    const double begin = k > 0 ? ends_[k - 1] : 0.0;
    const double rate = (piece.to - piece.from) / (ends_[k] - begin);
    return {piece.segment, std::clamp(piece.from + rate * (time - begin), 0.0, 1.0), rate * duration()};
  }

 private:
  const std::vector<OrbitPiece>& pieces_;
  std::vector<double> ends_;  // times
};

}  // namespace

Orbit joined_orbit(const Orbit& old, const std::vector<std::vector<OrbitPiece>>& groups) {
  Orbit result;
  result.shape = old.shape;
  result.shape.segments = static_cast<int>(groups.size());
  result.par = old.par;
  make_room(result.par, result.shape.segments);
  result.par.tail(result.par.size() - first_duration + 1).setZero();
  const int fine = 8 * old.shape.intervals;
  const std::vector<double> grid = uniform_mesh(fine);
  Eigen::VectorXd density = Eigen::VectorXd::Constant(fine, 1e-3);
  std::vector<JoinedPieces> joined;
  for (const auto& pieces : groups) {
    joined.emplace_back(old, pieces);
    result.duration(static_cast<int>(joined.size()) - 1) = joined.back().duration();
    for (int j = 0; j < fine; ++j) {
      const JoinedPieces::Place place = joined.back().at(0.5 * (grid[index(j)] + grid[index(j + 1)]));
      density(j) += density_at(old.mesh, place.tau) * place.rate;
    }
  }
  result.mesh = equal_parts(grid, density, old.shape.intervals);
  const CollocationRule rule(old.shape.collocation);
  result.states.resize(result.shape.dimension, result.shape.columns());
  for (std::size_t s = 0; s < joined.size(); ++s)
    for (int k = 0; k < result.shape.nodes(); ++k) {
      const JoinedPieces::Place place = joined[s].at(result.tau(k));
      result.states.col(static_cast<Eigen::Index>(s) * result.shape.nodes() + k) =
          state_at(old, rule, place.segment, place.tau);
    }
  return result;
}

Eigen::VectorXd end_of(const OrbitPiece& piece, const Orbit& x) {
  if (piece.constant.size() > 0) return piece.constant;
  return state_at(x, CollocationRule(x.shape.collocation), piece.segment, piece.to);
}

Eigen::VectorXd state_at(const Orbit& x, const CollocationRule& rule, int s, double tau) {
  const auto right = std::upper_bound(x.mesh.begin(), x.mesh.end(), tau) - x.mesh.begin();
  const int j = std::clamp(static_cast<int>(right) - 1, 0, x.shape.intervals - 1);
  const int c = x.shape.collocation;
  Eigen::VectorXd basis(c + 1);
  rule.basis((tau - x.mesh[index(j)]) / (x.mesh[index(j + 1)] - x.mesh[index(j)]), basis.data(), nullptr);
  return x.states.middleCols(s * x.shape.nodes() + j * c, c + 1) * basis;
}

OrbitStart assemble(const OrbitStart& old, const std::vector<OrbitPiece>& pieces) {
  const Orbit& x = old.orbit;
  OrbitStart result;
  result.orbit.shape = x.shape;
  result.orbit.shape.segments = static_cast<int>(pieces.size());
  result.orbit.par = x.par;
  set_durations(x, pieces, result.orbit);
  const auto is_whole = [](const OrbitPiece& piece) { return piece.whole(); };
  const bool whole = std::all_of(pieces.begin(), pieces.end(), is_whole);
  const bool copied = std::all_of(pieces.begin(), pieces.end(), [&](const OrbitPiece& piece) {
    return is_whole(piece) || piece.constant.size() > 0;
  });
  if (!copied) {
    result.orbit.mesh = mesh_for(x, pieces);
    result.orbit.states = resample(x, pieces, result.orbit);
    return result;
  }
  result.orbit.mesh = x.mesh;
  result.orbit.states = copy_segments(x.states, x.shape.nodes(), pieces);
  if (!whole || !old.direction) return result;
  OrbitVector direction(result.orbit.shape, static_cast<int>(old.direction->globals.size()));
  direction.states = copy_segments(old.direction->states, x.shape.nodes(), pieces);
  direction.globals = old.direction->globals;
  for (std::size_t p = 0; p < pieces.size(); ++p)
    direction.durations(static_cast<Eigen::Index>(p)) = old.direction->durations(pieces[p].segment);
  result.direction = std::move(direction);
  return result;
}

}  // namespace tchat
