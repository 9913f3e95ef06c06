// This file says which instructions kernels may use that are compiled for several instruction sets.
#pragma once

namespace sunbeam {
inline namespace v1 {

// Says how a look-up folds the film over wavelengths: with the fastest instructions of this processor, or
// with bits that are the same on every one, for errors that a table states. Both agree to 1e-6 of white.
enum class Arithmetic { fastest, reproducible };

// Says whether the environment variable SUNBEAM_KERNELS is "baseline": every such kernel then runs the one
// that all processors of this kind have. It serves tests, and tells a processor's fault from ours. Throws
// Error if the variable holds anything else but "" or "fastest".
bool baseline_is_forced();

}  // namespace v1
}  // namespace sunbeam
