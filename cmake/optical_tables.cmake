# This script writes the C++ source that holds the tables of optical constants of a folder:
#   cmake -D FOLDER=tables/optics -D OUTPUT=optical_tables.cpp -P cmake/optical_tables.cmake
# A table has comments, the line wavelength_nm,n,k and rows of three numbers; anything else stops the build.
cmake_minimum_required(VERSION 3.25)

set(number "[0-9]+\\.?[0-9]*(e[+-]?[0-9]+)?")
set(arrays "")
set(entries "")
file(GLOB files "${FOLDER}/*.csv")
list(SORT files)
foreach(file IN LISTS files)
  get_filename_component(name "${file}" NAME_WE)
  file(STRINGS "${file}" rows REGEX "^[^#]")
  list(POP_FRONT rows header)
  if(NOT header STREQUAL "wavelength_nm,n,k")
    message(FATAL_ERROR "${file}: found the first line '${header}'; allowed: wavelength_nm,n,k")
  endif()
  string(APPEND arrays "constexpr OpticalConstants k_${name}[] = {\n")
  foreach(row IN LISTS rows)
    if(NOT row MATCHES "^${number},${number},${number}$")
      message(FATAL_ERROR "${file}: found the row '${row}'; allowed: three numbers, as in 550,1.5,0.01")
    endif()
    string(APPEND arrays "    {${row}},\n")
  endforeach()
  string(APPEND arrays "};\n")
  string(APPEND entries "    {\"${name}\", k_${name}},\n")
endforeach()

file(WRITE "${OUTPUT}"
"#include \"bake/optics/dispersion/optical_tables.h\"

namespace sunbeam {
namespace {

${arrays}
constexpr OpticalTable kTables[] = {
${entries}};

}  // namespace

std::span<const OpticalTable> optical_tables() { return kTables; }

}  // namespace sunbeam
")
