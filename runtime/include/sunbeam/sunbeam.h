/* This is the runtime in C, for other languages and compilers: tables are loaded, bound and looked up.
 *
 * Directions are unit vectors in the local frame, z = shading normal, that point away from the surface: three
 * doubles each. f is in 1/sr without the cosine and without Dirac lobes; a throughput is f cos / pdf.
 * sunbeam/bsdf.h has the whole contract.
 *
 * Functions that return a pointer return null when they fail, and those that return an int return 0 for
 * success and -1 for failure; sunbeam_error() then has the message. Null pointers are failures, but for free
 * functions, which take them. So are parameters that are NaN and directions whose length is not 1 to 0.001;
 * a batch that fails has written the pairs before. Objects are constant: any number of threads may use one,
 * and free it once.
 */
#ifndef SUNBEAM_SUNBEAM_H
#define SUNBEAM_SUNBEAM_H

#include <stddef.h>

#if defined(SUNBEAM_SHARED) && defined(__GNUC__)
#define SUNBEAM_C_API __attribute__((visibility("default")))
#else
#define SUNBEAM_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sunbeam_table sunbeam_table;       /* a loaded table */
typedef struct sunbeam_bsdf sunbeam_bsdf;         /* a table bound to one parameter point */
typedef struct sunbeam_textured sunbeam_textured; /* a table whose parameters change at every hit */

typedef struct sunbeam_parameters {
  double film_thickness_nm; /* nm */
  double base_ior;
  double absorption_per_nm; /* 1/nm */
} sunbeam_parameters;

typedef enum sunbeam_color_space {
  SUNBEAM_TABLE_SPACE = 0, /* that of the table */
  SUNBEAM_REC709,
  SUNBEAM_ACESCG,
  SUNBEAM_REC2020,
  SUNBEAM_XYZ
} sunbeam_color_space;

/* All zero is the default. */
typedef struct sunbeam_options {
  int clamp;         /* parameters beyond the table: 0 refuses, else clamps */
  int color_space;   /* of all values: a sunbeam_color_space */
  int clip_negative; /* else than 0: negative components are raised to 0 */
} sunbeam_options;

typedef struct sunbeam_sample_result {
  double wi[3];
  double throughput[3]; /* f cos / pdf */
  double pdf;           /* 1/sr; 0 for a Dirac lobe and for an empty sample */
  int is_dirac;
  int is_empty; /* the light is lost; all else is 0 */
} sunbeam_sample_result;

/* Returns the version of the library, such as "0.2.0". */
SUNBEAM_C_API const char* sunbeam_version(void);
/* Returns the message of this thread's last failure, which holds until the next one; empty without any. */
SUNBEAM_C_API const char* sunbeam_error(void);

/* Loads an .exr table. */
SUNBEAM_C_API sunbeam_table* sunbeam_load(const char* path);
SUNBEAM_C_API void sunbeam_free_table(sunbeam_table* table);
/* Writes the parameters that the table's recipe states. */
SUNBEAM_C_API int sunbeam_default_parameters(const sunbeam_table* table, sunbeam_parameters* parameters);

/* Binds the table, which may be freed afterwards; null options are the default. */
SUNBEAM_C_API sunbeam_bsdf* sunbeam_bind(const sunbeam_table* table, const sunbeam_parameters* parameters,
                                         const sunbeam_options* options);
SUNBEAM_C_API void sunbeam_free_bsdf(sunbeam_bsdf* bsdf);

/* Writes f (3 count) and pdf (count, 1/sr) of `count` pairs wo, wi (3 count each). f or pdf may be null. */
SUNBEAM_C_API int sunbeam_eval(const sunbeam_bsdf* bsdf, size_t count, const double* wo, const double* wi,
                               double* f, double* pdf);
/* Draws a direction for each of `count` viewers wo (3 count) from numbers u in [0, 1) (3 count). */
SUNBEAM_C_API int sunbeam_sample(const sunbeam_bsdf* bsdf, size_t count, const double* wo, const double* u,
                                 sunbeam_sample_result* samples);

/* These do the same with parameters for each pair, `count` of them; they are clamped to the table. */
SUNBEAM_C_API sunbeam_textured* sunbeam_make_textured(const sunbeam_table* table,
                                                      const sunbeam_options* options);
SUNBEAM_C_API void sunbeam_free_textured(sunbeam_textured* textured);
SUNBEAM_C_API int sunbeam_eval_at(const sunbeam_textured* textured, size_t count,
                                  const sunbeam_parameters* parameters, const double* wo, const double* wi,
                                  double* f, double* pdf);
SUNBEAM_C_API int sunbeam_sample_at(const sunbeam_textured* textured, size_t count,
                                    const sunbeam_parameters* parameters, const double* wo, const double* u,
                                    sunbeam_sample_result* samples);

#ifdef __cplusplus
}
#endif

#endif
