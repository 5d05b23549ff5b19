// What is told of the contact at the labels of a grazing curve, a* and xi_n on the screen, x*, beta and A in the
// d-file: of the linear oscillator, against their closed forms.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cctype>
#include <cmath>
#include <complex>
#include <optional>
#include <sstream>

#include "published/chain.hpp"

using namespace test_support;

namespace {

using Vector = Eigen::Vector4d;

struct ContactBlock {
  int label = 0;
  std::string type;
  std::map<std::string, double> values;  // a*, xi_n
  Vector contact = Vector::Zero(), beta = Vector::Zero();
  Eigen::Matrix4d map = Eigen::Matrix4d::Zero();
  int rows = 0;  // of map
};

Vector read_vector(std::istringstream& words) {
  Vector v;
  for (double& entry : v) words >> entry;
  REQUIRE(words);
  return v;
}

/// BR, PT, TY (at some), LAB and five columns.
std::optional<ContactBlock> point_line(const std::string& line) {
  std::istringstream text(line);
  std::vector<std::string> words;
  for (std::string word; text >> word;) words.push_back(word);
  if (words.size() < 8 || (words[0] != "1" && words[0] != "2")) return std::nullopt;
  const bool typed = std::isalpha(static_cast<unsigned char>(words[2].front()));
  const std::string& label = words[typed ? 3 : 2];
  if (label.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  ContactBlock block;
  block.label = std::stoi(label);
  if (typed) block.type = words[2];
  return block;
}

/// The blocks on the screen or in the d-file, each beneath the line of its label.
std::vector<ContactBlock> read_blocks(const std::string& told) {
  std::vector<ContactBlock> blocks;
  std::istringstream lines(told);
  for (std::string line; std::getline(lines, line);) {
    if (const auto point = point_line(line)) {
      blocks.push_back(*point);
      continue;
    }
    if (blocks.empty()) continue;
    ContactBlock& block = blocks.back();
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first == "a*" || first.starts_with("xi_")) {
      std::istringstream parts(line);
      for (std::string part; std::getline(parts, part, ',');) {
        std::istringstream equation(part);
        std::string name, equals;
        double value = 0.0;
        if (equation >> name >> equals >> value) block.values[name] = value;
      }
    }
    if (first == "x*") block.contact = read_vector(words);
    if (first == "beta") block.beta = read_vector(words);
    if (first == "A" && block.rows < 4) block.map.row(block.rows++) = read_vector(words).transpose();
  }
  return blocks;
}

/// (1 + r) omega^2 exp(-zeta n T) sin(n omega_d T) / omega_d
double xi(int n, double omega) {
  const double damped = std::sqrt(1.0 - zeta * zeta);
  const double time = n * 2.0 * M_PI / omega;
  return (1.0 + restitution) * omega * omega * std::exp(-zeta * time) * std::sin(damped * time) / damped;
}

/// Free motion over one period: (q, q') of q'' + 2 zeta q' + q = 0.
Eigen::Matrix2d free_motion(double omega) {
  const double damped = std::sqrt(1.0 - zeta * zeta);
  const double time = 2.0 * M_PI / omega;
  const double c = std::cos(damped * time), s = std::sin(damped * time);
  Eigen::Matrix2d e;
  e << c + zeta / damped * s, s / damped, -s / damped, c - zeta / damped * s;
  return std::exp(-zeta * time) * e;
}

/// The grazing orbit x1 = cos(omega t) at its contact, with the forcing's phase there.
struct Contact {
  explicit Contact(double at) : omega(at), stiffness(1.0 - at * at, 2.0 * zeta * at), phase(std::arg(stiffness)) {
    x << 1.0, 0.0, std::sin(phase), std::cos(phase);
    f << 0.0, -omega * omega, omega * x(3), -omega * x(2);
  }
  /// Onto h_P = -x2 = 0 along the flow; h_P,x f = omega^2.
  Vector projected(const Vector& v) const { return v + f * (v(1) / (omega * omega)); }
  /// A times (a, b, 0, 0): free motion.
  Vector of_motion(const Eigen::Vector2d& start) const {
    Vector v = Vector::Zero();
    v.head(2) = free_motion(omega) * start;
    return projected(v);
  }
  /// A times (0, 0, y1, y2): the amplitude of the forcing comes back as exp(-2 t), with s = i omega - 2 the motion is
  /// q = Re(alpha e^{i phase} e^{s t} / (s^2 + 2 zeta s + 1)) and what keeps q, q' at 0 in the beginning.
  Vector of_amplitude() const {
    const std::complex<double> s(-2.0, omega);
    const std::complex<double> forced = std::abs(stiffness) * std::polar(1.0, phase) / (s * s + 2.0 * zeta * s + 1.0);
    const Eigen::Vector2d start(forced.real(), (s * forced).real());
    const double decay = std::exp(-4.0 * M_PI / omega);
    Vector v;
    v << decay * start - free_motion(omega) * start, decay * x(2), decay * x(3);
    return projected(v);
  }

  double omega;
  std::complex<double> stiffness;
  double phase;
  Vector x, f;
};

}  // namespace

TEST_CASE("grazing curve: a* and xi_n on the screen, x*, beta and A in the d-file") {
  const Workspace workspace;
  workspace.run("-c to_grazing -d nonimpacting -o grazing");
  const Outcome outcome = workspace.run("-c grazing_curve -s grazing -o curve --both NPR=7");
  const std::vector<SolutionEntry> solutions = workspace.solutions("curve");
  int shown = 0;
  for (const ContactBlock& block : read_blocks(outcome.out)) {
    if (block.values.empty()) continue;
    INFO(block.type << " " << block.label);
    ++shown;
    const double omega = with_label(solutions, block.label).parameter(2);
    CHECK(block.values.at("a*") == Approx(omega * omega).epsilon(1e-7));
    for (int n = 1; n <= 5; ++n) CHECK(block.values.at("xi_" + std::to_string(n)) == Approx(xi(n, omega)).margin(3e-7));
  }
  CHECK(shown >= 8);
  std::size_t recorded = 0;
  for (const ContactBlock& block : read_blocks(workspace.read("d.curve"))) {
    if (block.label == 0) continue;  // no label, no block
    INFO(block.type << " " << block.label);
    const double omega = with_label(solutions, block.label).parameter(2);
    const Contact exact(omega);
    REQUIRE(block.rows == 4);
    ++recorded;
    CHECK((block.contact - exact.x).norm() < 1e-8);
    // g_x f turns x2' and keeps the rest; beta has no part off h_P = 0.
    const Vector beta = (1.0 + restitution) * Vector(0.0, 0.0, exact.f(2), exact.f(3));
    CHECK((block.beta - beta).norm() < 1e-8);
    const double size = block.map.norm();
    CHECK((block.map.col(0) - exact.of_motion({1.0, 0.0})).norm() < 1e-7 * size);
    CHECK((block.map.col(1) - exact.of_motion({0.0, 1.0})).norm() < 1e-7 * size);
    CHECK((block.map * exact.f).norm() < 1e-7 * size * exact.f.norm());
    const Vector amplitude(0.0, 0.0, exact.x(2), exact.x(3));
    CHECK((block.map * amplitude - exact.of_amplitude()).norm() < 1e-7 * size);
  }
  CHECK(recorded == solutions.size());
}
