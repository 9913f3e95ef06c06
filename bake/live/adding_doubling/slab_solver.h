// This file computes the rest of a film over a scattering pigment without walks: by adding and doubling, one
// Fourier mode of the azimuth at a time. It serves isotropic films whose facets are met once (solves()).
//
// Directions below the film are Gauss nodes of the cosine m, m_j of weight w_j, M = diag(2 pi w_j m_j). Per
// wavelength and mode k, with Int g cos(k phi) dphi of what light carries and 1/(2 pi) Int g cos(k phi) dphi
// of what it is carried by:
//   E_w  light that enters along w, per node: moments of the film's crossing at its facets,
//   F    light that the film throws back down, from node to node, the same of its reflection,
//   R, T of the pigment alone (functions: radiance that leaves, for power that arrives), by doubling a layer
//        thin enough to scatter once.
// What never reaches the base is, with D = (1 - F M R)^-1 E_wi the light on its way down,
//   slab_k(wo, wi) = s E_wo . R D,      slab = sum_k (2 - delta_k0) slab_k cos(k phi),
// and the base, which forgets directions, sees the mode 0 alone:
//   base = s kd/pi A(wo) A(wi) / (1 - kd returned),  A(w) = 1 . M T D,
// returned = the share of what leaves a Lambertian base that comes back to it. The facets' integrals E and F
// interpolate what they act on between the nodes, so that no lobe is too narrow.
// tests/accuracy/dense/slab_solver_test.cpp holds the discretisation errors. Sources: van de Hulst, Multiple
// Light Scattering (1980), ch. 4; Jakob et al., A comprehensive framework for rendering layered materials,
// SIGGRAPH 2014.
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "bake/live/exact/dense.h"
#include "bake/live/film/geometry.h"
#include "bake/live/general/slab.h"
#include "bake/live/walks/kernels.h"
#include "sunbeam/detail/angles.h"

namespace sunbeam {

// Returns 2 n1 d / lambda of each wavelength.
std::vector<double> fringe_orders(double film_ior, double thickness_nm, const Wavelengths& wavelengths);

class SlabSolver {
 public:
  // Says how finely the solver works.
  struct Resolution {
    int below = 12, above = 20;  // cosines up to the critical one of the film seen from below, and from there
    int across = 24, around = 24;  // facets of one direction: over the cap, and over half a turn
    double least = 3e-5;           // share of the phase function that may be left out
    // Modes of the azimuth are left out too if light scattered once is weaker in them than this share of its
    // mean, between any two of the cosines.
    double faintest = 0;
  };

  // This is the largest |mean cosine| of a scattering event that it solves.
  static constexpr double kMostForward = 0.75;

  static bool solves(const Material& material);

  // Serves this material with any film thickness and any optical depth that add_depth() has been given,
  // between directions of these cosines (> 0, outside).
  SlabSolver(const Material& material, std::vector<double> cosines, Resolution resolution);
  SlabSolver(const Material& material, std::vector<double> cosines)
      : SlabSolver(material, std::move(cosines), Resolution()) {}

  // Prepares the pigment at an optical depth of absorption. Many threads may call it, but not beside rest().
  void add_depth(double depth);

  // Holds what a film at one fringe order over a pigment of one depth sends back, 1/sr.
  struct Response {
    // For each mode this is the light that never reaches the base, between the cosines of wo and wi.
    std::vector<Matrix> slab;
    Vector arrived;  // at the base, from each cosine; times the root of s / pi
    double returned = 0;

    // Returns the light that reaches a base of this albedo, whatever the azimuth.
    double base(std::size_t a, std::size_t b, double albedo) const {
      return albedo / (1 - albedo * returned) * arrived[a] * arrived[b];
    }
  };

  // Prepares the film at some fringe orders 2 n1 d / lambda, at most kMostWavelengths; or any film at the
  // wavelengths of `phases`, of which nothing is kept.
  class Fringes {
   public:
    Fringes(const SlabSolver& solver, std::span<const double> orders);
    Fringes(const SlabSolver& solver, const walk::FilmPhases& phases);

