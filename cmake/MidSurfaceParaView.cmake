# The ParaView plugin. MIDSURFACE_PLUGIN is the file to load.
find_package(ParaView REQUIRED)

paraview_plugin_scan(
  PLUGIN_FILES "${PROJECT_SOURCE_DIR}/plugin/paraview.plugin"
  ENABLE_BY_DEFAULT ON
  PROVIDES_PLUGINS plugins
  REQUIRES_MODULES required_modules)
foreach (module IN LISTS required_modules)
  if (NOT TARGET "${module}")
    message(FATAL_ERROR "This ParaView lacks the module ${module}")
  endif ()
endforeach ()

paraview_plugin_build(
  RUNTIME_DESTINATION "${CMAKE_INSTALL_BINDIR}"
  LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  LIBRARY_SUBDIRECTORY "${PARAVIEW_PLUGIN_SUBDIR}"
  # A list that a ParaView, told of it in paraview.conf, loads the plugin by when it starts.
  PLUGINS_FILE_NAME "midsurface.plugins.xml"
  AUTOLOAD MidSurface
  INSTALL_HEADERS OFF
  PLUGINS_COMPONENT paraview_plugin
  TARGET_COMPONENT paraview_plugin
  PLUGINS ${plugins})

set(MIDSURFACE_PLUGIN
  "${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/${PARAVIEW_PLUGIN_SUBDIR}/MidSurface/MidSurface.so")
