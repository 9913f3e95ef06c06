// This file says how a recipe sees colour: which wavelengths are computed, what the base is at each of them,
// and how they are folded.
//
// rgb3  650, 510 and 475 nm are taken as the linear channels R, G, B, which whoever shows them reads as
//       Rec.709.
// full  The nodes of a fitted quadrature (docs/theory/color.md) fold into a linear colour space under an
//       illuminant. The albedo has a spectrum, given or uplifted from RGB, and the pigment's absorption a
//       relative spectrum.
//
// It holds the film's design too, and says what its layers and the base are at the wavelengths.
//
// Material::albedo is in the space of the fold; artists write Rec.709, and from_rec709() takes them there.
#pragma once

#include <map>
#include <string>

#include "bake/optics/dispersion/film_design.h"
#include "bake/optics/spectral_material.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam {

// Returns the longest optical path 2 n1 d0 (nm) that `nodes` wavelengths resolve.
constexpr double resolved_path_nm(std::size_t nodes) {
  return kDefaultLargestPathNm / kDefaultNodes * static_cast<double>(nodes);
}

class Spectrum {
 public:
  Spectrum() = default;  // rgb3

  // Makes the spectrum "full", for films up to an optical path 2 n1 d0 (nm). Throws Error if that asks for
  // more than kMostWavelengths.
  Spectrum(Illuminant illuminant, ColorSpace color_space, double longest_path_nm,
           AbsorptionShape absorption = AbsorptionShape::flat());

  // Makes the spectrum "full" at the nodes of a quadrature of the illuminant and the space, which has 1 to
  // kMostWavelengths of them.
  Spectrum(Illuminant illuminant, ColorSpace color_space, WavelengthQuadrature quadrature,
           AbsorptionShape absorption = AbsorptionShape::flat());

  // Sets the design of film and base. In full served_path_nm is the longest path 2 sum(n d) that the
  // wavelengths are meant for, if they resolve it.
  void set_film(FilmDesign film, double served_path_nm);
  const FilmDesign& film() const { return film_; }

  bool is_full() const { return quadrature_.size() > 0; }
  ColorSpace color_space() const { return color_space_; }

  // Takes a linear Rec.709 colour to the space of the fold; it is unchanged in rgb3.
  Rgb from_rec709(const Rgb& color) const;

  // Sets the spectral albedo (reflectances 0 to 1) that belongs to the RGB albedo returned: its fold at the
  // nodes, in 0 to 1 (a spectrum outside the gamut keeps its own values; only this RGB is clamped). It may be
  // called in full only.
  Rgb set_albedo(const SpectralCurve& albedo);
  // Uplifts an RGB albedo in the space of the fold now, so that wavelengths() need not. Throws Error if no
  // reflectance has the colour. It may be called in full only.
  void set_albedo(const Rgb& albedo);

  // Returns the wavelengths that the live model carries. An albedo other than the one set is uplifted on the
  // way. In full it throws Error if no reflectance has the albedo, or if the film is thicker than the nodes
  // serve.
  Wavelengths wavelengths(const Material& material) const;

  // Returns one wavelength (nm, vacuum) for every channel. In rgb3 it has the albedo's first channel and flat
  // absorption, in full the albedo and absorption at that wavelength; an uplifted albedo is joined by
  // straight lines, constant beyond the nodes. Throws Error if an index of the film's design is not known
  // there.
  Wavelengths monochromatic(const Material& material, double nm) const;

  // Returns the attributes of a table: spectrum, and in full also color_space, illuminant, wavelengths (nm,
  // ascending).
  std::map<std::string, std::string> attributes() const;

 private:
  SpectralCurve albedo_curve(const Rgb& albedo) const;
  void require_served(const Material& material) const;
  void require_path(const Material& material, double longest_nm, const std::string& remedy) const;
  Wavelengths with_film(const Material& material, Wavelengths wavelengths) const;
  Wavelengths full_wavelengths(const Material& material) const;

  Illuminant illuminant_ = Illuminant::d65;
  ColorSpace color_space_ = ColorSpace::rec709;
  WavelengthQuadrature quadrature_;  // empty: rgb3
  FilmDesign film_;
  double served_path_nm_ = 0;  // in full
  AbsorptionShape absorption_ = AbsorptionShape::flat();
  Rgb albedo_;                  // RGB albedo of the base, to which albedo_curve_ belongs
  SpectralCurve albedo_curve_;  // empty if no albedo is set
};

}  // namespace sunbeam
