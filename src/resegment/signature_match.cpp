#include "resegment/signature_match.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "motion/orbit_flow.hpp"

namespace tchat {

namespace {

constexpr double fit_tolerance = level::five_digits;

std::vector<IndexVector> successors(const HybridSystem& system, const IndexVector& from, const Eigen::VectorXd& x,
                                    const ParameterVector& par) {
  return system.successors(from, x.data(), par.data()).value_or(std::vector<IndexVector>{});
}

bool has_field(const std::vector<IndexVector>& list, int field) {
  return std::any_of(list.begin(), list.end(), [&](const IndexVector& v) { return v.field == field; });
}

struct Following {
  Eigen::VectorXd at;
  std::vector<IndexVector> list;  ///< empty where nothing was found
};

/// At x or beside it, in the direction of one state.
Following successors_with_field(const HybridSystem& system, const IndexVector& before, const Eigen::VectorXd& x,
                                const ParameterVector& par, const Eigen::VectorXd& sizes, int field) {
  constexpr double beside = 1e-3;
  for (Eigen::Index k = -1; k < 2 * x.size(); ++k) {
    Eigen::VectorXd at = x;
    if (k >= 0) at(k / 2) += (k % 2 == 0 ? beside : -beside) * sizes(k / 2);
    std::vector<IndexVector> list = successors(system, before, at, par);
    if (has_field(list, field)) return {at, std::move(list)};
  }
  return {x, {}};
}

/// Is the state on the surface of the event that ends a segment which begins there?
bool is_at_event(const HybridSystem& system, const IndexVector& v, const Eigen::VectorXd& x,
                 const ParameterVector& par) {
  const EventAt at = event_at(system, v.event, x.data(), par.data());
  return std::abs(at.h) <= fit_tolerance * at.scale(x.data(), sizes_at(system, v.field, x, par));
}

std::string event_text(const HybridSystem& system, int event) {
  return fmt::format("event {} ({})", event, system.function_name(FunctionKind::event, event));
}

}  // namespace

Signature segments_after_impact(const HybridSystem& system, const IndexVector& after, const Eigen::VectorXd& x,
                                const ParameterVector& par, int next_field) {
  if (!system.has_successors()) return {};
  const std::vector<IndexVector> following = successors(system, after, x, par);
  if (following.empty() || has_field(following, next_field)) return {};
  Eigen::VectorXd start(x.size());
  system.value(FunctionKind::jump, after.jump, x.data(), par.data(), start.data());
  Signature candidates;
  for (const IndexVector& v : following)
    if (is_at_event(system, v, start, par) && has_field(successors(system, v, start, par), next_field))
      candidates.push_back(v);
  if (candidates.size() == 1) return candidates;
  throw UserError(fmt::format(
      "after {} the index jump function of problem {} allows {}, and {} of these can last no time and be followed by "
      "field {} ({}); give the whole signature, for example --signature \"1,1,1;2,2,2\", where two events come at once "
      "with --to signature",
      to_string({after}), system.name(), to_string(following), candidates.empty() ? "none" : to_string(candidates),
      next_field, system.function_name(FunctionKind::field, next_field)));
}

std::vector<int> watched_after(const HybridSystem& system, const IndexVector& before, const Eigen::VectorXd& x,
                               const ParameterVector& par, const Eigen::VectorXd& sizes, const IndexVector& own,
                               int next_field) {
  const auto [at, following] = successors_with_field(system, before, x, par, sizes, own.field);
  Eigen::VectorXd start(x.size());
  system.value(FunctionKind::jump, before.jump, at.data(), par.data(), start.data());
  std::vector<int> events = relevant_events(system, following, own.field, start.data(), par.data());
  std::erase(events, own.event);
  const bool ends_in_section = is_identity_jump(system, own) && next_field == own.field;
  const bool is_listed = std::find(following.begin(), following.end(), own) != following.end();
  if (is_listed && !ends_in_section) events.push_back(own.event);
  std::sort(events.begin(), events.end());
  return events;
}

void require_fit(const HybridSystem& system, const Signature& signature, const Orbit& x) {
  const int m = x.shape.segments;
  const Eigen::VectorXd sizes = state_sizes(system, signature, x);
  const double* par = x.par.data();
  for (int s = 0; s < m; ++s) {
    const IndexVector& v = signature[static_cast<std::size_t>(s)];
    const Eigen::Map<const Eigen::VectorXd> end(x.end(s), x.shape.dimension);
    const Eigen::Map<const Eigen::VectorXd> next(x.start((s + 1) % m), x.shape.dimension);
    const double h = system.event(v.event, end.data(), par);
    if (!(relative_event(system, v.event, end, par, sizes) <= fit_tolerance))
      throw UserError(
          fmt::format("signature {} does not fit the orbit: {} is {:.4g}, not 0, at the end of segment {}; constants "
                      "or problem are not those of the run that wrote the label, or the signature is wrong",
                      to_string(signature), event_text(system, v.event), h, s + 1));
    Eigen::VectorXd after(end.size());
    system.value(FunctionKind::jump, v.jump, end.data(), par, after.data());
    Eigen::Index worst = 0;
    const double gap = (after - next).cwiseAbs().cwiseQuotient(sizes).maxCoeff(&worst);
    if (!(gap <= fit_tolerance))
      throw UserError(fmt::format(
          "signature {} does not fit the orbit: jump {} ({}) at the end of segment {} leads to {} = {:.6g}, segment {} "
          "starts with {:.6g}",
          to_string(signature), v.jump, system.function_name(FunctionKind::jump, v.jump), s + 1,
          system.state_name(static_cast<int>(worst) + 1), after(worst), (s + 1) % m + 1, next(worst)));
  }
}

namespace {

using Vector = Eigen::VectorXd;

constexpr std::size_t most_new_segments = 4;           // of zero duration: the ways to place them are all tried
constexpr double misfit_of_none = level::five_digits;  // relative; what Newton is meant to repair is less

Vector state(const double* x, int n) { return Eigen::Map<const Vector>(x, n); }

/// Which old segment (position in `lasting`) each index vector takes; none: zero duration.
using Places = std::vector<std::optional<std::size_t>>;

class SignatureMatch {
 public:
  SignatureMatch(const HybridSystem& system, const SegmentList& old, const Orbit& x, const Signature& signature)
      : system_(system), x_(x), signature_(signature) {
    Signature known;
    for (const NewSegment& segment : old) known.push_back(segment.index);
    sizes_ = state_sizes(system, known, x);
    for (const NewSegment& segment : old)
      if (!lasts_no_time(x, segment.piece.segment)) lasting_.push_back(segment);
    check_numbers(old.size());
  }

