#include "resegment/orbit_pieces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "files/dat_file.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "run/branch_setup.hpp"
#include "run/own_units.hpp"

namespace tchat {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Density of the old mesh of segment s at tau: intervals per unit of tau.
double density_at(const Orbit& x, int s, double tau) {
  const double* const left = x.mesh_of(s) + interval_at(x, s, tau);
  return 1.0 / (left[1] - left[0]);
}

constexpr double least_density = 1e-3;

/// Meshes of their own for the segments of `target`, whose points come from place(segment, tau) of the old orbit: each
/// has the density of the old mesh there, and its share of the intervals.
template <class PlaceOf>
void set_own_meshes(const Orbit& x, const PlaceOf& place, Orbit& target) {
  const int m = target.shape.segments;
  int fine = 0;
  for (int s = 0; s < x.shape.segments; ++s) fine = std::max(fine, 8 * x.shape.intervals_of(s));
  const std::vector<double> grid = uniform_mesh(fine);
  Eigen::MatrixXd densities = Eigen::MatrixXd::Constant(fine, m, least_density);
  for (int p = 0; p < m; ++p)
    for (int j = 0; j < fine; ++j) {
      const auto at = place(p, 0.5 * (grid[index(j)] + grid[index(j + 1)]));
      if (at.rate > 0.0) densities(j, p) += density_at(x, at.segment, at.tau) * at.rate;
    }
  std::vector<int> counts;
  deal_out(densities.colwise().mean().transpose(), target.shape.total_intervals(), least_own_intervals, counts);
  target.shape.own = OwnIntervals(counts);
  target.mesh.clear();
  for (int p = 0; p < m; ++p) {
    const std::vector<double> mesh = equal_parts(grid, densities.col(p), counts[index(p)]);
    target.mesh.insert(target.mesh.end(), mesh.begin(), mesh.end());
  }
}

/// A point of the old orbit.
struct OldPoint {
  int segment;
  double tau;
  double rate;  ///< of the old tau by the new one
};

OldPoint place_in(const OrbitPiece& piece, double tau) {
  return {piece.segment, piece.from + (piece.to - piece.from) * tau, piece.to - piece.from};
}

/// N intervals that follow the old mesh on every piece of positive duration.
std::vector<double> mesh_for(const Orbit& x, const std::vector<OrbitPiece>& pieces) {
  const int fine = 4 * x.shape.intervals;
  const std::vector<double> grid = uniform_mesh(fine);
  Eigen::VectorXd density = Eigen::VectorXd::Constant(fine, least_density);
  for (const OrbitPiece& piece : pieces)
    for (int j = 0; j < fine && !piece.empty(); ++j) {
      const OldPoint at = place_in(piece, 0.5 * (grid[index(j)] + grid[index(j + 1)]));
      density(j) += density_at(x, at.segment, at.tau) * at.rate;
    }
  return equal_parts(grid, density, x.shape.intervals);
}

/// Whole segments in another order, or repeated, and constant ones: of states, or of a direction's.
Eigen::MatrixXd copy_segments(const Eigen::MatrixXd& states, const OrbitShape& from, const OrbitShape& to,
                              const std::vector<OrbitPiece>& pieces) {
  Eigen::MatrixXd result(states.rows(), to.columns());
  for (int p = 0; p < to.segments; ++p) {
    const OrbitPiece& piece = pieces[index(p)];
    auto columns = result.middleCols(to.first_node(p), to.nodes_of(p));
    if (piece.constant.size() > 0)
      columns.colwise() = piece.constant;
    else
      columns = states.middleCols(from.first_node(piece.segment), from.nodes_of(piece.segment));
  }
  return result;
}

/// Do whole segments keep their meshes? Own ones do where their intervals sum up to those of as many segments.
bool keeps_meshes(const OrbitShape& shape, const std::vector<OrbitPiece>& pieces) {
  if (!shape.own) return true;
  int intervals = 0;
  for (const OrbitPiece& piece : pieces) intervals += shape.intervals_of(piece.segment);
  return intervals == shape.intervals * static_cast<int>(pieces.size());
}

/// The meshes of the pieces, which are whole segments.
void copy_meshes(const Orbit& x, const std::vector<OrbitPiece>& pieces, Orbit& target) {
  target.mesh = x.mesh;
  if (!x.shape.own) return;
  std::vector<int> counts;
  target.mesh.clear();
  for (const OrbitPiece& piece : pieces) {
    counts.push_back(x.shape.intervals_of(piece.segment));
    const double* const mesh = x.mesh_of(piece.segment);
    target.mesh.insert(target.mesh.end(), mesh, mesh + counts.back() + 1);
  }
  target.shape.own = OwnIntervals(counts);
}

Eigen::MatrixXd resample(const Orbit& x, const std::vector<OrbitPiece>& pieces, const Orbit& target) {
  const CollocationRule rule(x.shape.collocation);
  Eigen::MatrixXd result(target.shape.dimension, target.shape.columns());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const OrbitPiece& piece = pieces[p];
    const auto s = static_cast<int>(p);
    const int first = target.shape.first_node(s);
    if (piece.constant.size() > 0) {
      result.middleCols(first, target.shape.nodes_of(s)).colwise() = piece.constant;
      continue;
    }
    for (int k = 0; k < target.shape.nodes_of(s); ++k)
      result.col(first + k) = state_at(x, rule, piece.segment, place_in(piece, target.tau(s, k)).tau);
  }
  return result;
}

