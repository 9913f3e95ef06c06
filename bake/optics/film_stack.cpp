#include "bake/optics/film_stack.h"

#include <algorithm>
#include <cmath>

#include "sunbeam/core/vec.h"

namespace sunbeam {
namespace {

using Complex = std::complex<double>;
constexpr Complex kI{0, 1};

// The squared cosine in a medium of light that comes from `ior_from` at `cos_from`. The formula is arranged
// so that equal media keep every digit at grazing.
Complex cosine_squared(double ior_from, Complex index, double cos_from) {
  return ((index - ior_from) * (index + ior_from) + square(ior_from * cos_from)) / (index * index);
}

// The root for which a wave that goes down decays.
Complex downward_cosine(Complex index, Complex c_squared) {
  const Complex c = std::sqrt(c_squared);
  return (index * c).imag() < 0 ? -c : c;
}

// cos(delta) and sin(delta) / c, both times exp(i delta), so that thick layers do not overflow.
struct LayerPhase {
  Complex cosine, sine_over_c;
  double damping;  // Im(delta)
};

LayerPhase layer_phase(const FilmLayer& layer, Complex c_squared, double wavelength_nm) {
  const Complex c = downward_cosine(layer.index, c_squared);
  const Complex k = 2 * kPi * layer.thickness_nm / wavelength_nm * layer.index, delta = k * c;
  const Complex factor = std::exp(kI * delta);
  if (std::abs(delta) < 1e-3) {
    const Complex x = delta * delta;
    return {std::cos(delta) * factor, k * (1.0 - x / 6.0 * (1.0 - x / 20.0)) * factor, delta.imag()};
  }
  const Complex twice = factor * factor;
  return {0.5 * (1.0 + twice), (twice - 1.0) / (2.0 * kI * c), delta.imag()};
}

// The fields of both polarisations at one height. Those of p are (H, E), as their admittance is c / N.
struct Fields {
  Complex s_e, s_h, p_h, p_e;

  // Goes up through a layer.
  void pass(const LayerPhase& phase, Complex index, Complex c_squared) {
    const Complex sine = -kI * phase.sine_over_c;
    const Complex e = s_e, h = p_h;
    s_e = phase.cosine * e + sine / index * s_h;
    s_h = phase.cosine * s_h + sine * index * c_squared * e;
    p_h = phase.cosine * h + sine * index * p_e;
    p_e = phase.cosine * p_e + sine / index * c_squared * h;
  }
};

StackPower polarised(Complex field, Complex conjugate, double q0, double q2, double damping) {
  const Complex incident = q0 * field + conjugate;
  return {std::norm((q0 * field - conjugate) / incident),
          4 * q0 * q2 * std::exp(-2 * damping) / std::norm(incident)};
}

}  // namespace

StackPower stack_power(const FilmStack& stack, double cos_exterior, double wavelength_nm) {
  if (cos_exterior <= 0) return {1, 0};
  const double n0 = stack.exterior_ior;
  const Complex n2 = stack.base_index;
  const Complex c2 = downward_cosine(n2, cosine_squared(n0, n2, cos_exterior));
  Fields fields{1, n2 * c2, 1, c2 / n2};
  double damping = 0;
  for (auto layer = stack.layers.rbegin(); layer != stack.layers.rend(); ++layer) {
    const Complex c_squared = cosine_squared(n0, layer->index, cos_exterior);
    const LayerPhase phase = layer_phase(*layer, c_squared, wavelength_nm);
    fields.pass(phase, layer->index, c_squared);
    damping += phase.damping;
  }
  const StackPower s = polarised(fields.s_e, fields.s_h, n0 * cos_exterior, (n2 * c2).real(), damping);
  const StackPower p = polarised(fields.p_h, fields.p_e, cos_exterior / n0, (c2 / n2).real(), damping);
  return {(s.reflectance + p.reflectance) / 2, (s.transmittance + p.transmittance) / 2};
}

std::optional<double> reflectance_below(const FilmStack& stack, double cos_exterior, double wavelength_nm) {
  if (stack.base_index.imag() > 0) return {};
  const double c2_squared = cosine_squared(stack.exterior_ior, stack.base_index, cos_exterior).real();
  if (c2_squared <= 0) return {};
  FilmStack reversed{
      stack.base_index.real(), {stack.layers.rbegin(), stack.layers.rend()}, stack.exterior_ior};
  return stack_power(reversed, std::sqrt(c2_squared), wavelength_nm).reflectance;
}

}  // namespace sunbeam