  SegmentList best() {
    for (rotation_ = 0; rotation_ < lasting_.size(); ++rotation_) {
      places_.assign(signature_.size(), std::nullopt);
      place(0, 0);
    }
    if (!best_places_)
      throw UserError(
          fmt::format("--signature {}: the orbit's segments that last some time have the fields {}, which "
                      "do not follow each other in this signature",
                      to_string(signature_), fields()));
    const SegmentList segments = segments_of(*best_places_, best_rotation_);
    if (!(best_misfit_ <= 1.0)) refuse(segments);
    return segments;
  }

 private:
  void check_numbers(std::size_t old_count) const {
    if (lasting_.empty()) throw UserError("no segment of the orbit lasts any time");
    if (signature_.size() < lasting_.size())
      throw UserError(fmt::format("--signature has {} index vectors, but {} of the orbit's {} segments last some time",
                                  signature_.size(), lasting_.size(), old_count));
    if (signature_.size() > lasting_.size() + most_new_segments)
      throw UserError(
          fmt::format("--signature has {} index vectors for {} segments that last some time; at most {} "
                      "segments of zero duration can be put in at once",
                      signature_.size(), lasting_.size(), most_new_segments));
  }

  std::string fields() const {
    std::string list;
    for (const NewSegment& segment : lasting_)
      list += fmt::format("{}{}", list.empty() ? "" : ", ", segment.index.field);
    return list;
  }

  const NewSegment& old_segment(std::size_t k, std::size_t rotation) const {
    return lasting_[(k + rotation) % lasting_.size()];
  }

  /// All ways to place the old segments from `next` on at index vectors from `at` on.
  void place(std::size_t at, std::size_t next) {
    if (next == lasting_.size()) return compare();
    if (signature_.size() - at < lasting_.size() - next) return;
    if (signature_[at].field == old_segment(next, rotation_).index.field) {
      places_[at] = next;
      place(at + 1, next + 1);
      places_[at] = std::nullopt;
    }
    place(at + 1, next);
  }

  void compare() {
    const double misfit = misfit_of(segments_of(places_, rotation_));
    if (best_places_ && !(misfit < best_misfit_)) return;
    best_misfit_ = misfit;
    best_places_ = places_;
    best_rotation_ = rotation_;
  }

  Vector after(const IndexVector& v, const Vector& end) const {
    Vector result(end.size());
    system_.value(FunctionKind::jump, v.jump, end.data(), x_.par.data(), result.data());
    return result;
  }

  Vector end_of(const NewSegment& segment) const {
    const OrbitPiece& piece = segment.piece;
    return piece.constant.size() > 0 ? piece.constant : state(x_.end(piece.segment), x_.shape.dimension);
  }

