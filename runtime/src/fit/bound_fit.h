// This file makes S and Q (runtime/src/rest/separable.h) of the wavelengths of a factored table at one
// parameter point.
#pragma once

#include "runtime/src/fit/bound_waves.h"
#include "runtime/src/rest/separable.h"

namespace sunbeam {
inline namespace v1 {

Separable fit_isotropic(const BoundWaves& waves);
AnisotropicSeparable fit_anisotropic(const BoundWaves& waves);

}  // namespace v1
}  // namespace sunbeam
