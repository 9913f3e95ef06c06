// This file holds the parameters of the layered skin: exterior | thin film | pigment layer | diffuse base.
//
// Keys of recipes and tables are the member names. Lengths are in nm, absorption and scattering in 1/nm, the
// rest has no unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sunbeam/core/export.h"
#include "sunbeam/core/vec.h"
#include "sunbeam/detail/roughness.h"

namespace sunbeam {
inline namespace v1 {

// Says how light passes the film. "straight" does not bend it, and one reflectance serves both sides.
// "refract" bends it from the exterior to the base medium; from below the film is met reversed, with total
// internal reflection.
enum class Transmission { straight, refract };

// Says how the pigment attenuates light between entering and leaving, with
// tau = absorption_per_nm * pigment_thickness_nm and cosines below the film (Beer-Lambert):
// "product" by exp(-tau / (cos_i cos_o)), "sum" by exp(-tau (1/cos_i + 1/cos_o)).
enum class AbsorptionPath { product, sum };

// Says what becomes of light that a rough film's facets throw onto other facets: "single" loses it,
// "multiple" follows it until it leaves the microsurface (Heitz et al. 2016).
enum class Microfacet { single, multiple };

// One skin. The intervals are those that every reader allows.
struct SUNBEAM_EXPORT Material {
  Transmission transmission = Transmission::refract;
  AbsorptionPath absorption_path = AbsorptionPath::sum;
  double film_thickness_nm = 300;   // d0, 0 to 100000
  double exterior_ior = 1;          // n0, 1 to 5
  double film_ior = 1.56;           // n1, 1 to 5
  double base_ior = 1.5;            // n2, 1 to 5; 0.05 to 10 if the base absorbs
  double base_extinction = 0;       // k2, 0 to 100; a base with k2 > 0 is opaque, and all it does is reflect
  double thickness_spread = 0;      // of the film among the platelets under a pixel, relative, 0 to 0.3
  double absorption_per_nm = 0.1;   // sigma_a of the pigment, 0 to 1000
  double pigment_thickness_nm = 2;  // d1, 0 to 1e6
  double scattering_per_nm = 0;     // sigma_s of the pigment, 0 to 1000, the same at all wavelengths
  double anisotropy = 0;            // mean cosine g of its Henyey-Greenstein phase function, -0.99 to 0.99
  Rgb albedo = Rgb(0.3);            // kd of the diffuse base, each 0 to 1
  Roughness roughness = 0.1;        // GGX alpha of the film, 0 (smooth) to 1
  Microfacet microfacet = Microfacet::single;

  bool is_smooth() const { return roughness.u == 0; }
  bool is_opaque() const { return base_extinction > 0; }
  double optical_depth() const { return absorption_per_nm * pigment_thickness_nm; }
  double scattering_depth() const { return scattering_per_nm * pigment_thickness_nm; }
  bool scatters() const { return scattering_depth() > 0; }
  bool has_multiple_facets() const { return microfacet == Microfacet::multiple && !is_smooth(); }

  // Says whether polar angles alone describe the light below the film, so that quadrature solves the
  // material: the pigment does not scatter, and isotropic facets are met once.
  bool is_plain() const { return !scatters() && roughness.is_isotropic() && !has_multiple_facets(); }

  // A value out of its interval, or two that do not go together.
  struct Defect {
    std::string key, text;  // "found V ...; allowed: ..."
    std::string message() const { return "key '" + key + "': " + text; }
  };
  // Returns the first defect, or nothing if all is well.
  std::optional<Defect> defect() const;

  // Returns (n0/n2)^2, which radiance pays once over a whole visit below the film, or 1 with "straight".
  double radiance_scale() const;

  // Returns the cosine below the film of a direction that crosses a smooth film at `cos_exterior`, by Snell's
  // law; 0 if it is reflected totally.
  double cosine_below(double cos_exterior) const;

  // Returns the exponent of AbsorptionPath for one visit of the base; both cosines are below the film and >
  // 0.
  double absorption_exponent(double cos_i, double cos_o) const;
};

// The largest scattering_depth() allowed: walks through a thicker pigment would not end in useful time.
inline constexpr double kMostScatteringDepth = 100;

// These give access by key and text, for CSV columns, table metadata and messages. Lists are separated by
// ';'.
const std::vector<std::string>& material_keys();
SUNBEAM_EXPORT std::string get_text(const Material& material, std::string_view key);
// Throws Error "key 'K': found V; allowed: ..." (without a file: the caller adds it). What a base_ior may be
// depends on base_extinction: set the keys in the order of material_keys().
SUNBEAM_EXPORT void set_from_text(Material& material, std::string_view key, const std::string& text);

SUNBEAM_EXPORT std::string_view to_string(Transmission transmission);
SUNBEAM_EXPORT std::string_view to_string(AbsorptionPath path);
SUNBEAM_EXPORT std::string_view to_string(Microfacet microfacet);
// Returns one number, or two separated by ';'.
SUNBEAM_EXPORT std::string to_string(const Roughness& roughness);
// Describes what Roughness::is_allowed() allows, for messages.
SUNBEAM_EXPORT std::string allowed_roughness();

// The allowed interval of a numeric key; every reader uses it.
struct Interval {
  double low, high;
};
SUNBEAM_EXPORT Interval allowed_interval(std::string_view key);
// Returns that of this material: what a base_ior may be depends on base_extinction.
SUNBEAM_EXPORT Interval allowed_interval(std::string_view key, const Material& material);

}  // namespace v1
}  // namespace sunbeam