  Vector start_of(const NewSegment& segment) const {
    const OrbitPiece& piece = segment.piece;
    return piece.constant.size() > 0 ? piece.constant : state(x_.start(piece.segment), x_.shape.dimension);
  }

  SegmentList segments_of(const Places& places, std::size_t rotation) const {
    const std::size_t m = signature_.size();
    SegmentList segments(m);
    const auto first = static_cast<std::size_t>(
        std::find_if(places.begin(), places.end(), [](const auto& p) { return p.has_value(); }) - places.begin());
    for (std::size_t i = 0; i < m; ++i) {
      const std::size_t s = (first + i) % m;
      if (places[s]) {
        segments[s] = old_segment(*places[s], rotation);
        segments[s].grazes = segments[s].grazes && segments[s].index.event == signature_[s].event;
      } else {
        const NewSegment& before = segments[(s + m - 1) % m];
        segments[s].piece = {before.piece.segment, 1.0, 1.0, after(before.index, end_of(before))};
      }
      segments[s].index = signature_[s];
    }
    return segments;
  }

  /// The largest violation of a terminal event and the jump there, relative to what Newton may repair.
  double misfit_of(const SegmentList& segments) const {
    double worst = 0.0;
    for (std::size_t s = 0; s < segments.size(); ++s) {
      const Vector end = end_of(segments[s]);
      const Vector next = start_of(segments[(s + 1) % segments.size()]);
      const double event = relative_event(system_, segments[s].index.event, end, x_.par.data(), sizes_);
      const double gap = length_in_sizes(after(segments[s].index, end) - next, sizes_);
      const double misfit = (event + gap) / misfit_of_none;
      if (!(misfit <= worst)) worst = misfit;
    }
    return std::isfinite(worst) ? worst : std::numeric_limits<double>::max();
  }

  [[noreturn]] void refuse(const SegmentList& segments) const {
    std::vector<OrbitPiece> pieces;
    for (const NewSegment& segment : segments) pieces.push_back(segment.piece);
    require_fit(system_, signature_, assemble({x_, std::nullopt}, pieces).orbit);
    throw UserError(fmt::format("--signature {} does not fit the orbit", to_string(signature_)));
  }

  const HybridSystem& system_;
  const Orbit& x_;
  const Signature& signature_;
  Vector sizes_;  // of states
  SegmentList lasting_;
  std::size_t rotation_ = 0;
  Places places_;
  double best_misfit_ = std::numeric_limits<double>::infinity();
  std::optional<Places> best_places_;
  std::size_t best_rotation_ = 0;
};

}  // namespace

SegmentList matched(const HybridSystem& system, const SegmentList& old, const Orbit& x, const Signature& signature) {
  return SignatureMatch(system, old, x, signature).best();
}

namespace {

constexpr double longest_flight = 10.0;  // in periods

/// A segment, and how many impacts before it are those of a limit in which it ends.
struct LimitPart {
  std::size_t at;
  std::size_t impacts = 0;
};

std::vector<LimitPart> parts_of(const HybridSystem& system, const Signature& signature) {
  std::vector<LimitPart> parts;
  const std::size_t m = signature.size();
  for (std::size_t at = 0; at < m; ++at) {
    if (system.comes_before_limit(signature, at)) continue;
    parts.push_back({at});
    while (parts.back().impacts < m && system.comes_before_limit(signature, (at + m - parts.back().impacts - 1) % m))
      ++parts.back().impacts;
  }
  return parts;
}

/// Puts the new orbit together, part by part.
class ImpactsBeforeLimits {
 public:
  ImpactsBeforeLimits(const HybridSystem& system, const SegmentList& old, const Orbit& x, const Signature& signature)
      : system_(system), old_(old), x_(x), signature_(signature), wanted_(parts_of(system, signature)) {
    for (const NewSegment& segment : old) known_.push_back(segment.index);
    parts_ = parts_of(system, known_);
    options_.variational = false;
    options_.sizes = state_sizes(system, known_, x);
    options_.max_duration = longest_flight * x.period();
  }

  std::optional<OtherImpacts> find() {
    for (std::size_t turn = 0; parts_.size() == wanted_.size() && turn < parts_.size(); ++turn) {
      std::rotate(parts_.begin(), parts_.begin() + 1, parts_.end());
      if (agree() && differ()) return build();
    }
    return std::nullopt;
  }

 private:
  bool agree() const {
    for (std::size_t j = 0; j < parts_.size(); ++j)
      if (known_[parts_[j].at] != signature_[wanted_[j].at]) return false;
    return true;
  }
  bool differ() const {
    for (std::size_t j = 0; j < parts_.size(); ++j)
      if (parts_[j].impacts != wanted_[j].impacts) return true;
    return false;
  }

