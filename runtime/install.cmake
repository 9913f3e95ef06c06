# Installation: what an embedder takes, for find_package(sunbeam) and pkg-config. The tracer stays at home.
# Components: runtime, the shared library; dev, headers, archives and package files; command, the program.
include(CMakePackageConfigHelpers)
set(SUNBEAM_CMAKE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/sunbeam")
# find_package() takes the parents of PATH for prefixes; in a folder of this name it does not look.
set(package_files "${PROJECT_BINARY_DIR}/package_files")

set(SUNBEAM_HAS_VDB ${SUNBEAM_BUILD_VDB})
if(BUILD_SHARED_LIBS)
  install(TARGETS sunbeam_shared EXPORT sunbeamTargets
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT runtime NAMELINK_COMPONENT dev)
  set(pkg_config_cflags "-DSUNBEAM_SHARED")
  set(pkg_config_libs "-lsunbeam")
else()
  set_target_properties(sunbeam_core PROPERTIES EXPORT_NAME core)
  set_target_properties(sunbeam_table PROPERTIES EXPORT_NAME table)
  install(TARGETS sunbeam_core sunbeam_table EXPORT sunbeamTargets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT dev)
  set(pkg_config_libs "-lsunbeam_table -lsunbeam_core")
  set(pkg_config_requires "Requires: OpenEXR Imath")
  if(SUNBEAM_BUILD_VDB)
    set_target_properties(sunbeam_table_vdb PROPERTIES EXPORT_NAME table_vdb)
    install(TARGETS sunbeam_table_vdb EXPORT sunbeamVdbTargets
      ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT dev)
    install(EXPORT sunbeamVdbTargets NAMESPACE sunbeam:: DESTINATION "${SUNBEAM_CMAKE_DIR}" COMPONENT dev)
  endif()
endif()
install(EXPORT sunbeamTargets NAMESPACE sunbeam:: DESTINATION "${SUNBEAM_CMAKE_DIR}" COMPONENT dev)

install(DIRECTORY include/sunbeam DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev
  FILES_MATCHING PATTERN "*.h" PATTERN "table_vdb.h" EXCLUDE)
if(SUNBEAM_BUILD_VDB)
  install(FILES include/sunbeam/table_vdb.h DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/sunbeam" COMPONENT dev)
endif()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/sunbeamConfig.cmake.in"
  "${package_files}/sunbeamConfig.cmake" INSTALL_DESTINATION "${SUNBEAM_CMAKE_DIR}")
write_basic_package_version_file("${package_files}/sunbeamConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH pkg_config_include "/${CMAKE_INSTALL_LIBDIR}" "/${CMAKE_INSTALL_INCLUDEDIR}")
configure_file("${PROJECT_SOURCE_DIR}/cmake/sunbeam.pc.in" "${package_files}/sunbeam.pc" @ONLY)
install(FILES "${package_files}/sunbeamConfig.cmake" "${package_files}/sunbeamConfigVersion.cmake"
  DESTINATION "${SUNBEAM_CMAKE_DIR}" COMPONENT dev)
install(FILES "${package_files}/sunbeam.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT dev)
