// This macro marks what the shared library shows. SUNBEAM_SHARED is set by its package for those who link it.
#pragma once

#if defined(SUNBEAM_SHARED) && defined(__GNUC__)
#define SUNBEAM_EXPORT __attribute__((visibility("default")))
#else
#define SUNBEAM_EXPORT
#endif
