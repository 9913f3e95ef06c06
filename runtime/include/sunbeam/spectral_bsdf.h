// A SpectralBsdf is a factored table bound to one parameter point and to a list of wavelengths, for renderers
// that carry wavelengths in place of colours: 4 hero wavelengths, or a list over the spectrum.
//
// eval = first + rest of table.h at each wavelength, 1/sr, without the cosine and without the Dirac part: the
// film exactly, the rest by the arrays of the table (factors.h). Base albedo, absorption and the indices of
// layers are linear in the wavelength between those that the table stores. sample draws from the density of
// TableBsdf, which follows the mean over colour channels; it serves all wavelengths of a path at once.
//
// The object is constant after construction. Const calls lock nothing and may run on any number of threads.
// They allocate where the path is "product", the film layered or the base opaque, and may then throw
// std::bad_alloc. Copies share the data. Construction copies the table and fits the colour look-up, which
// takes as long as binding.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "sunbeam/core/export.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam {
inline namespace v1 {

struct SpectralData;

// Returns the least and the greatest wavelength, nm, that look-ups of a table may be bound to. Throws Error
// with the reason if there are none: a dense table holds colours alone.
SUNBEAM_EXPORT Interval spectral_range(const Table& table);

class SUNBEAM_EXPORT SpectralBsdf {
 public:
  // Takes 1 to 64 wavelengths in nm, in any order. Throws Error if the table has none (spectral_range), if
  // one lies beyond the range, or if parameters are refused. Of `options` only `outside` and `arithmetic`
  // matter.
  SpectralBsdf(const Table& table, const Parameters& parameters, std::span<const double> wavelengths_nm,
               const BindOptions& options = {});

  std::size_t size() const;  // of the list

  // Writes f at each wavelength; `f` has size() places.
  void eval(const Vec3& wo, const Vec3& wi, std::span<double> f) const;
  // Returns the density of sample(), 1/sr, of all wavelengths.
  double pdf(const Vec3& wo, const Vec3& wi) const;

  struct Sample {
    Vec3 wi;
    bool is_dirac;
    double pdf;  // 0 for a Dirac lobe
  };
  // Draws a direction by u in [0, 1)^3 and writes f cos / pdf at each wavelength. The result is empty, and
  // nothing written, when the light is lost.
  std::optional<Sample> sample(const Vec3& wo, const Random3& u, std::span<double> throughput) const;

  // Writes the weight of the mirror direction at each wavelength; 0 for a rough film.
  void dirac(const Vec3& wo, std::span<double> weight) const;

 private:
  std::shared_ptr<const SpectralData> data_;
};

}  // namespace v1
}  // namespace sunbeam
