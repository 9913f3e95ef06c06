// This file converts between linear RGB spaces and accounts for colours outside a gamut.
//
// Policy. Narrow-band (iridescent) spectra can lie outside Rec.709, whose components then leave [0, 1].
// Components keep their sign everywhere inside; nothing in this project clips on its own. ACEScg holds the
// colours of thin films without negative components and is the recommended space for tables. Conversion
// happens at the edge, and who must drop negative components there does it with ClipAccount, which says how
// much light that added.
#pragma once

#include <cstdint>
#include <string_view>

#include "sunbeam/core/export.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {

// rec709: ITU-R BT.709-6 primaries, white x, y = 0.3127, 0.3290.
// acescg: AP1 primaries, white x, y = 0.32168, 0.33767 (AMPAS S-2014-004).
// rec2020: ITU-R BT.2020-2 primaries, white x, y = 0.3127, 0.3290.
// xyz: CIE 1931 tristimulus values under the white of rec709, at which Y = 1; (1, 1, 1) is not its white.
enum class ColorSpace { rec709, acescg, rec2020, xyz };

// Returns the name: "rec709", "acescg", "rec2020", "xyz".
SUNBEAM_EXPORT std::string_view to_string(ColorSpace space);
// Returns the space of that name; throws Error "found 'S'; allowed: rec709, acescg, rec2020, xyz" (the caller
// adds where).
SUNBEAM_EXPORT ColorSpace color_space_from(std::string_view name);

// A linear map between tristimulus values or linear colours, by rows.
struct SUNBEAM_EXPORT ColorMatrix {
  Vec3 row[3];

  Vec3 operator*(const Vec3& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
  Rgb operator*(const Rgb& c) const {
    const Vec3 v = *this * Vec3{c.r, c.g, c.b};
    return {v.x, v.y, v.z};
  }
  ColorMatrix operator*(const ColorMatrix& other) const;
};
SUNBEAM_EXPORT ColorMatrix inverse(const ColorMatrix& matrix);

// Returns the tristimulus values of the space's own white, with Y = 1.
SUNBEAM_EXPORT Vec3 white(ColorSpace space);

// Maps linear RGB to XYZ relative to the space's own white: RGB (1, 1, 1) becomes `white(space)`.
SUNBEAM_EXPORT ColorMatrix rgb_to_xyz(ColorSpace space);

// Adapts XYZ seen under the white `from` to XYZ seen under `to`, after Bradford (CIE 160:2004; Lam 1985).
SUNBEAM_EXPORT ColorMatrix bradford(const Vec3& from, const Vec3& to);

// Maps XYZ to linear RGB. XYZ is measured under an illuminant that gives a perfect white diffuser
// `illuminant_white`; it is adapted to the white of the space, so that the diffuser is (1, 1, 1) whatever the
// illuminant.
SUNBEAM_EXPORT ColorMatrix xyz_to_rgb(const Vec3& illuminant_white, ColorSpace space);

// Maps linear RGB of one space to another, adapted from white to white: (1, 1, 1) stays (1, 1, 1), unless one
// of them is xyz.
SUNBEAM_EXPORT ColorMatrix rgb_to_rgb(ColorSpace from, ColorSpace to);

// Returns Y of a linear colour; that of (1, 1, 1) is 1.
SUNBEAM_EXPORT double luminance(const Rgb& color, ColorSpace space);

// A colour with its negative components raised to zero. Raising adds light: `added` holds the amounts (all
// >= 0) and `luminance_added` their luminance.
struct GamutClip {
  Rgb clipped;
  Rgb added;
  double luminance_added = 0;
};
SUNBEAM_EXPORT GamutClip clip_negative(const Rgb& color, ColorSpace space);

// This clips many colours and keeps the account, for a report.
struct SUNBEAM_EXPORT ClipAccount {
  std::int64_t colors = 0;     // how many were seen
  std::int64_t clipped = 0;    // how many had a negative component
  double lowest = 0;           // the most negative component
  double luminance = 0;        // the sum before clipping
  double luminance_added = 0;  // the sum that clipping added

  Rgb clip(const Rgb& color, ColorSpace space);
};

}  // namespace v1
}  // namespace sunbeam
