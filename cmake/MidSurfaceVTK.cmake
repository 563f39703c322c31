# The filters alone, as a library for C++ programs that use VTK.
find_package(VTK 9.1 REQUIRED COMPONENTS CommonCore CommonDataModel CommonExecutionModel)

vtk_module_scan(
  MODULE_FILES "${PROJECT_SOURCE_DIR}/plugin/filters/vtk.module"
  REQUEST_MODULES MidSurfaceFilters
  PROVIDES_MODULES modules
  HIDE_MODULES_FROM_CACHE ON)
vtk_module_build(
  MODULES ${modules}
  PACKAGE MidSurface
  INSTALL_EXPORT MidSurface
  CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/MidSurface"
  HEADERS_DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/MidSurface")
