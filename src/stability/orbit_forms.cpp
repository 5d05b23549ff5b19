#include "stability/orbit_forms.hpp"

#include "orbit/mesh_adaptation.hpp"

namespace tchat {

using Complex = std::complex<double>;
using Vector = Eigen::VectorXd;
using ComplexVector = Eigen::VectorXcd;

Vector OrbitForms::second(const Vector& u, const Vector& v) const {
  NodalParts parts{};
  parts[1] = &u, parts[2] = &v;
  return expansion_.part(x_, parts, 3);
}

ComplexVector OrbitForms::second(const ComplexVector& u, const ComplexVector& v) const {
  return bilinear([this](const Vector& a, const Vector& b) { return second(a, b); }, u, v);
}

Vector OrbitForms::third(const Vector& u, const Vector& v, const Vector& w) const {
  NodalParts parts{};
  parts[1] = &u, parts[2] = &v, parts[4] = &w;
  return expansion_.part(x_, parts, 7);
}

ComplexVector OrbitForms::third(const ComplexVector& q) const {
  return trilinear([this](const Vector& a, const Vector& b, const Vector& c) { return third(a, b, c); }, q);
}

/// With q = a + i b it is (a a a - 3 a b b) + i (3 a a b - b b b).
ComplexVector OrbitForms::cube(const ComplexVector& q) const {
  const Vector a = q.real(), b = q.imag();
  ComplexVector result(q.size());
  result.real() = third(a, a, a) - 3.0 * third(a, b, b);
  result.imag() = 3.0 * third(a, a, b) - third(b, b, b);
  return result;
}

bool is_fold(Complex critical) { return critical == Complex(1.0, 0.0); }
double shift_for(Complex critical) { return is_fold(critical) ? -1.0 : 1.0; }

Orbit on_every_second_point(const Orbit& x) {
  Orbit coarse = x;
  coarse.mesh.clear();
  for (int j = 0; j < x.shape.intervals; j += 2) coarse.mesh.push_back(x.mesh[static_cast<std::size_t>(j)]);
  coarse.mesh.push_back(1.0);
  coarse.shape.intervals = static_cast<int>(coarse.mesh.size()) - 1;
  coarse.states = interpolate_states(x.states, x.shape, x.mesh, coarse.shape, coarse.mesh);
  return coarse;
}

}  // namespace tchat
