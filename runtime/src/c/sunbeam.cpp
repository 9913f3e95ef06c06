#include "sunbeam/sunbeam.h"

#include <cmath>

#include "runtime/src/base/attempt.h"
#include "sunbeam/core/error.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_io.h"
#include "sunbeam/textured_table.h"

struct sunbeam_table {
  sunbeam::Table table;
};
struct sunbeam_bsdf {
  sunbeam::TableBsdf bsdf;
};
struct sunbeam_textured {
  sunbeam::TexturedTable table;
};

namespace sunbeam {
inline namespace v1 {
namespace {

// A thread that is out of memory has no more for its message.
thread_local std::string last_error;
void set_error(const char* message) {
  try {
    last_error = message;
  } catch (const std::bad_alloc&) {
    last_error.clear();
  }
}

void require(const void* pointer, const char* name) {
  if (pointer == nullptr) throw Error(std::string("argument '") + name + "' is null");
}

// Runs `body` behind the boundary that no exception crosses.
template <class Body>
int guarded(Body body) noexcept {
  try {
    const auto result = attempt([&] {
      body();
      return 0;
    });
    if (result) return 0;
    set_error(result.error().c_str());
  } catch (...) {
    set_error("out of memory");
  }
  return -1;
}
template <class T, class Make>
T* made(Make make) noexcept {
  T* object = nullptr;
  guarded([&] { object = new T{make()}; });
  return object;
}

BindOptions options_of(const sunbeam_options* given) {
  if (given == nullptr) return {};
  BindOptions options;
  options.outside = given->clamp != 0 ? OutsideGrid::clamp : OutsideGrid::refuse;
  options.clip_negative = given->clip_negative != 0;
  const int space = given->color_space;
  if (space < SUNBEAM_TABLE_SPACE || space > SUNBEAM_XYZ)
    throw Error("color_space: found " + std::to_string(space) + "; allowed: 0 to " +
                std::to_string(SUNBEAM_XYZ));
  if (space != SUNBEAM_TABLE_SPACE) options.color_space = static_cast<ColorSpace>(space - SUNBEAM_REC709);
  return options;
}
static_assert(SUNBEAM_XYZ - SUNBEAM_REC709 == static_cast<int>(ColorSpace::xyz));

Parameters parameters_of(const sunbeam_parameters& p) {
  const Parameters parameters = {p.film_thickness_nm, p.base_ior, p.absorption_per_nm};
  for (const double value : parameters.values())
    if (std::isnan(value)) throw Error("parameters: found nan; allowed are numbers");
  return parameters;
}

// Look-ups trust their directions, and callers in other languages get an error for what C++ must not pass.
Vec3 direction(const char* name, const double* values, std::size_t k) {
  const Vec3 w = {values[3 * k], values[3 * k + 1], values[3 * k + 2]};
  if (!(std::abs(std::sqrt(dot(w, w)) - 1) <= 1e-3))
    throw Error(std::string(name) + ": direction " + std::to_string(k) + " is (" + std::to_string(w.x) +
                ", " + std::to_string(w.y) + ", " + std::to_string(w.z) + "); allowed are unit vectors");
  return w;
}

void write(const EvalPdf& value, std::size_t k, double* f, double* pdf) {
  for (int c = 0; c < 3 && f != nullptr; ++c) f[3 * k + static_cast<std::size_t>(c)] = value.f[c];
  if (pdf != nullptr) pdf[k] = value.pdf;
}

sunbeam_sample_result written(const std::optional<BsdfSample>& sample) {
  if (!sample) return {{0, 0, 0}, {0, 0, 0}, 0, 0, 1};
  const Rgb& t = sample->throughput;
  return {{sample->wi.x, sample->wi.y, sample->wi.z},
          {t.r, t.g, t.b},
          sample->mis_pdf,
          sample->is_dirac ? 1 : 0,
          0};
}

// `at(k)` is the BSDF of pair k.
template <class At>
void eval_all(std::size_t count, const double* wo, const double* wi, double* f, double* pdf, At at) {
  require(wo, "wo");
  require(wi, "wi");
  for (std::size_t k = 0; k < count; ++k)
    write(at(k).eval_pdf(direction("wo", wo, k), direction("wi", wi, k)), k, f, pdf);
}
template <class At>
void sample_all(std::size_t count, const double* wo, const double* u, sunbeam_sample_result* samples, At at) {
  require(wo, "wo");
  require(u, "u");
  require(samples, "samples");
  for (std::size_t k = 0; k < count; ++k) {
    const Random3 numbers = {u[3 * k], u[3 * k + 1], u[3 * k + 2]};
    for (const double x : numbers)
      if (!(x >= 0 && x < 1)) throw Error("u: found " + std::to_string(x) + "; allowed: from 0 to below 1");
    samples[k] = written(at(k).sample(direction("wo", wo, k), numbers));
  }
}

}  // namespace
}  // namespace v1
}  // namespace sunbeam

