/* Does what ../main.cpp does, in C. */
#include <math.h>
#include <stdio.h>
#include <sunbeam/sunbeam.h>

int main(int argc, char** argv) {
  const double viewer[3] = {0.6, 0, 0.8}, light[3] = {-0.8, 0, 0.6}, u[3] = {0.3, 0.6, 0.1};
  sunbeam_options options = {0};
  sunbeam_parameters parameters;
  sunbeam_sample_result sample;
  double f[3], pdf;
  if (argc != 2) return puts("usage: example TABLE.exr"), 2;
  options.color_space = SUNBEAM_REC709;
  sunbeam_table* table = sunbeam_load(argv[1]);
  sunbeam_bsdf* skin = NULL;
  if (table && sunbeam_default_parameters(table, &parameters) == 0) skin = sunbeam_bind(table, &parameters, &options);
  if (!skin) return fprintf(stderr, "example: %s\n", sunbeam_error()), 1;
  sunbeam_free_table(table);
  if (sunbeam_eval(skin, 1, viewer, light, f, &pdf) || sunbeam_sample(skin, 1, viewer, u, &sample)) return 1;
  printf("eval %.17g %.17g %.17g\npdf %.17g\n", f[0], f[1], f[2], pdf);
  if (!sample.is_empty) printf("sample %.17g %.17g %.17g\n", sample.wi[0], sample.wi[1], sample.wi[2]);
  sunbeam_free_bsdf(skin);
  return 0;
}
