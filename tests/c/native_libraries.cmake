# Asks rustc which native libraries the static library needs, and fails where CMake's target
# (LINKED) and the C compiler's own (IMPLICIT) leave one out. The list does not depend on the
# profile, so the quickest build will do.
cmake_minimum_required(VERSION 3.16)

set(list_file "${TARGET_FOLDER}/native-static-libs.txt")
execute_process(
  COMMAND "${CARGO}" rustc --locked --quiet --package midsurface-capi --lib
    --manifest-path "${MANIFEST}" --target-dir "${TARGET_FOLDER}" --config profile.dev.debug=0
    -- --print "native-static-libs=${list_file}"
  RESULT_VARIABLE result
  ERROR_VARIABLE errors)
if (NOT result EQUAL 0)
  message(FATAL_ERROR "cargo failed: ${errors}")
endif ()
file(READ "${list_file}" needed)
string(STRIP "${needed}" needed)
separate_arguments(needed UNIX_COMMAND "${needed}")
if (NOT needed)
  message(FATAL_ERROR "rustc named no native library in ${list_file}")
endif ()

set(known ${LINKED} ${IMPLICIT})
foreach (flag IN LISTS needed)
  string(REGEX REPLACE "^-l" "" library "${flag}")
  if (NOT library IN_LIST known)
    message(FATAL_ERROR "${flag} is needed, but not linked; needed: ${needed}; linked: ${known}")
  endif ()
endforeach ()
message(STATUS "all linked: ${needed}")
