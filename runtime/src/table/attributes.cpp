#include "runtime/src/table/attributes.h"

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/nd_array.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

// Calls visit(word) for what single spaces separate.
template <class Visit>
void for_each_word(std::string_view text, Visit visit) {
  for (;;) {
    const auto end = text.find(' ');
    visit(text.substr(0, end));
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

constexpr std::array<const char*, 3> kWeightNames = {"spectral.weight_r", "spectral.weight_g",
                                                     "spectral.weight_b"};

// A bake's weights add up to 1, so that white is white.
void require_weights(const std::string& key, const std::vector<double>& weights) {
  constexpr Interval kSum{0.5, 2};
  require_in(key, weights, {-2, 2});
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum >= kSum.low && sum <= kSum.high))
    throw Error("attribute '" + key + "' adds up to " + to_text(sum) + "; allowed: " + to_text(kSum.low) +
                " to " + to_text(kSum.high));
}

constexpr std::string_view kFilmPrefix = "film.", kBasePrefix = "base.";

std::string layer_prefix(std::size_t layer) { return std::string(kFilmPrefix) + std::to_string(layer) + "."; }

void describe_indices(const std::string& prefix, const std::vector<std::complex<double>>& indices,
                      Attributes& attributes) {
  std::vector<double> n, k;
  for (const std::complex<double>& index : indices) {
    n.push_back(index.real());
    k.push_back(index.imag());
  }
  attributes[prefix + "n"] = to_text(n);
  attributes[prefix + "k"] = to_text(k);
}

// One number a wavelength.
std::vector<std::complex<double>> parse_indices(const Attributes& attributes, const std::string& prefix,
                                                std::size_t count) {
  const auto numbers = [&](const char* name) {
    const std::string key = prefix + name;
    std::vector<double> values = parse_numbers(attributes, key);
    if (values.size() != count)
      throw Error("attribute '" + key + "' holds " + std::to_string(values.size()) +
                  " numbers; expected one a wavelength, " + std::to_string(count));
    return values;
  };
  const std::vector<double> n = numbers("n"), k = numbers("k");
  std::vector<std::complex<double>> indices;
  for (std::size_t i = 0; i < count; ++i) indices.emplace_back(n[i], k[i]);
  return indices;
}

int parse_periods(const Attributes& attributes) {
  const std::string key = std::string(kFilmPrefix) + "periods", &text = require(attributes, key);
  std::uint64_t periods = 0;
  if (!parse_whole_number(text, periods) || periods < 1 || periods > kMostFilmLayers)
    throw Error("attribute '" + key + "' is '" + shortened(text) + "'; allowed: 1 to " +
                std::to_string(kMostFilmLayers));
  return static_cast<int>(periods);
}

void parse_layer(const Attributes& attributes, std::size_t layer, Wavelengths& w) {
  const std::string prefix = layer_prefix(layer), key = prefix + "thickness_nm";
  const std::vector<double> thickness = parse_numbers(attributes, key);
  if (thickness.size() != 1) throw Error("attribute '" + key + "' is a list; allowed: one number");
  const auto indices = parse_indices(attributes, prefix, w.size());
  for (std::size_t k = 0; k < w.size(); ++k) w.layers[k].push_back({thickness.front(), indices[k]});
}

// Files state a thickness once.
void require_even_layers(const std::vector<std::vector<FilmLayer>>& layers) {
  const auto has_same_thickness = [](const FilmLayer& a, const FilmLayer& b) {
    return a.thickness_nm == b.thickness_nm;
  };
  for (const std::vector<FilmLayer>& others : layers)
    if (!std::ranges::equal(layers.front(), others, has_same_thickness))
      throw Error("layers of a film are not as thick at every wavelength");
}

}  // namespace

const std::string& require(const Attributes& attributes, std::string_view key) {
  const auto at = attributes.find(std::string(key));
  if (at == attributes.end()) throw Error("attribute '" + std::string(key) + "' is missing");
  return at->second;
}

std::vector<double> parse_numbers(const Attributes& attributes, const std::string& key) {
  std::vector<double> numbers;
  for_each_word(require(attributes, key), [&](std::string_view text) {
    double value = 0;
    if (!parse_number(text, value) || !std::isfinite(value))
      throw Error("attribute '" + key + "' holds '" + shortened(text) + "', which is no finite number");
    numbers.push_back(value);
  });
  return numbers;
}

void require_in(const std::string& key, const std::vector<double>& values, const Interval& allowed) {
  for (const double value : values)
    if (!(value >= allowed.low && value <= allowed.high))
      throw Error("attribute '" + key + "' holds " + to_text(value) + "; allowed: " + to_text(allowed.low) +
                  " to " + to_text(allowed.high));
}

Attributes describe_axes(const std::vector<Axis>& axes) {
  Attributes result;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const std::string prefix = "axis." + std::to_string(k) + ".";
    result[prefix + "name"] = axes[k].name;
    result[prefix + "unit"] = axes[k].unit;
    result[prefix + "power"] = to_text(axes[k].power);
    result[prefix + "period"] = to_text(axes[k].period);
    result[prefix + "origin"] = to_text(axes[k].origin);
    if (axes[k].softness > 0) result[prefix + "softness"] = to_text(axes[k].softness);
    result[prefix + "interpolation"] = axes[k].is_cubic ? "cubic" : "linear";
    result[prefix + "nodes"] = to_text(axes[k].nodes);
  }
  return result;
}

