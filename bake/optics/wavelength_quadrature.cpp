#include "bake/optics/wavelength_quadrature.h"

#include <string>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

// Fringes of orders 2 to 4 are much weaker than the first: each order counts this much less than the one
// before in the squared error. They keep the fit from running wild beyond the longest path.
constexpr int kOrders = 4;
constexpr double kOrderRatio = 0.003;

// Keeps the normal equations regular, relative to their diagonal.
constexpr double kDamping = 1e-12;

// Makes the weights of each channel sum to 1.
void normalize(std::vector<Rgb>& weight) {
  Rgb sum;
  for (const Rgb& w : weight) sum += w;
  for (Rgb& w : weight) w = w / sum;
}

// Mean of cos(2 pi x t) over x from 0 to m `largest`, added up over the orders m with their weights.
double mean_cosine(double largest, double t) {
  double sum = 0, weight = 1;
  for (int m = 1; m <= kOrders; ++m, weight *= kOrderRatio) {
    const double a = 2 * kPi * m * largest * t;
    sum += weight * (std::abs(a) < 1e-8 ? 1 : std::sin(a) / a);
  }
  return sum;
}

// Wave numbers 1 / lambda of the nodes, 1/nm.
std::vector<double> node_wave_numbers(int nodes, const NodeRange& range) {
  std::vector<double> wave_number(nodes);
  for (int k = 0; k < nodes; ++k)
    wave_number[k] = lerp(static_cast<double>(k) / (nodes - 1), 1 / range.last_nm, 1 / range.first_nm);
  return wave_number;
}

// Weights of one channel. Normal equations of the least squares with a Lagrange multiplier for the constant;
// sums over x of products of waves are mean cosines of differences of wave numbers.
std::vector<double> fit_channel(const WavelengthQuadrature& reference, int channel,
                                const std::vector<double>& wave_number, double largest_path_nm) {
  const std::size_t n = wave_number.size(), rows = n + 1;
  std::vector<double> matrix(rows * rows, 0.0), rhs(rows, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      matrix[i * rows + j] = mean_cosine(largest_path_nm, wave_number[i] - wave_number[j]);
    matrix[i * rows + i] += kDamping;
    matrix[i * rows + n] = matrix[n * rows + i] = 1;
    for (std::size_t k = 0; k < reference.size(); ++k)
      rhs[i] += reference.weight[k][channel] *
                mean_cosine(largest_path_nm, wave_number[i] - 1 / reference.wavelength_nm[k]);
  }
  rhs[n] = 1;
  if (!solve_linear(std::move(matrix), rhs)) throw Error("spectrum: the fit of the wavelengths is singular");
  rhs.pop_back();
  return rhs;
}

}  // namespace

FilmPower WavelengthQuadrature::fold_film(const ThinFilm& film, double cos_exterior) const {
  FilmPower sum;
  for (std::size_t k = 0; k < size(); k += 3) {
    const std::size_t last = size() - 1, k1 = std::min(k + 1, last), k2 = std::min(k + 2, last);
    const FilmPower power =
        airy(film, cos_exterior, {wavelength_nm[k], wavelength_nm[k1], wavelength_nm[k2]});
    for (std::size_t i = k; i < std::min(k + 3, size()); ++i) {
      sum.reflectance += power.reflectance[static_cast<int>(i - k)] * weight[i];
      sum.transmittance += power.transmittance[static_cast<int>(i - k)] * weight[i];
    }
  }
  return sum;
}

WavelengthQuadrature brute_force(Illuminant illuminant, ColorSpace space) {
  const ColorMatrix to_rgb = xyz_to_rgb(illuminant_white(illuminant), space);
  WavelengthQuadrature q;
  for (double nm = kShortestVisibleNm; nm <= kLongestVisibleNm; ++nm) {
    const Vec3 rgb = to_rgb * (illuminant_power(illuminant, nm) * observer(nm));
    q.wavelength_nm.push_back(nm);
    q.weight.push_back({rgb.x, rgb.y, rgb.z});
  }
  normalize(q.weight);
  return q;
}

int nodes_for_path(double largest_path_nm) {
  const double nodes = kDefaultNodes * largest_path_nm / kDefaultLargestPathNm;
  return std::max(16, 4 * static_cast<int>(std::ceil(nodes / 4)));
}

WavelengthQuadrature fitted(Illuminant illuminant, ColorSpace space, int nodes, double largest_path_nm,
                            const NodeRange& range) {
  if (nodes < 2 || nodes > 256)
    throw Error("spectrum: " + std::to_string(nodes) + " wavelengths; allowed are 2 to 256");
  if (!(largest_path_nm > 0 && largest_path_nm <= 1e6))
    throw Error("spectrum: largest path " + std::to_string(largest_path_nm) + " nm; allowed are 0 to 1e6");
  const WavelengthQuadrature reference = brute_force(illuminant, space);
  const std::vector<double> wave_number = node_wave_numbers(nodes, range);
  WavelengthQuadrature q;
  for (const double wave : wave_number) q.wavelength_nm.push_back(1 / wave);
  q.weight.resize(nodes);
  for (int channel = 0; channel < 3; ++channel) {
    const std::vector<double> weight = fit_channel(reference, channel, wave_number, largest_path_nm);
    for (int k = 0; k < nodes; ++k) q.weight[k][channel] = weight[k];
  }
  normalize(q.weight);
  return q;
}

bool solve_linear(std::vector<double> matrix, std::vector<double>& rhs) {
  const std::size_t n = rhs.size();
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return matrix[i * n + j]; };
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t i = column + 1; i < n; ++i)
      if (std::abs(at(i, column)) > std::abs(at(pivot, column))) pivot = i;
    if (!(std::abs(at(pivot, column)) > 0)) return false;
    for (std::size_t j = column; j < n; ++j) std::swap(at(pivot, j), at(column, j));
    std::swap(rhs[pivot], rhs[column]);
    for (std::size_t i = column + 1; i < n; ++i) {
      const double factor = at(i, column) / at(column, column);
      for (std::size_t j = column; j < n; ++j) at(i, j) -= factor * at(column, j);
      rhs[i] -= factor * rhs[column];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) rhs[i] -= at(i, j) * rhs[j];
    rhs[i] /= at(i, i);
  }
  return true;
}

}  // namespace sunbeam
