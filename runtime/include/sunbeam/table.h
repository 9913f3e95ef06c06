// A table is a baked material: BRDF data over (film thickness, base IOR, absorption) and two directions.
//
// There are two encodings. The factored one is described in factors.h. The dense one serves every material
// and is described below: what is exactly known stays in closed form and only the remainder is tabulated.
// With c_i, c_o the cosines of the directions, m_i, m_o the cosines below the film, tau the optical depth,
// tau_s the scattering depth, s = (n0/n2)^2 or 1 and kd albedo:
//
//   f     = first + rest
//   first = D(h) G2(wi, wo) R(wi.h) / (4 c_i c_o)            (smooth film: a Dirac of weight R(c_i) instead)
//   rest  = s T(c_i) T(c_o) [ ballistic kd/pi exp(-tau path(m_i, m_o)) + decay remainder ]
//   ballistic = exp(-tau_s (1/m_i + 1/m_o)),  decay = exp(-min(tau (1/m_i + 1/m_o), 12))
//
// R = `film_reflectance`, T = `film_transmittance`, or 1 - R where there is no such array, `remainder` = the
// array of that name; path as in AbsorptionPath. The first term in brackets is one visit of the base
// through a smooth film, the remainder holds further visits, what the pigment scatters and what roughness
// changes. The decay is that of the remainder; the cap keeps it within the range of a half float. All values
// are per colour channel.
//
// Some light of the rest has not been through the pigment: scattered near its top, or thrown from facet to
// facet above the film. It does not decay, so a pigment that scatters and multiple facets have decay = 1.
// Multiple facets reflect where the film lets nothing through (R near 1), so T is raised to 0.25 for them.
// That of other layered films (layered_film.h) is raised to 0.01, as layers may let through next to nothing.
//
// Where colours are folded spectra (spectrum "full") the two terms become
//   ballistic F(tau path) / pi + decay(tau (1/m_i + 1/m_o)) remainder,
//   decay(x) = F(x) / F(0), kept within a factor of 10 of D = max(mean F(x) / mean F(0), exp(-12)); D if F(0)
//   <= 0; or 1 as above,
// with F = `first_visit`, T in front is raised to 30 % of its mean over channels, and values may be negative.
//
// With FrameKind::none, which files of version 0.1 may have, there is no closed form in the rest at all: it
// is what the array `remainder` holds.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sunbeam/bind_options.h"
#include "sunbeam/core/color_space.h"
#include "sunbeam/core/export.h"
#include "sunbeam/detail/angles.h"
#include "sunbeam/detail/factors.h"
#include "sunbeam/detail/nd_array.h"
#include "sunbeam/material.h"
#include "sunbeam/parameters.h"

namespace sunbeam {
inline namespace v1 {

// The versions of the files that are read; tables whose film is one clear layer are written in the second.
inline constexpr int kTableSchemaVersion = 4, kSingleFilmSchemaVersion = 3, kOldestTableSchemaVersion = 2;

// Says whether files of this version hold the key of a material. Where they do not, a table's material has
// the default.
SUNBEAM_EXPORT bool is_in_tables(std::string_view key, int schema_version);

// Says what the array `remainder` of a dense table stands in: see above.
enum class FrameKind { closed, none };

constexpr const char* name_of(FrameKind frame) { return frame == FrameKind::closed ? "closed" : "none"; }

class TableBsdf;

struct SUNBEAM_EXPORT Table {
  Material material;  // fixed values, and defaults for the parameters
  Symmetry symmetry = Symmetry::isotropic;

  Factors factors;  // encoding "factored", else empty; the arrays below are then empty

  FrameKind frame = FrameKind::closed;

  // Their axes are (film_thickness_nm, base_ior, cos_theta); they are finer than the grid, as fringes need
  // it.
  NdArray film_reflectance;
  NdArray film_transmittance;  // empty for a smooth film of one clear layer, and without a frame

  // Only spectrum "full" with a frame has it, else it is empty. Over the axis optical_path it holds the base
  // under its pigment without the film, times pi, folded over the wavelengths: F(x) = fold(kd exp(-a x)), a =
  // absorption relative to the one at 510 nm.
  NdArray first_visit;

  // Its axes are (film_thickness_nm, base_ior, absorption_per_nm, cos_theta_i, phi_i, cos_theta_o, phi_o); a
  // parameter that is not in the grid has one node.
  NdArray remainder;
  // This is the standard error of the rest, 1/sr, over the same axes: one number a cell, the mean over
  // channels, to three binary digits.
  NdArray rest_stderr;

  // Holds provenance and measured error as text: recipe, recipe_hash, seed, samples, estimator, spectrum,
  // tool_version, encoding, error.<name>; with spectrum "full" also color_space, illuminant, wavelengths.
  std::map<std::string, std::string> info;

  // Holds the version of the file that the table came from, or that a bake gives it: kTableSchemaVersion if
  // the film is layered (layered_film.h). One of an older version is written in kSingleFilmSchemaVersion.
  int schema_version = kSingleFilmSchemaVersion;

  // Returns true if colours are spectra folded into color_space(), where components may be negative; else R,
  // G, B are three wavelengths (spectrum "rgb3").
  bool is_full_spectrum() const;
  // Returns the space of all colours in the table, the albedo included. The three wavelengths of rgb3 are
  // taken as rec709.
  ColorSpace color_space() const;

  bool is_factored() const { return !factors.empty(); }
  bool has_layered_film() const { return schema_version == kTableSchemaVersion; }

  const Axis& parameter_axis(std::size_t k) const {
    return is_factored() ? factors.grid[k] : remainder.axes()[k];
  }

  // Returns the material at fixed parameters, for which look-ups are prepared (table_bsdf.h). Textured
  // parameters are the matter of textured_table.h. Throws Error naming the key if parameters are refused. Any
  // number of threads may bind one table at once.
  TableBsdf bind(const Parameters& parameters, const BindOptions& options = {}) const;

  // Returns T (see above) at a node or between; `x` = (film_thickness_nm, base_ior, cos_theta).
  Rgb transmittance(const std::array<double, 3>& x) const;

  // Returns the arrays that it has, by name, which is the order of its file.
  std::vector<const NdArray*> arrays() const;

  bool operator==(const Table& other) const;
};

// Says whether some base IOR of the table lies below the exterior's.
SUNBEAM_EXPORT bool reaches_below(const Table& table);

}  // namespace v1
}  // namespace sunbeam