using namespace sunbeam;

const char* sunbeam_version(void) { return SUNBEAM_VERSION; }
const char* sunbeam_error(void) { return last_error.c_str(); }

sunbeam_table* sunbeam_load(const char* path) {
  return made<sunbeam_table>([&] {
    require(path, "path");
    return load_table_exr(path);
  });
}
void sunbeam_free_table(sunbeam_table* table) { delete table; }

int sunbeam_default_parameters(const sunbeam_table* table, sunbeam_parameters* parameters) {
  return guarded([&] {
    require(table, "table");
    require(parameters, "parameters");
    const Parameters p = Parameters::of(table->table.material);
    *parameters = {p.film_thickness_nm, p.base_ior, p.absorption_per_nm};
  });
}

sunbeam_bsdf* sunbeam_bind(const sunbeam_table* table, const sunbeam_parameters* parameters,
                           const sunbeam_options* options) {
  return made<sunbeam_bsdf>([&] {
    require(table, "table");
    require(parameters, "parameters");
    return table->table.bind(parameters_of(*parameters), options_of(options));
  });
}
void sunbeam_free_bsdf(sunbeam_bsdf* bsdf) { delete bsdf; }

int sunbeam_eval(const sunbeam_bsdf* bsdf, size_t count, const double* wo, const double* wi, double* f,
                 double* pdf) {
  return guarded([&] {
    require(bsdf, "bsdf");
    eval_all(count, wo, wi, f, pdf, [&](std::size_t) -> const TableBsdf& { return bsdf->bsdf; });
  });
}
int sunbeam_sample(const sunbeam_bsdf* bsdf, size_t count, const double* wo, const double* u,
                   sunbeam_sample_result* samples) {
  return guarded([&] {
    require(bsdf, "bsdf");
    sample_all(count, wo, u, samples, [&](std::size_t) -> const TableBsdf& { return bsdf->bsdf; });
  });
}

sunbeam_textured* sunbeam_make_textured(const sunbeam_table* table, const sunbeam_options* options) {
  return made<sunbeam_textured>([&] {
    require(table, "table");
    return TexturedTable(table->table, options_of(options));
  });
}
void sunbeam_free_textured(sunbeam_textured* textured) { delete textured; }

int sunbeam_eval_at(const sunbeam_textured* textured, size_t count, const sunbeam_parameters* parameters,
                    const double* wo, const double* wi, double* f, double* pdf) {
  return guarded([&] {
    require(textured, "textured");
    require(parameters, "parameters");
    eval_all(count, wo, wi, f, pdf,
             [&](std::size_t k) { return textured->table.at(parameters_of(parameters[k])); });
  });
}
int sunbeam_sample_at(const sunbeam_textured* textured, size_t count, const sunbeam_parameters* parameters,
                      const double* wo, const double* u, sunbeam_sample_result* samples) {
  return guarded([&] {
    require(textured, "textured");
    require(parameters, "parameters");
    sample_all(count, wo, u, samples,
               [&](std::size_t k) { return textured->table.at(parameters_of(parameters[k])); });
  });
}
