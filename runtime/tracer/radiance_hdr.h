// This file reads pictures of Radiance, .hdr or .pic: Ward, "Real Pixels", Graphics Gems II, 1991, and the
// chapter on picture files of the Radiance reference manual.
#pragma once

#include <string>
#include <string_view>

#include "runtime/tracer/image.h"

namespace sunbeam {

bool is_radiance_hdr(std::string_view bytes);

// Reads RGBE scan lines, flat or run-length coded the old or the new way, of any orientation. EXPOSURE and
// COLORCORR are divided out, PRIMARIES converted to Rec.709; without that line pixels are Rec.709. Throws
// Error, which begins with `name`, for XYZE, for broken scan lines, for what asks for too much memory
// together with `more_bytes_per_pixel` of the caller, and for values that are not finite.
Image parse_radiance_hdr(std::string_view bytes, const std::string& name, std::uint64_t more_bytes_per_pixel);

}  // namespace sunbeam
