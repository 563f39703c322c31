# The filters alone, as a library for programs that use VTK: `find_package(MidSurface)` finds it and
# offers it as MidSurface::MidSurface. Where this VTK has Python, as the package `midsurface` as well.
include(CMakePackageConfigHelpers)

find_package(VTK 9.1 REQUIRED
  COMPONENTS CommonCore CommonDataModel CommonExecutionModel ParallelCore
  OPTIONAL_COMPONENTS WrappingPythonCore)

set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/MidSurface")
vtk_module_scan(
  MODULE_FILES "${PROJECT_SOURCE_DIR}/plugin/filters/vtk.module"
  REQUEST_MODULES MidSurfaceFilters
  PROVIDES_MODULES modules
  HIDE_MODULES_FROM_CACHE ON)
vtk_module_build(
  MODULES ${modules}
  PACKAGE MidSurface
  INSTALL_EXPORT MidSurface
  VERSION "${PROJECT_VERSION}"
  SOVERSION "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}"
  CMAKE_DESTINATION "${package_folder}"
  HEADERS_DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/MidSurface")

configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/MidSurfaceConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/${package_folder}/MidSurfaceConfig.cmake"
  INSTALL_DESTINATION "${package_folder}"
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(
  "${PROJECT_BINARY_DIR}/${package_folder}/MidSurfaceConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(
  FILES
    "${PROJECT_BINARY_DIR}/${package_folder}/MidSurfaceConfig.cmake"
    "${PROJECT_BINARY_DIR}/${package_folder}/MidSurfaceConfigVersion.cmake"
  DESTINATION "${package_folder}"
  COMPONENT development)

if (TARGET VTK::WrapPython)
  vtk_module_wrap_python(
    MODULES ${modules}
    TARGET MidSurfacePython
    PYTHON_PACKAGE midsurface
    MODULE_DESTINATION "${VTK_PYTHONPATH}"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    SOABI "${Python3_SOABI}"
    INSTALL_HEADERS OFF)
  configure_file("${PROJECT_SOURCE_DIR}/cmake/python_package.py.in"
    "${PROJECT_BINARY_DIR}/${VTK_PYTHONPATH}/midsurface/__init__.py" @ONLY)
  install(
    FILES "${PROJECT_BINARY_DIR}/${VTK_PYTHONPATH}/midsurface/__init__.py"
    DESTINATION "${VTK_PYTHONPATH}/midsurface"
    COMPONENT python)
else ()
  message(STATUS "VTK's Python wrapping tools were not found: no Python package")
endif ()
