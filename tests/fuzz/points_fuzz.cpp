// Points of `sunbeam eval`: CSV, its columns and the numbers in its cells.
#include <cmath>
#include <cstdlib>

#include "bake/check/point_columns.h"
#include "tests/fuzz/support.h"

namespace {

using namespace sunbeam;

void read_all(const Csv& csv, Quantity quantity) {
  const PointColumns columns(csv, quantity);
  for (std::size_t k = 0; k < csv.rows.size(); ++k) {
    const Point point = columns.point(k);
    const bool is_sound = point.wi.z > 0 && point.wo.z > 0 && !columns.material(k, Material()).defect();
    if (!is_sound || (point.wavelength_nm && !std::isfinite(*point.wavelength_nm))) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return test::fuzz(data, size, [](const std::string& bytes) {
    const Csv csv = parse_csv(bytes, "p");
    std::string again = csv_line(csv.header) + "\n";
    for (const CsvRow& row : csv.rows) again += csv_line(row.cells) + "\n";
    // A single column of empty cells is lost as empty lines.
    if (csv.header.size() > 1 && parse_csv(again, "again").rows.size() != csv.rows.size()) std::abort();
    for (const Quantity quantity : {Quantity::brdf, Quantity::albedo}) read_all(csv, quantity);
  });
}
