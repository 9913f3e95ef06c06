// Recipes of factored tables of layered films, drawn at random over what such tables hold.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "sunbeam/detail/text.h"
#include "tests/support/random_materials.h"

namespace sunbeam::test {

enum class FilmKind { clear, absorbing, metal, dispersive, spread };

inline constexpr std::array kFilmKinds{FilmKind::clear, FilmKind::absorbing, FilmKind::metal,
                                       FilmKind::dispersive, FilmKind::spread};

constexpr const char* name_of(FilmKind kind) {
  switch (kind) {
    case FilmKind::clear:
      return "clear";
    case FilmKind::absorbing:
      return "absorbing";
    case FilmKind::metal:
      return "metal";
    case FilmKind::dispersive:
      return "dispersive";
    default:
      return "spread";
  }
}

struct LayeredRecipe {
  FilmKind kind;
  std::string text;
};

class RandomLayeredRecipes : private Draws {
 public:
  using Draws::Draws;

  // Kinds take turns. Every fourth recipe is of full spectra; every eighth has the path "product", at one
  // film thickness and one optical depth.
  LayeredRecipe draw(int number) {
    kind_ = kFilmKinds[static_cast<std::size_t>(number) % kFilmKinds.size()];
    is_full_ = number % 4 == 2;
    is_product_ = number % 8 == 3 && kind_ != FilmKind::metal;
    const std::string film = draw_film(), surface = draw_surface(), base = draw_base();
    return {kind_, "[material]\n" + surface + base + film + "[grid]\n" + draw_grid() +
                       "[spectrum]\nmode = \"" + (is_full_ ? "full" : "rgb3") +
                       "\"\n[table]\nencoding = \"factored\"\n[accuracy]\nnoise = 0.003\n"};
  }

 private:
  static constexpr double kPigmentNm = 2;

  static std::string line(const std::string& key, const std::string& value) {
    return key + " = " + value + "\n";
  }
  static std::string line(const std::string& key, double value) { return line(key, rounded(value)); }
  static std::string rounded(double x) { return to_text(std::round(1e4 * x) / 1e4); }
  template <std::size_t Count>
  std::string one_of(const std::array<const char*, Count>& names) {
    return "\"" + std::string(names[static_cast<std::size_t>(Count * rng_.uniform())]) + "\"";
  }

  // One to 16 layers in all, those of clear films two or more; fewer where a film is evaluated at many
  // wavelengths or thicknesses.
  std::string draw_film() {
    constexpr int kMostLayers = 16, kFewLayers = 8;
    const int most = is_full_ || kind_ == FilmKind::spread ? kFewLayers : kMostLayers,
              least = kind_ == FilmKind::clear ? 2 : 1;
    const int periods = chance(0.5) ? 1 + static_cast<int>(most / 2 * rng_.uniform()) : 1;
    const int layers = std::max(least, 1 + static_cast<int>(most / periods * rng_.uniform()));
    std::string text = line("film_periods", periods);
    if (kind_ == FilmKind::spread) text += line("thickness_spread", between(0.02, 0.2));
    thickness_nm_ = 0;
    for (int j = 0; j < layers; ++j) text += draw_layer();
    thickness_nm_ *= periods;
    return text;
  }

  // Dielectrics, dark ones, and now and then a metal of a few nanometres.
  std::string draw_layer() {
    const bool is_dark = kind_ == FilmKind::absorbing || (kind_ >= FilmKind::metal && chance(0.3));
    const bool is_leaf = is_dark && chance(0.1), is_dispersive = kind_ == FilmKind::dispersive && chance(0.7);
    const double nm = std::round(is_leaf ? between(4, 15) : between(40, 140));
    thickness_nm_ += nm;
    const std::string text = "[[material.film]]\n" + line("thickness_nm", nm);
    if (is_dispersive) return text + line("ior", draw_dispersive_index());
    if (is_leaf) return text + line("ior", between(0.1, 1)) + line("extinction", between(1, 4));
    const double extinction = is_dark && chance(0.7) ? logarithmic(1e-3, 0.3) : 0;
    return text + line("ior", between(1.3, 2.5)) + line("extinction", extinction);
  }

  std::string draw_dispersive_index() {
    if (chance(0.3))
      return "{cauchy = [" + rounded(between(1.3, 2.2)) + ", " + rounded(between(2000, 30000)) + "]}";
    return one_of(
        std::array{"chitin", "keratin", "melanin", "silica", "titania", "niobia", "magnesium_fluoride"});
  }

  std::string draw_surface() {
    const bool is_smooth = chance(0.25), is_anisotropic = chance(0.2);
    const auto width = [&] { return rounded(logarithmic(0.03, 0.4)); };
    std::string roughness = is_smooth ? "0" : width();
    if (!is_smooth && is_anisotropic) roughness = "[" + roughness + ", " + width() + "]";
    exterior_ior_ = chance(0.25) ? 1.33 : 1;
    return line("roughness", roughness) + line("exterior_ior", exterior_ior_) +
           line("transmission", chance(0.4) ? "\"straight\"" : "\"refract\"");
  }

  // Under a liquid often one of lower index.
  std::string draw_base() {
    if (kind_ == FilmKind::metal) return draw_metal();
    is_base_constant_ = kind_ != FilmKind::dispersive || chance(0.5);
    std::string text = is_base_constant_ ? line("base_ior", between(1.2, exterior_ior_ > 1 ? 1.5 : 1.9))
                                         : line("base_ior", draw_clear_base());
    optical_depth_ = chance(0.3) ? 0 : between(0, is_product_ ? 0.3 : 1);
    return text + line("absorption_path", is_product_ ? "\"product\"" : "\"sum\"") +
           line("absorption_per_nm", optical_depth_ / kPigmentNm) + line("pigment_thickness_nm", kPigmentNm) +
           "albedo = [" + rounded(rng_.uniform()) + ", " + rounded(rng_.uniform()) + ", " +
           rounded(rng_.uniform()) + "]\n";
  }
  std::string draw_clear_base() {
    return one_of(std::array{"chitin", "silica", "water", "magnesium_fluoride"});
  }

  std::string draw_metal() {
    if (chance(0.6)) return line("base_ior", one_of(std::array{"Ag", "Al", "Au", "Cu", "Fe", "Nb", "Ti"}));
    return line("base_ior", between(0.1, 3)) + line("base_extinction", logarithmic(0.1, 5));
  }

  // Films of other thickness, other bases, more or less pigment: a third of the time each.
  std::string draw_grid() {
    if (is_product_) return "";
    std::string text;
    if (chance(0.33))
      text += "film_thickness_nm = {from = " + rounded(0.8 * thickness_nm_) +
              ", to = " + rounded(1.2 * thickness_nm_) + ", count = 2}\n";
    if (kind_ == FilmKind::metal) return text;
    if (is_base_constant_ && chance(0.25)) text += "base_ior = {from = 1.2, to = 1.8, count = 8}\n";
    if (chance(0.33)) text += "absorption_per_nm = {from = 0, to = 0.5, count = 10}\n";
    return text;
  }

  FilmKind kind_ = FilmKind::clear;
  bool is_full_ = false, is_product_ = false, is_base_constant_ = true;
  double thickness_nm_ = 0, exterior_ior_ = 1, optical_depth_ = 0;
};

}  // namespace sunbeam::test
