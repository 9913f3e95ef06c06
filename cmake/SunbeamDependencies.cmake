# Third-party libraries, all from Debian 12 or 13 (see cmake/setup.sh for the package names).
include(GNUInstallDirs)

find_package(Imath 3.1 CONFIG REQUIRED)
find_package(OpenEXR 3.1 CONFIG REQUIRED)

if(SUNBEAM_BUILD_TRACER OR SUNBEAM_BUILD_BAKE)
  find_package(fmt 9.0 CONFIG REQUIRED)
  find_package(tomlplusplus 3.3 CONFIG REQUIRED)
  find_package(TBB 2021.8 CONFIG REQUIRED COMPONENTS tbb)
  find_package(embree 4 CONFIG QUIET)
  if(NOT embree_FOUND)
    find_package(embree 3.13 CONFIG REQUIRED)
  endif()
  add_library(sunbeam_embree INTERFACE)
  target_link_libraries(sunbeam_embree INTERFACE embree)
  target_compile_definitions(sunbeam_embree INTERFACE SUNBEAM_EMBREE_MAJOR=${embree_VERSION_MAJOR})
  find_package(nlohmann_json 3.11 CONFIG REQUIRED)
  find_package(PNG REQUIRED)
endif()

if(SUNBEAM_BUILD_VDB)
  block()  # FindOpenVDB leaks BUILD_SHARED_LIBS, and its folder shadows FindTBB and FindOpenEXR
    list(PREPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
    find_package(OpenVDB 10.0 MODULE REQUIRED COMPONENTS openvdb)
  endblock()
  # Boost before 1.81, behind OpenVDB, casts beyond an enumeration, which Clang 16 to 19 take for an error.
  target_compile_options(OpenVDB::openvdb INTERFACE
    $<$<AND:$<CXX_COMPILER_ID:Clang>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,20>>:-Wno-enum-constexpr-conversion>)
endif()

if(SUNBEAM_BUILD_BAKE)
  find_package(CLI11 2.1 CONFIG REQUIRED)
  if(SUNBEAM_BUILD_TESTS)
    find_package(benchmark 1.7 CONFIG REQUIRED)
  endif()
endif()

if(SUNBEAM_BUILD_TESTS)
  find_package(GTest 1.12 CONFIG REQUIRED)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
endif()
