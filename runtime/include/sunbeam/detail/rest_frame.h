// This file holds the closed frame that the remainder of a dense table stands in (sunbeam/table.h), at one
// parameter point. The bake encodes (bake/dense/nodes.h) and look-ups decode (runtime/src/rest/dense_rest.h).
// Both are here since each is the inverse of the other.
#pragma once

#include <memory>
#include <vector>

#include "sunbeam/detail/nd_array.h"
#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

class RestFrame {
 public:
  // Where the remainder does not decay it may have lobes too high for a half float, which ends at 65504: of
  // nearly smooth facets at grazing. encode() cuts them. What is too narrow for a table is refused before a
  // bake (bake/dense/lobes.h).
  static constexpr double kLargestRemainder = 60000;

  // Makes the frame of a material, whose film may be layered. `first_visit` is that of Table: empty for rgb3.
  explicit RestFrame(const Material& material, const NdArray& first_visit = {}, bool is_layered = false);

  // Returns the same frame over another material; it allocates nothing and lives no longer than this one.
  RestFrame over(const Material& material) const;

  Rgb decode(const Rgb& remainder, double cos_i, double cos_o, const Rgb& t_i, const Rgb& t_o) const;
  Rgb encode(const Rgb& rest, double cos_i, double cos_o, const Rgb& t_i, const Rgb& t_o) const;

 private:
  // Holds F at even steps of x / (1 + x) from 0 to 1, so that a look-up needs no search and no root; there is
  // none for rgb3.
  using FirstVisit = std::shared_ptr<const std::vector<Rgb>>;
  RestFrame(const Material& material, FirstVisit first_visit, bool is_layered);

  struct Terms {
    Rgb front;        // s T T
    Rgb first_visit;  // in brackets, first term
    Rgb decay;        // in brackets, what the remainder is multiplied by
  };
  double one_visit_cosine(double cosine) const;
  Rgb factor(const Rgb& transmittance) const;
  Rgb first_visit(double optical_path) const;
  Terms rgb3_terms(double m_i, double m_o) const;    // without front
  Terms folded_terms(double m_i, double m_o) const;  // the same for full
  Terms terms(double cos_i, double cos_o, const Rgb& t_i, const Rgb& t_o) const;

  Material material_;
  bool is_layered_;
  double scale_;
  double least_transmittance_;
  bool decays_;
  FirstVisit first_visit_;
};

}  // namespace v1
}  // namespace sunbeam
