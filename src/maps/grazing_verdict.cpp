#include "maps/grazing_verdict.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>

#include "linear/dense_matrix.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = GrazingVerdict::Kind;

constexpr double stable = 1e-5;       // as for labels: |mu| <= 1 + 1e-5
constexpr double xi_rounding = 1e-9;  // of shares in xi_n, of determinants
std::string number(double value) { return fmt::format("{:.6g}", value); }

std::string text(std::complex<double> value) {
  if (value.imag() == 0.0) return number(value.real());
  return fmt::format("{} {} {} i", number(value.real()), value.imag() < 0.0 ? '-' : '+',
                     number(std::abs(value.imag())));
}

double determinant(const MatrixXd& matrix) {
  const PivotedLu lu(matrix);
  return lu.pivots().prod() * lu.parity();
}

double largest_modulus(const MatrixXd& matrix) { return eigenvalues(matrix).cwiseAbs().maxCoeff(); }

GrazingVerdict unstable(std::complex<double> largest) {
  return {Kind::unstable, 0,
          fmt::format("the orbit is unstable without contact: A has the eigenvalue {}, of modulus {}", text(largest),
                      number(std::abs(largest)))};
}

/// (3.11-3.12): fixed points of both linear maps, and which side of contact they lie on.
GrazingVerdict by_linear_map(const GrazingOrbit& orbit, const DiscontinuityMap& map) {
  const Eigen::Index n = orbit.A.rows();
  const MatrixXd unit = MatrixXd::Identity(n, n);
  const MatrixXd with_contact = orbit.A * linear_contact(map);
  GrazingVerdict verdict;
  verdict.is_linear = true;
  verdict.linear = determinant(unit - with_contact) * determinant(unit - orbit.A);
  const double largest = largest_modulus(with_contact);
  const std::string product = fmt::format("det(Id - A L) det(Id - A) = {:.10g}", verdict.linear);
  if (std::abs(verdict.linear) <= xi_rounding) {
    verdict.reason = fmt::format("there is no square root, and {} is zero to rounding (3.11)", product);
  } else if (verdict.linear < 0.0) {
    verdict.kind = Kind::discontinuous;
    verdict.reason = fmt::format(
        "there is no square root, and {} < 0 (3.11): the impacting orbit and the one without contact live on the same "
        "side of grazing, and vanish together",
        product);
  } else if (largest > 1.0 + stable) {
    verdict.reason = fmt::format(
        "there is no square root and {} > 0 (3.12), but the impacting orbit is born unstable: A L has an eigenvalue of "
        "modulus {}",
        product, number(largest));
  } else {
    verdict.kind = Kind::continuous;
    verdict.reason = fmt::format(
        "there is no square root, and {} > 0 (3.12): beyond grazing a stable impacting orbit, with eigenvalues of "
        "modulus up to {}, takes the place of the one without contact",
        product, number(largest));
  }
  return verdict;
}

/// The part of each eigenvalue of A in xi_n = sum of share_k lambda_k^n.
struct Share {
  std::complex<double> eigenvalue, share;
};

std::vector<Share> shares(const GrazingOrbit& orbit) {
  const GrazingPoint& at = orbit.point;
  const Eigen::VectorXcd& values = orbit.multipliers;
  std::vector<Share> result;
  for (const std::complex<double> value : values) {
    if (std::abs(value) <= xi_rounding * std::abs(values(0))) continue;  // zeros, which may be defective: no share
    // By right and left eigenvectors: simple eigenvalues only.
    const Eigen::VectorXcd right = eigenvector(orbit.A, value);
    const Eigen::VectorXcd left = eigenvector(orbit.A.transpose(), value);
    const std::complex<double> size = left.transpose() * right;
    const std::complex<double> seen = at.event_gradient.cast<std::complex<double>>().transpose() * right;
    const std::complex<double> excited = left.transpose() * at.impact.beta.cast<std::complex<double>>();
    result.push_back({value, -seen * excited / size});
  }
  return result;
}

