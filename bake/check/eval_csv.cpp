#include "bake/check/eval_csv.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <set>

#include "bake/check/csv.h"
#include "bake/check/film_points.h"
#include "bake/check/point_columns.h"
#include "bake/check/walked_mean.h"
#include "bake/live/exact/exact.h"
#include "bake/live/pfmc.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/layered_film.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam {
namespace {

// One result: a colour (three columns, or one where monochromatic) or a single number.
struct Result {
  const char* name;
  Rgb value;
  bool is_scalar = false;
};
using Results = std::vector<Result>;

// The rows of a live recipe at one material, by PFMC or exactly.
class LivePoint {
 public:
  LivePoint(const Material& material, const Wavelengths& wavelengths, const Point& point,
            const PointsSettings& settings)
      : point_(point),
        samples_(settings.samples),
        model_(material, wavelengths),
        technique_(technique_of(settings.estimator)),
        rng_(settings.seed, point.stream) {
    if (settings.estimator == Estimator::exact && settings.quantity != Quantity::film)
      exact_.emplace(material, wavelengths);
  }

  Results brdf() {
    const WalkedMean rest = exact_ ? WalkedMean{exact_->rest(point_.wo, point_.wi), Rgb()} : walked_rest();
    return {{"first", model_.first(point_.wo, point_.wi)},
            {"rest", rest.value},
            {"stderr", rest.standard_error},
            {"pdf", walked_pdf(), true},
            {"dirac", model_.dirac(point_.wi)}};
  }

  Results albedo() {
    const WalkedMean total = exact_ ? WalkedMean{exact_->albedo(point_.wi), Rgb()} : walked_albedo();
    return {{"total", total.value}, {"stderr", total.standard_error}};
  }

  Results film() const { return {{"reflectance", model_.film_reflectance(point_.wi.z)}}; }

 private:
  WalkedMean walked_rest() {
    return walked_mean(samples_,
                       [&] { return model_.estimate_rest(point_.wo, point_.wi, rng_, technique_); });
  }
  Rgb walked_pdf() {
    return walked_mean(samples_, [&] { return Rgb(model_.estimate_pdf(point_.wo, point_.wi, rng_)); }).value;
  }

  // The Dirac part exactly, everything else from walks.
  WalkedMean walked_albedo() {
    WalkedMean total = walked_mean(samples_, [&] {
      const auto sample = model_.sample(point_.wi, rng_);
      return sample && !sample->is_dirac ? sample->throughput : Rgb();
    });
    total.value += model_.dirac(point_.wi);
    return total;
  }