std::vector<Axis> parse_axes(const Attributes& attributes, const std::string& array_name) {
  std::vector<Axis> axes;
  for (std::size_t k = 0; k < NdArray::kMaxRank; ++k) {
    const std::string prefix = "axis." + std::to_string(k) + ".";
    if (!attributes.count(prefix + "name")) break;
    Axis axis;
    axis.name = require(attributes, prefix + "name");
    axis.unit = require(attributes, prefix + "unit");
    constexpr std::size_t kLongest = 100;
    for (const std::string* text : {&axis.name, &axis.unit})
      if (!is_plain_text(*text) || text->size() > kLongest)
        throw Error("array '" + array_name + "': axis '" + shortened(axis.name) +
                    "' has a name or unit that is not UTF-8, holds a control character or is longer than " +
                    std::to_string(kLongest) + " bytes");
    const auto number = [&](std::string_view text) {
      double value = 0;
      if (!parse_number(text, value))
        throw Error("array '" + array_name + "': axis '" + axis.name + "' holds '" + shortened(text) +
                    "', which is no number");
      return value;
    };
    axis.power = number(require(attributes, prefix + "power"));
    axis.period = number(require(attributes, prefix + "period"));
    axis.origin = number(require(attributes, prefix + "origin"));
    if (attributes.count(prefix + "softness")) axis.softness = number(attributes.at(prefix + "softness"));
    const std::string& interpolation = require(attributes, prefix + "interpolation");
    if (interpolation != "linear" && interpolation != "cubic")
      throw Error("array '" + array_name + "': axis '" + axis.name + "' has interpolation '" +
                  shortened(interpolation) + "'; allowed: linear, cubic");
    axis.is_cubic = interpolation == "cubic";
    for_each_word(require(attributes, prefix + "nodes"),
                  [&](std::string_view node) { axis.nodes.push_back(number(node)); });
    axes.push_back(std::move(axis));
  }
  return axes;
}

Wavelengths parse_wavelengths(const Attributes& attributes) {
  Wavelengths w;
  w.nm = parse_numbers(attributes, "spectral.nm");
  w.albedo = parse_numbers(attributes, "spectral.albedo");
  w.absorption = parse_numbers(attributes, "spectral.absorption");
  const auto r = parse_numbers(attributes, kWeightNames[0]), g = parse_numbers(attributes, kWeightNames[1]),
             b = parse_numbers(attributes, kWeightNames[2]);
  const std::size_t count = w.nm.size();
  for (const std::size_t size : {w.albedo.size(), w.absorption.size(), r.size(), g.size(), b.size()})
    if (size != count || count > kMostWavelengths)
      throw Error("attributes 'spectral.*' are lists of different lengths, or of more than " +
                  std::to_string(kMostWavelengths));
  require_in("spectral.nm", w.nm, {300, 1000});
  require_in("spectral.albedo", w.albedo, {0, 1});
  for (const double absorption : w.absorption)
    if (!(absorption >= 0)) throw Error("attribute 'spectral.absorption' holds a negative number");
  require_in("spectral.absorption", w.absorption, {0, 1e12});
  const std::vector<double>* const weights[] = {&r, &g, &b};
  for (int c = 0; c < 3; ++c) require_weights(kWeightNames[c], *weights[c]);
  for (std::size_t k = 0; k < count; ++k) w.weight.push_back({r[k], g[k], b[k]});
  return w;
}

Attributes describe_wavelengths(const Wavelengths& w) {
  Attributes attributes;
  attributes["spectral.nm"] = to_text(w.nm);
  attributes["spectral.albedo"] = to_text(w.albedo);
  attributes["spectral.absorption"] = to_text(w.absorption);
  for (int c = 0; c < 3; ++c) {
    std::vector<double> weights;
    for (const Rgb& weight : w.weight) weights.push_back(weight[c]);
    attributes[kWeightNames[c]] = to_text(weights);
  }
  return attributes;
}

Attributes describe_film(const Wavelengths& w) {
  Attributes attributes;
  if (!w.base_index.empty()) describe_indices(std::string(kBasePrefix), w.base_index, attributes);
  if (w.layers.empty()) return attributes;
  require_even_layers(w.layers);
  attributes[std::string(kFilmPrefix) + "periods"] = std::to_string(w.film_periods);
  for (std::size_t j = 0; j < w.layers.front().size(); ++j) {
    const std::string prefix = layer_prefix(j);
    attributes[prefix + "thickness_nm"] = to_text(w.layers.front()[j].thickness_nm);
    std::vector<std::complex<double>> indices;
    for (const std::vector<FilmLayer>& layers : w.layers) indices.push_back(layers[j].index);
    describe_indices(prefix, indices, attributes);
  }
  return attributes;
}

void parse_film(const Attributes& attributes, Wavelengths& w) {
  const auto has = [&](std::string_view prefix) {
    const auto at = attributes.lower_bound(std::string(prefix));
    return at != attributes.end() && at->first.starts_with(prefix);
  };
  if (has(kBasePrefix)) w.base_index = parse_indices(attributes, std::string(kBasePrefix), w.size());
  if (!has(kFilmPrefix)) return;
  w.film_periods = parse_periods(attributes);
  w.layers.resize(w.size());
  for (std::size_t j = 0; j == 0 || has(layer_prefix(j)); ++j) parse_layer(attributes, j, w);
}

void refuse_stray_film(const Attributes& attributes, const Wavelengths& w) {
  const Attributes known = describe_film(w);
  for (const auto& [key, value] : attributes)
    if ((key.starts_with(kFilmPrefix) || key.starts_with(kBasePrefix)) && !known.contains(key))
      throw Error("attribute '" + shortened(key) +
                  "' is there; the film of this table has none of this name");
}

}  // namespace v1
}  // namespace sunbeam
