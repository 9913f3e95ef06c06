// Makes S and Q (runtime/src/lookup/separable.h) of the wavelengths of a factored table at one parameter
// point.
#pragma once

#include "runtime/src/fit/wave_field.h"
#include "runtime/src/lookup/separable.h"

namespace sunbeam::inline v1 {

Separable fit_isotropic(const WaveField& waves);
AnisotropicSeparable fit_anisotropic(const WaveField& waves);

}  // namespace sunbeam::inline v1
