// Which instructions the kernels may use.
#pragma once

namespace sunbeam::inline v1 {

// Whether the environment variable SUNBEAM_KERNELS is "baseline": every kernel that is compiled for several
// instruction sets then runs the one that all processors of this kind have. For tests, and to tell a
// processor's fault from ours. Throws Error if the variable holds anything else but "" or "fastest".
bool baseline_is_forced();

}  // namespace sunbeam::inline v1