  Point point_;
  std::int64_t samples_;
  Pfmc model_;
  Technique technique_;
  std::optional<ExactRest> exact_;
  Rng rng_;
};

// The reflectance of a film that the live model tabulates, in closed form.
Results layered_film(const Material& material, const Wavelengths& wavelengths, const Point& point) {
  const StackSpectrum film = stack_spectrum(material, wavelengths);
  std::vector<double> above(film.lanes()), through(film.lanes()), below(film.lanes());
  film.powers(material.exterior_ior, point.wi.z, above.data(), through.data(), below.data());
  return {{"reflectance", wavelengths.fold(above)}};
}

Results live_results(const Material& material, const Wavelengths& wavelengths, const Point& point,
                     const PointsSettings& settings) {
  if (settings.quantity == Quantity::film && is_layered(material, wavelengths))
    return layered_film(material, wavelengths, point);
  LivePoint live(material, wavelengths, point, settings);
  if (settings.quantity == Quantity::brdf) return live.brdf();
  return settings.quantity == Quantity::albedo ? live.albedo() : live.film();
}

Results table_results(const TableBsdf& bsdf, const Point& point, Quantity quantity) {
  if (quantity == Quantity::film) return {{"reflectance", bsdf.film_reflectance(point.wi.z)}};
  if (quantity == Quantity::albedo) return {{"total", bsdf.albedo(point.wi)}, {"stderr", Rgb()}};
  return {{"first", bsdf.first(point.wo, point.wi)},
          {"rest", bsdf.rest(point.wo, point.wi)},
          {"stderr", bsdf.rest_stderr(point.wo, point.wi)},
          {"pdf", Rgb(bsdf.mis_pdf(point.wo, point.wi)), true},
          {"dirac", bsdf.dirac(point.wi)}};
}

// The channel of an rgb3 table that holds this wavelength.
int table_channel(const Csv& csv, const CsvRow& row, double wavelength_nm) {
  const std::vector<double> nm = Wavelengths::rgb3({}).nm;
  const auto at = std::find(nm.begin(), nm.end(), wavelength_nm);
  if (at != nm.end()) return static_cast<int>(at - nm.begin());
  throw Error(fmt::format("{}:{}: column 'wavelength_nm': found {:g}; this table holds {:g}", csv.name,
                          row.line, wavelength_nm, fmt::join(nm, ", ")));
}

void append(std::string& line, const Results& results, std::optional<int> channel) {
  for (const Result& result : results) {
    if (result.is_scalar || channel)
      line += fmt::format(",{:.17g}", result.value[result.is_scalar ? 0 : *channel]);
    else
      line += fmt::format(",{:.17g},{:.17g},{:.17g}", result.value.r, result.value.g, result.value.b);
  }
}

// Evaluates every row in parallel and prints them in order; nothing is printed if any row is bad. Every block
// of rows has its own copy of `results`, which may remember what the rows share.
template <class RowResults>
void print_rows(const Csv& csv, const PointColumns& reader, Quantity quantity, std::ostream& out,
                const RowResults& results) {
  std::vector<std::string> lines(csv.rows.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, csv.rows.size()), [&](const auto& block) {
    RowResults block_results = results;
    for (std::size_t k = block.begin(); k < block.end(); ++k) {
      const auto [values, channel] = block_results(k);
      lines[k] = csv_line(csv.rows[k].cells);
      append(lines[k], values, channel);
    }
  });
  out << fmt::format("{},{}\n", csv_line(csv.header),
                     fmt::join(result_names(quantity, reader.is_monochromatic()), ","));
  for (const auto& line : lines) out << line << '\n';
}

using RowAndChannel = std::pair<Results, std::optional<int>>;

// Material and wavelengths of the rows of a live recipe.
class LiveRows {
  template <class Call>
  auto naming_row(std::size_t k, Call call) const {
    try {
      return call();
    } catch (const Error& error) {
      throw Error(fmt::format("{}:{}: {}", csv_.name, csv_.rows[k].line, error.what()));
    }
  }

 public:
  LiveRows(const Material& material, const Spectrum& spectrum, const Csv& csv, const PointColumns& reader)
      : material_(material), spectrum_(spectrum), csv_(csv), reader_(reader) {}

  Material material(std::size_t k) const {
    Material row = reader_.material(k, material_);
    if (csv_.column("albedo")) row.albedo = spectrum_.from_rec709(row.albedo);
    return row;
  }

  Wavelengths wavelengths(std::size_t k) const {
    const auto nm = reader_.point(k).wavelength_nm;
    const Material row = material(k);
    return naming_row(k, [&] { return nm ? spectrum_.monochromatic(row, *nm) : spectrum_.wavelengths(row); });
  }

  // What `wanted` stands for in this row.
  Estimator estimator(std::size_t k, Estimator wanted) const {
    return naming_row(k, [&] { return estimator_for_eval(wanted, material(k)); });
  }

 private:
  const Material& material_;
  const Spectrum& spectrum_;
  const Csv& csv_;
  const PointColumns& reader_;
};

// Rows of a table. Binding it to parameters costs far more than a look-up, and rows mostly share theirs.
class TableRows {
 public:
  TableRows(const Table& table, const Csv& csv, const PointColumns& reader, Quantity quantity)
      : table_(table), csv_(csv), reader_(reader), quantity_(quantity) {}