std::string undecided(const std::vector<Share>& parts, int n) {
  const Share& first = parts.front();
  const double size = std::abs(first.eigenvalue);
  if (first.eigenvalue.imag() != 0.0)
    return fmt::format("the dominant eigenvalue {} of A is complex, so that some xi_n with n > {} is negative",
                       text(first.eigenvalue), n);
  if (first.eigenvalue.real() < 0.0)
    return fmt::format("the dominant eigenvalue {} of A is negative, so that xi_n changes its sign at some n > {}",
                       text(first.eigenvalue), n);
  const double share = first.share.real();
  double others = 0.0;
  for (std::size_t k = 1; k < parts.size(); ++k)
    others += std::abs(parts[k].share) * std::pow(std::abs(parts[k].eigenvalue) / size, n);
  if (!std::isfinite(share) || !std::isfinite(others)) return "A has eigenvalues that are not simple";
  if (share < 0.0)
    return fmt::format("the dominant eigenvalue {} of A has a negative share in xi_n, which is negative at some n > {}",
                       text(first.eigenvalue), n);
  if (share <= others)
    return fmt::format("the dominant eigenvalue {} of A does not outweigh the others yet at n = {}",
                       text(first.eigenvalue), n);
  return "";
}

GrazingVerdict by_returns(const GrazingOrbit& orbit, const std::vector<ImpactReturn>& xi) {
  const int count = static_cast<int>(xi.size());
  for (int n = 1; n <= count; ++n) {
    const ImpactReturn& at = xi[static_cast<std::size_t>(n - 1)];
    if (at.is_zero())
      return {Kind::unknown, n,
              fmt::format("xi_{} = {:.2g} is zero to rounding (codimension two), and no earlier one is negative", n,
                          at.xi)};
    if (at.xi < 0.0)
      return {Kind::discontinuous, n,
              fmt::format("xi_{} = {:.10g} < 0{}: after an impact of low velocity the next one comes {} later, and its "
                          "stretching by the square root repeats before the orbit can recover",
                          n, at.xi, n == 1 ? "" : ", the first negative one",
                          n == 1 ? "one period" : fmt::format("{} periods", n))};
  }
  const std::vector<Share> parts = shares(orbit);
  const std::string doubt = undecided(parts, count);
  if (!doubt.empty())
    return {Kind::unknown, 0,
            fmt::format("xi_1 ... xi_{} are positive, but {}; more of them: --xi {}", count, doubt, 4 * count)};
  return {Kind::continuous, 0,
          fmt::format("xi_1 ... xi_{} are positive, and so are all others: the dominant eigenvalue {} of A is real and "
                      "positive, with the share {} in xi_n; no new impact follows one of low velocity before the orbit "
                      "has recovered",
                      count, text(parts.front().eigenvalue), number(parts.front().share.real()))};
}

}  // namespace

std::string GrazingVerdict::words() const {
  switch (kind) {
    case Kind::continuous:
      return "continuous";
    case Kind::discontinuous:
      return n > 0 ? fmt::format("discontinuous, n = {}", n) : "discontinuous";
    case Kind::unstable:
      return "none";
    default:
      return "cannot tell";
  }
}

MatrixXd linear_contact(const DiscontinuityMap& map) {
  return map.expansion().dx - map.expansion().yy * map.point().event_gradient.transpose();
}

GrazingVerdict grazing_verdict(const GrazingOrbit& orbit, const DiscontinuityMap& map,
                               const std::vector<ImpactReturn>& xi) {
  const std::complex<double> largest = orbit.multipliers(0);
  if (std::abs(largest) > 1.0 + stable) return unstable(largest);
  if (std::abs(largest) >= 1.0 - stable)
    return {Kind::unknown, 0,
            fmt::format("the orbit bifurcates without contact as well: A has the eigenvalue {}, of modulus 1",
                        text(largest))};
  return orbit.point.has_square_root() ? by_returns(orbit, xi) : by_linear_map(orbit, map);
}

}  // namespace tchat