/// The durations of the new orbit; what the old one had beyond is zero.
void set_durations(const Orbit& x, const std::vector<OrbitPiece>& pieces, Orbit& target) {
  target.par.make_room(target.shape.segments);
  target.par.clear_durations();
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

  OldPoint at(double tau) const {
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

/// N intervals that follow the old mesh on all joined pieces.
std::vector<double> mesh_for(const Orbit& x, const std::vector<JoinedPieces>& joined) {
  const int fine = 8 * x.shape.intervals;
  const std::vector<double> grid = uniform_mesh(fine);
  Eigen::VectorXd density = Eigen::VectorXd::Constant(fine, least_density);
  for (const JoinedPieces& pieces : joined)
    for (int j = 0; j < fine; ++j) {
      const OldPoint at = pieces.at(0.5 * (grid[index(j)] + grid[index(j + 1)]));
      density(j) += density_at(x, at.segment, at.tau) * at.rate;
    }
  return equal_parts(grid, density, x.shape.intervals);
}

}  // namespace

Orbit joined_orbit(const Orbit& old, const std::vector<std::vector<OrbitPiece>>& groups) {
  Orbit result;
  result.shape = old.shape.in_common();
  result.shape.segments = static_cast<int>(groups.size());
  result.par = old.par;
  result.par.make_room(result.shape.segments);
  result.par.clear_durations();
  std::vector<JoinedPieces> joined;
  for (const auto& pieces : groups) {
    joined.emplace_back(old, pieces);
    result.duration(static_cast<int>(joined.size()) - 1) = joined.back().duration();
  }
  if (old.shape.own)
    set_own_meshes(
        old, [&](int s, double tau) { return joined[index(s)].at(tau); }, result);
  else
    result.mesh = mesh_for(old, joined);
  const CollocationRule rule(old.shape.collocation);
  result.states.resize(result.shape.dimension, result.shape.columns());
  for (int s = 0; s < result.shape.segments; ++s)
    for (int k = 0; k < result.shape.nodes_of(s); ++k) {
      const OldPoint place = joined[index(s)].at(result.tau(s, k));
      result.states.col(result.shape.first_node(s) + k) = state_at(old, rule, place.segment, place.tau);
    }
  return result;
}

Eigen::VectorXd end_of(const OrbitPiece& piece, const Orbit& x) {
  if (piece.constant.size() > 0) return piece.constant;
  return state_at(x, CollocationRule(x.shape.collocation), piece.segment, piece.to);
}

OrbitStart assemble(const OrbitStart& old, const std::vector<OrbitPiece>& pieces) {
  const Orbit& x = old.orbit;
  OrbitStart result;
  result.orbit.shape = x.shape.in_common();
  result.orbit.shape.segments = static_cast<int>(pieces.size());
  result.orbit.par = x.par;
  set_durations(x, pieces, result.orbit);
  const auto is_whole = [](const OrbitPiece& piece) { return piece.whole(); };
  const bool whole = std::all_of(pieces.begin(), pieces.end(), is_whole);
  const bool copied =
      keeps_meshes(x.shape, pieces) && std::all_of(pieces.begin(), pieces.end(), [&](const OrbitPiece& piece) {
        return is_whole(piece) || piece.constant.size() > 0;
      });
  if (!copied) {
    if (x.shape.own)
      set_own_meshes(
          x, [&](int p, double tau) { return place_in(pieces[index(p)], tau); }, result.orbit);
    else
      result.orbit.mesh = mesh_for(x, pieces);
    result.orbit.states = resample(x, pieces, result.orbit);
    return result;
  }
  copy_meshes(x, pieces, result.orbit);
  result.orbit.states = copy_segments(x.states, x.shape, result.orbit.shape, pieces);
  if (!whole || !old.direction) return result;
  OrbitVector direction(result.orbit.shape, static_cast<int>(old.direction->globals.size()));
  direction.states = copy_segments(old.direction->states, x.shape, result.orbit.shape, pieces);
  direction.globals = old.direction->globals;
  for (std::size_t p = 0; p < pieces.size(); ++p)
    direction.durations(static_cast<Eigen::Index>(p)) = old.direction->durations(pieces[p].segment);
  result.direction = std::move(direction);
  return result;
}

namespace {

/// Of a parameter or a duration: what the correction of a start may change.
constexpr double correction_moves_at_most = level::same;
/// A smaller part of the tangent is no change.
constexpr double no_change = level::converged;

/// -1, 0 or 1: the sign of a . t + b . g, 0 where that is rounding of its terms.
int sign_of(const Eigen::RowVectorXd& a, const Eigen::VectorXd& t, const Eigen::RowVectorXd& b,
            const Eigen::VectorXd& g) {
  const double rate = a.dot(t) + b.dot(g);
  const double terms = a.cwiseAbs().dot(t.cwiseAbs()) + b.cwiseAbs().dot(g.cwiseAbs());
  return std::abs(rate) > no_change * terms ? (rate > 0.0 ? 1 : -1) : 0;
}

/// The sign of d(h_x f) at the end of segment `impact` along the tangent: the second condition of a grazing orbit.
int slope_along_tangent(const HybridSystem& system, const DefiningSystem& defining, const PathPoint& point,
                        int impact) {
  const GrazingOrbitSystem grazing(system, defining.signature(), defining.free_parameters(), impact);
  Eigen::Vector2d values;
  Eigen::Matrix2Xd by_state(2, grazing.dimension());
  Eigen::Matrix2Xd by_parameter(2, grazing.free_count());
  grazing.end_derivatives(impact, point.orbit.end(impact), point.orbit.par.data(), values.data(), by_state.data(),
                          by_parameter.data());
  const Eigen::Index end = point.orbit.shape.last_node(impact);
  return sign_of(by_state.row(1), point.tangent.states.col(end), by_parameter.row(1), point.tangent.globals);
}

/// The sign of dh at the end of a segment along the tangent.
int event_along_tangent(const HybridSystem& system, const DefiningSystem& defining, const PathPoint& point,
                        const Birth::EndEvent& at) {
  Eigen::RowVectorXd by_state(defining.dimension());
  Eigen::RowVectorXd by_parameter(defining.free_count());
  double h = 0.0;
  system.first(FunctionKind::event, at.event, point.orbit.end(at.segment), point.orbit.par.data(),
               defining.free_parameters(), &h, by_state.data(), by_parameter.data());
  const Eigen::Index end = point.orbit.shape.last_node(at.segment);
  return sign_of(by_state, point.tangent.states.col(end), by_parameter, point.tangent.globals);
}

/// The sign of dh along the tangent at a place where the surface is touched: as h_x f = 0 there, that of the least
/// value of h.
int least_along_tangent(const HybridSystem& system, const DefiningSystem& defining, const PathPoint& point,
                        const Birth::InnerContact& at) {
  const Orbit& x = point.orbit;
  const CollocationRule rule(x.shape.collocation);
  Orbit tangent = x;
  tangent.states = point.tangent.states;
  const Eigen::VectorXd state = state_at(x, rule, at.segment, at.tau);
  Eigen::RowVectorXd by_state(defining.dimension());
  Eigen::RowVectorXd by_parameter(defining.free_count());
  double h = 0.0;
  system.first(FunctionKind::event, at.event, state.data(), x.par.data(), defining.free_parameters(), &h,
               by_state.data(), by_parameter.data());
  return sign_of(by_state, state_at(tangent, rule, at.segment, at.tau), by_parameter, point.tangent.globals);
}

/// Of parameters and durations. The monitors behind them in PAR are evaluated by the run, not stored in its start.
bool has_moved(const HybridSystem& system, const Orbit& found, const Orbit& start) {
  const ParameterLayout& layout = start.par.layout();
  const int segments = start.shape.segments;
  for (int k = 1; k < layout.first_monitor(segments); ++k) {
    const double before = start.par(k - 1);
    const double size = layout.is_duration(k, segments) ? std::abs(start.period()) : system.parameter_size(k, before);
    if (std::abs(found.par(k - 1) - before) > correction_moves_at_most * size) return true;
  }
  return false;
}

}  // namespace

int side_of_birth(const HybridSystem& users, const RunSettings& settings, const SelectedStart& start,
                  const Birth& birth) {
  try {
    const OwnUnits own = in_own_units(users, settings, start);
    const HybridSystem& system = own.system();
    const BranchSetup setup = set_up_branch(system, own.settings, own.start);
    const PathPoint& point = setup.start.point;
    if (has_moved(system, point.orbit, start.start.orbit)) return 0;
    const double least_duration = no_change * setup.follower->relative_length(point) * point.orbit.period();
    const auto duration_along_tangent = [&](int s) {
      const double rate = point.tangent.durations(s);
      return std::abs(rate) > least_duration ? (rate > 0.0 ? 1 : -1) : 0;
    };
    std::vector<int> sides;
    for (const int s : birth.impacts) sides.push_back(-slope_along_tangent(system, *setup.defining, point, s));
    for (const int s : birth.empty_segments) sides.push_back(duration_along_tangent(s));
    for (const Birth::EndEvent& late : birth.late_events)
      sides.push_back(event_along_tangent(system, *setup.defining, point, late));
    for (const Birth::InnerContact& lost : birth.lost_contacts)
      sides.push_back(least_along_tangent(system, *setup.defining, point, lost));
    for (const int side : sides)
      if (side != sides.front()) return 0;
    return sides.empty() ? 0 : sides.front();
  } catch (const ComputationError&) {
    return 0;  // the run itself will say why
  }
}

std::string data_text(const Orbit& x, const HybridSystem& system) {
  std::string text = parameter_lines(system, x.par);
  for (int s = 0; s < x.shape.segments; ++s)
    text += fmt::format("# PAR({}) = {}\n", x.par.layout().duration(s), x.duration(s));
  const LabelledSolution rows = labelled_solution(x, {}, {}, {});
  for (Eigen::Index k = 0; k < rows.states.cols(); ++k) {
    text += fmt::format("{:.15g}", rows.tau[static_cast<std::size_t>(k)]);
    for (Eigen::Index i = 0; i < rows.states.rows(); ++i) text += fmt::format(" {:.15g}", rows.states(i, k));
    text += '\n';
  }
  return text;
}

}  // namespace tchat