  const NewSegment& old_segment(const LimitPart& part, std::size_t before) const {
    return old_[(part.at + old_.size() - before) % old_.size()];
  }

  OtherImpacts build() {
    SegmentList list;
    std::vector<std::pair<std::size_t, std::size_t>> changed;  // new segments that end in a limit, and their parts
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      const std::size_t had = parts_[j].impacts, has = wanted_[j].impacts;
      const IndexVector& last = known_[parts_[j].at];
      if (had > 0 && has == 0)
        throw UserError(fmt::format("--signature {}: at least one impact comes before their limit, jump {} ({})",
                                    to_string(signature_), last.jump,
                                    system_.function_name(FunctionKind::jump, last.jump)));
      for (std::size_t k = 0; k <= has; ++k) {  // flights beyond those that there are begin as copies of the last one
        list.push_back(old_segment(parts_[j], had - std::min(k, had)));
        list.back().index = k < has ? impact_of(last) : last;
      }
      if (had != has) changed.emplace_back(list.size() - 1, j);
    }
    std::vector<OrbitPiece> pieces;
    for (const NewSegment& segment : list) pieces.push_back(segment.piece);
    OtherImpacts result{assemble({x_, std::nullopt}, pieces).orbit, std::move(list)};
    for (const auto& [limit, part] : changed) fly(result, limit, parts_[part], wanted_[part].impacts);
    for (std::size_t s = 0; s < result.segments.size(); ++s) result.segments[s].piece = {static_cast<int>(s), 0.0, 1.0};
    return result;
  }

  IndexVector impact_of(const IndexVector& limit) const {
    const tchat_chatter& mode = *system_.chatter_with_limit(limit.jump);
    return {mode.field, mode.event, mode.impact};
  }

  /// The flights up to this limit that are new, and the contact after it.
  void fly(OtherImpacts& result, std::size_t limit, const LimitPart& part, std::size_t has) const {
    Orbit& x = result.orbit;
    const std::size_t m = result.segments.size(), contact = (limit + 1) % m;
    double later = 0.0;  // by how much later contact begins
    for (std::size_t k = has + 1; k <= part.impacts; ++k)
      later -= x_.duration(old_segment(part, part.impacts - k).piece.segment);
    for (std::size_t k = part.impacts + 1; k <= has; ++k) {
      const std::size_t s = (limit + m - (has - k)) % m;
      const Vector start = after(x, (s + m - 1) % m, result.segments[(s + m - 1) % m].index.jump);
      const SegmentFlow flight = integrate_segment(system_, result.segments[s].index, start, x.par, options_);
      if (flight.status != FlowStatus::event_reached)
        throw UserError(fmt::format("--signature {}: so many impacts do not come before the limit: {}",
                                    to_string(signature_), flight.message));
      fill(x, static_cast<int>(s), result.segments[s].index.field, start, flight.duration);
      later += flight.duration;
    }
    const double rest = x.duration(static_cast<int>(contact)) - later;
    if (!(rest > 0.0))
      throw UserError(
          fmt::format("--signature {}: contact has ended before so many impacts have come", to_string(signature_)));
    fill(x, static_cast<int>(contact), result.segments[contact].index.field,
         after(x, limit, result.segments[limit].index.jump), rest);
  }

  Vector after(const Orbit& x, std::size_t s, int jump) const {
    Vector result(x.shape.dimension);
    system_.value(FunctionKind::jump, jump, x.end(static_cast<int>(s)), x.par.data(), result.data());
    if (result.allFinite()) return result;
    throw UserError(fmt::format("--signature {}: jump {} ({}) has no value after so many impacts",
                                to_string(signature_), jump, system_.function_name(FunctionKind::jump, jump)));
  }

  void fill(Orbit& x, int s, int field, Vector state, double duration) const {
    x.duration(s) = duration;
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      const double step = k == 0 ? 0.0 : (x.tau(s, k) - x.tau(s, k - 1)) * duration;
      if (k > 0) state = integrate_for(system_, field, state, x.par, step, options_).end_state;
      Eigen::Map<Vector>(x.node(s, k), state.size()) = state;
    }
  }

  const HybridSystem& system_;
  const SegmentList& old_;
  const Orbit& x_;
  const Signature& signature_;
  Signature known_;
  std::vector<LimitPart> parts_, wanted_;  // of the orbit, in the order of those of the signature
  FlowOptions options_;
};

}  // namespace

std::optional<OtherImpacts> with_other_impacts(const HybridSystem& system, const SegmentList& old, const Orbit& x,
                                               const Signature& signature) {
  return ImpactsBeforeLimits(system, old, x, signature).find();
}

}  // namespace tchat
