#include "maps/map_sampler.hpp"

#include <algorithm>
#include <cmath>

#include "base/user_error.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index compared_sections = 32;  // of a motion that does not repeat itself, by which it is known

/// The period begins where its sequence of index vectors is least; among equal ones where the state is.
Index least_rotation(const Signature& signature, const Eigen::MatrixXd& points) {
  const std::size_t m = signature.size();
  const auto is_less = [&](std::size_t a, std::size_t b) {
    for (std::size_t s = 0; s < m; ++s) {
      const IndexVector& u = signature[(a + s) % m];
      const IndexVector& v = signature[(b + s) % m];
      if (u != v) return u < v;
    }
    const VectorXd x = points.col(static_cast<Index>(a)), y = points.col(static_cast<Index>(b));
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  };
  std::size_t least = 0;
  for (std::size_t s = 1; s < m; ++s)
    if (is_less(s, least)) least = s;
  return static_cast<Index>(least);
}

template <class Vector>
void rotate_columns(Vector& v, Index first) {
  const Vector old = v;
  for (Index k = 0; k < v.cols(); ++k) v.col(k) = old.col((k + first) % v.cols());
}

void describe_period(const MapModel& model, const MapAttractor& attractor, AttractorSample& sample) {
  for (const bool touches : attractor.contacts) {
    sample.signature.push_back(touches ? model.contact : model.free);
    if (touches) ++sample.impacts;
  }
  const Index first = least_rotation(sample.signature, sample.sections);
  std::rotate(sample.signature.begin(), sample.signature.begin() + first, sample.signature.end());
  rotate_columns(sample.sections, first);
  Eigen::RowVectorXd penetrations = sample.section_penetrations.transpose();
  rotate_columns(penetrations, first);
  sample.section_penetrations = penetrations.transpose();
  sample.period = attractor.time;
  sample.last.x = sample.sections.col(0);
}

}  // namespace

AttractorSample MapSampler::operator()(const SweepPoint& point, const std::function<bool()>& interrupted) const {
  ParameterVector par = model_.par;
  VectorXd x = point.at ? point.at->x : setup_.starts[static_cast<std::size_t>(point.start - 1)];
  set_swept_values(setup_.over, point.values, x, par);
  MapIteration iteration = setup_.iteration;
  iteration.interrupted = interrupted;
  MapAttractor attractor;
  try {
    attractor = iterate_to_attractor(*map_, x, par, iteration);
  } catch (const ComputationError&) {
    if (interrupted && interrupted()) throw SampleInterrupted();
    throw;
  }
  AttractorSample sample;
  sample.kind = attractor.kind;
  sample.message = attractor.message;
  if (attractor.period > 0) sample.impacts = 0;
  sample.range = map_->smooth().extent();
  sample.sections = attractor.points;
  sample.section_penetrations = attractor.penetrations;
  if (attractor.kind != AttractorKind::escape) sample.last.x = attractor.last;
  if (attractor.period > 0) describe_period(model_, attractor, sample);
  for (const double penetration : attractor.penetrations)
    if (std::isfinite(penetration)) sample.penetration = std::fmax(sample.penetration, penetration);
  sample.identity = attractor.period > 0
                        ? sample.sections
                        : sample.sections.leftCols(std::min(compared_sections, sample.sections.cols()));
  if (attractor.spectrum && setup_.iteration.exponents > 0) {
    const Index count = std::min<Index>(setup_.iteration.exponents, attractor.spectrum->exponents.size());
    sample.exponents = attractor.spectrum->exponents.head(count);
    sample.errors = attractor.spectrum->errors.head(count);
  }
  return sample;
}

}  // namespace tchat
