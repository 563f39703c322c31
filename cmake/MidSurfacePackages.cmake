# Debian packages: `cpack -G DEB` in a build for ParaView makes the plugin's; in a build for VTK
# those of the library, of what is needed to develop with it, of Python and of the C library.
#
# Each package is a group of CPack's, made of the install components `components_<group>`.
set(soname_version "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
if (MIDSURFACE_BUILD_PARAVIEW_PLUGIN)
  set(package_groups paraview)
else ()
  set(package_groups library development python c)
endif ()

set(CPACK_DEBIAN_PARAVIEW_PACKAGE_NAME midsurface-paraview)
set(components_paraview paraview_plugin)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME "libmidsurface${soname_version}")
set(components_library runtime)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libmidsurface-dev)
set(components_development development)
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-midsurface)
set(components_python python)
set(CPACK_DEBIAN_C_PACKAGE_NAME libmidsurface-c-dev)
set(components_c c_library)

set(CPACK_COMPONENTS_ALL)
foreach (group IN LISTS package_groups)
  string(TOUPPER "${group}" upper_group)
  string(TOUPPER "${components_${group}}" upper_component)
  set("CPACK_COMPONENT_${upper_component}_GROUP" "${group}")
  list(APPEND CPACK_COMPONENTS_ALL "${components_${group}}")
  install(FILES "${PROJECT_SOURCE_DIR}/LICENSE"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper_group}_PACKAGE_NAME}"
    RENAME copyright
    COMPONENT "${components_${group}}")
endforeach ()

set(what "Mid-surfaces of segmented membranes")
set(more "A segmented volume in, a triangle mesh midway between the faces of every membrane out, with
the membrane's thickness at every point.")
set(CPACK_DEBIAN_PARAVIEW_DESCRIPTION "${what}: ParaView plugin
${more}
Adds the menu Filters > Mid-Surface to ParaView, and the filters to pvpython, pvbatch and pvserver,
whenever they start.")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "${what}: library for VTK
${more}")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "${what}: library for VTK, development files
${more}
For C++: find_package(MidSurface).")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${what}: Python package for VTK
${more}
For Python: from midsurface import vtkMidSurfaceFilter.")
set(CPACK_DEBIAN_C_DESCRIPTION "${what}: library for C, development files
${more}
For C and C++ without VTK: pkg-config midsurface.")

# Beside the libraries that the programs say they are linked with, found by dpkg-shlibdeps.
set(CPACK_DEBIAN_PARAVIEW_PACKAGE_RECOMMENDS "python3-paraview")
set(same_version "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libmidsurface${soname_version} ${same_version}, libmidsurface-c-dev ${same_version}, libvtk9-dev")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "libmidsurface${soname_version} ${same_version}, python3-vtk9, python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}), python3 (<< ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}.99)")
set(CPACK_DEBIAN_C_PACKAGE_DEPENDS "libc6-dev")

set(plugin_list
  "/usr/${CMAKE_INSTALL_LIBDIR}/${PARAVIEW_PLUGIN_SUBDIR}/midsurface.plugins.xml")
foreach (script IN ITEMS postinst prerm)
  configure_file("${PROJECT_SOURCE_DIR}/cmake/debian/paraview/${script}.in"
    "${PROJECT_BINARY_DIR}/debian/${script}" @ONLY)
  list(APPEND CPACK_DEBIAN_PARAVIEW_PACKAGE_CONTROL_EXTRA "${PROJECT_BINARY_DIR}/debian/${script}")
  list(APPEND CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    "${PROJECT_SOURCE_DIR}/cmake/debian/python/${script}")
endforeach ()

set(CPACK_PACKAGE_NAME midsurface)
set(CPACK_PACKAGE_CONTACT "The MidSurface authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_GENERATE_SHLIBS ON)
# Where Python's module finds the library before that is a package.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_LIBRARY_OUTPUT_DIRECTORY}")
include(CPack)