    // Returns the response at the order or wavelength of this number. At an order it has the same bits
    // whatever other orders there are. Throws Error if the depth has not been added.
    Response response(std::size_t order, double depth) const;

   private:
    friend class SlabSolver;
    struct Mode {
      Matrix entry;        // E, by (cosine, to)
      Matrix thrown_back;  // F, by (to, from)
    };

    const SlabSolver& solver_;
    std::vector<std::vector<Mode>> modes_;  // by (order, mode)
  };

  // Holds the film, a layered one too, at one thickness and all wavelengths, for many depths.
  class Film {
   public:
    Film(const SlabSolver& solver, double film_thickness_nm, const Wavelengths& wavelengths);

    // Holds the Fourier modes of the rest, 1/sr, between cosines a (of wo) and b (of wi); at() sums them. The
    // optical depth is the pigment's absorption at 510 nm times its thickness. rest() throws Error if a depth
    // has not been added.
    class Modes {
     public:
      Rgb at(std::size_t a, std::size_t b, double azimuth) const;

     private:
      friend class Film;
      std::size_t cosines_ = 0;
      std::vector<std::vector<Rgb>> mode_;  // each over (a, b)
    };
    Modes rest(double optical_depth) const;

   private:
    Wavelengths wavelengths_;
    Fringes fringes_;
  };

  // Prepares the film, a layered one too, at one thickness and all wavelengths.
  Fringes fringes(double film_thickness_nm, const Wavelengths& wavelengths) const;

  // Returns the share of light along the cosine of this number that single films of these fringe orders, at
  // most kMostWavelengths, let in.
  std::vector<double> transmittances(std::span<const double> orders, std::size_t cosine) const;

  int modes() const { return modes_; }

 private:
  // Holds nodes and weights of the cosine below the film, and what values between them are made of.
  struct Nodes {
    std::vector<double> cosine, sine, root;  // root of M
    static constexpr int kStencil = 6;
    struct Stencil {
      int first;
      std::array<double, kStencil> weight;
    };
    int size() const { return static_cast<int>(cosine.size()); }
    Stencil at(double m) const;
  };
  // Describes a facet that light of one direction meets, and where the light goes on below the film.
  struct Facet {
    double cosine;   // at which the light meets it
    double share;    // of the light, shadowing included
    double azimuth;  // cosine of the azimuth of where it goes on
    int first_node;  // around the cosine of where it goes on
    // These are its parts in moments at these nodes, of even and odd modes.
    std::array<double, Nodes::kStencil> even, odd;
  };
  using FacetList = std::vector<Facet>;

  // Holds R and T between nodes, times the roots of M on both sides.
  struct Layer {
    std::vector<Matrix> reflection;  // per mode
    Matrix transmission;             // mode 0
  };
  // Holds a mode of the phase function between nodes, 1/sr: scattered on, and back.
  struct Phase {
    Matrix forward, backward;
  };

  static Nodes make_nodes(const Material& material, const Resolution& resolution);
  FacetList facets_of_entry(const Vec3& w) const;
  FacetList facets_thrown_back(int from) const;
  Facet facet(double cosine, double share, const Vec3& on) const;
  int modes_above(double faintest) const;
  enum class Part { reflectance, transmittance };
  std::vector<double> moments(const std::vector<FacetList>& rows, sunbeam::Side side, Part part,
                              const walk::FilmPhases& phases) const;
  Phase phase(int mode) const;
  Layer make_layer(double depth) const;
  void double_up(int mode, double depth, Matrix& r, Matrix& t) const;

  Material material_;
  FilmGeometry geometry_;
  walk::FilmSide film_, film_below_;  // as seen from outside and from below
  std::vector<double> cosines_;
  Resolution resolution_;
  Nodes nodes_;
  int terms_;                                   // of the phase function's Legendre series
  int modes_;                                   // of the azimuth
  std::vector<FacetList> entry_, thrown_back_;  // by cosine; by node
  std::map<double, Layer> layers_;
  std::mutex mutex_;  // guards layers_
};

}  // namespace sunbeam
