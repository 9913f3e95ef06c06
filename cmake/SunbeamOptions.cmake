# Language, output folders, warnings and optimisation shared by every target.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(PROJECT_IS_TOP_LEVEL)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
endif()

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

# GCC 12 has false alarms of -Wrestrict on std::string (bug 105651), GCC 13 and 14 of -Wdangling-reference on functions
# that take a temporary and return a reference to something else.
# errno and floating-point traps are never read; without them sqrt and friends inline.
# On Arm compilers would fuse multiplications with additions, and numbers would not be those of x86-64.
if(NOT MSVC)
  add_compile_options(-Wall -Wextra -Wpedantic -Wconversion -Wno-sign-conversion
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,13>>:-Wno-dangling-reference>
    -fno-math-errno -fno-trapping-math -ffp-contract=off)
endif()
# For code that reads, prints and arranges and computes nothing long: half the time to compile.
set(SUNBEAM_COLD_CODE $<$<CONFIG:Release>:-O1>)

option(SUNBEAM_WERROR "Treat warnings as errors" OFF)
if(SUNBEAM_WERROR)
  add_compile_options(-Werror)
endif()

if(SUNBEAM_FUZZ)
  set(SUNBEAM_SANITIZE ON)
  add_compile_options(-fsanitize=fuzzer-no-link)
  add_compile_definitions(FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION)
endif()
if(SUNBEAM_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