  RowAndChannel operator()(std::size_t k) {
    const Point point = reader_.point(k);
    std::optional<int> channel;
    if (point.wavelength_nm) channel = table_channel(csv_, csv_.rows[k], *point.wavelength_nm);
    bind(k, Parameters::of(reader_.material(k, table_.material)));
    return {table_results(*bsdf_, point, quantity_), channel};
  }

 private:
  void bind(std::size_t k, const Parameters& parameters) {
    if (bsdf_ && Parameters::of(bsdf_->material()).values() == parameters.values()) return;
    try {
      bsdf_ = std::make_shared<TableBsdf>(table_, parameters);
    } catch (const Error& error) {
      throw Error(fmt::format("{}:{}: {}", csv_.name, csv_.rows[k].line, error.what()));
    }
  }

  const Table& table_;
  const Csv& csv_;
  const PointColumns& reader_;
  Quantity quantity_;
  std::shared_ptr<const TableBsdf> bsdf_;
};

}  // namespace

// Numbers of Material say nothing where the recipe has a design in their place.
void refuse_designed(const Csv& csv, const FilmDesign& film) {
  const auto refuse = [&](const char* key, const char* owner) {
    if (csv.column(key))
      throw Error(
          fmt::format("{}: column '{}': {}; allowed: another recipe, or --set", csv.name, key, owner));
  };
  if (!film.layers.empty()) refuse("film_ior", "the layers of the recipe's film have indices of their own");
  if (!film.base) return;
  for (const char* key : {"base_ior", "base_extinction"})
    refuse(key, "the recipe's base has an index over the wavelength");
}

PointsReport evaluate_points_live(const Material& material, const Spectrum& spectrum, const Csv& csv,
                                  const PointsSettings& settings, std::ostream& out) {
  const PointColumns reader(csv, settings.quantity);
  if (holds_film_points(csv, settings.quantity)) {
    evaluate_film_points(material, spectrum.film(), csv, out);
    return {{}, reader.unused()};
  }
  refuse_designed(csv, spectrum.film());
  const LiveRows rows(material, spectrum, csv, reader);
  std::set<std::string> used;
  for (std::size_t k = 0; k < csv.rows.size(); ++k) {
    rows.wavelengths(k);
    used.insert(name_of(rows.estimator(k, settings.estimator)));
  }
  print_rows(csv, reader, settings.quantity, out, [&](std::size_t k) -> RowAndChannel {
    const Point point = reader.point(k);
    PointsSettings of_row = settings;
    of_row.estimator = rows.estimator(k, settings.estimator);
    return {live_results(rows.material(k), rows.wavelengths(k), point, of_row),
            point.wavelength_nm ? std::optional(0) : std::nullopt};
  });
  return {used, reader.unused()};
}

PointsReport evaluate_points_table(const Table& table, const Csv& csv, const PointsSettings& settings,
                                   std::ostream& out) {
  const PointColumns reader(csv, settings.quantity);
  if (holds_film_points(csv, settings.quantity))
    throw Error(csv.name + ": column 'layers' is evaluated by a recipe, not by a table");
  for (const std::size_t k : reader.material_columns())
    if (std::find(kParameterNames.begin(), kParameterNames.end(), csv.header[k]) == kParameterNames.end())
      throw Error(fmt::format("{}: column '{}' is fixed in a table; a table's row may set {}", csv.name,
                              csv.header[k], fmt::join(kParameterNames, ", ")));
  if (reader.is_monochromatic() && table.is_full_spectrum())
    throw Error(csv.name +
                ": column 'wavelength_nm': the table's spectrum is \"full\", so it holds folded colours, no "
                "wavelengths; evaluate its recipe instead");
  print_rows(csv, reader, settings.quantity, out, TableRows(table, csv, reader, settings.quantity));
  return {{}, reader.unused()};
}

}  // namespace sunbeam
