# Builds the Rust core behind its C interface and offers it as the target `midsurface_capi`.
#
# cargo decides what is out of date, so it runs in every build (a fraction of a second where nothing
# changed). Its target folder lies in the build tree, unless CARGO_TARGET_DIR is set in the
# environment when CMake configures.
find_program(CARGO_EXECUTABLE cargo REQUIRED HINTS "$ENV{CARGO_HOME}/bin" "$ENV{HOME}/.cargo/bin")

if (DEFINED ENV{CARGO_TARGET_DIR})
  get_filename_component(cargo_target_folder "$ENV{CARGO_TARGET_DIR}" ABSOLUTE
    BASE_DIR "${PROJECT_SOURCE_DIR}")
else ()
  set(cargo_target_folder "${PROJECT_BINARY_DIR}/cargo")
endif ()
set(capi_folder "${PROJECT_SOURCE_DIR}/rust/midsurface-capi")
set(capi_library "${cargo_target_folder}/release/libmidsurface_capi.a")

add_custom_target(midsurface_cargo
  COMMAND "${CARGO_EXECUTABLE}" build --locked --release --package midsurface-capi
    --manifest-path "${PROJECT_SOURCE_DIR}/Cargo.toml" --target-dir "${cargo_target_folder}"
  BYPRODUCTS "${capi_library}"
  COMMENT "Building the Rust core"
  USES_TERMINAL
  VERBATIM)

add_library(midsurface_capi STATIC IMPORTED GLOBAL)
add_dependencies(midsurface_capi midsurface_cargo)
set_target_properties(midsurface_capi PROPERTIES
  IMPORTED_LOCATION "${capi_library}"
  INTERFACE_INCLUDE_DIRECTORIES "${capi_folder}/include")
# What `rustc --print native-static-libs` asks for.
set(native_libraries gcc_s util rt pthread m dl)
target_link_libraries(midsurface_capi INTERFACE ${native_libraries})
# Rust's own symbols stay inside the library that links the core: two copies in one process clash.
# Among the libraries, not the options, since those end at a private link to a static library.
target_link_libraries(midsurface_capi INTERFACE "-Wl,--exclude-libs,libmidsurface_capi.a")

# For C programs: the library, its headers and what pkg-config tells about them.
file(RELATIVE_PATH prefix_from_pkgconfig "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")
string(REGEX REPLACE "([^;]+);?" "-l\\1 " native_flags "${native_libraries}")
string(STRIP "${native_flags}" native_flags)
configure_file("${PROJECT_SOURCE_DIR}/cmake/midsurface.pc.in"
  "${PROJECT_BINARY_DIR}/midsurface.pc" @ONLY)
install(FILES "${capi_library}"
  DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT c_library)
install(FILES "${capi_folder}/include/midsurface.h" "${capi_folder}/include/midsurface.hpp"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT c_library)
install(FILES "${PROJECT_BINARY_DIR}/midsurface.pc"
  DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT c_library)
