# Finds UMFPACK of SuiteSparse (Debian: libsuitesparse-dev, which ships no CMake configuration).
# Defines the target UMFPACK::UMFPACK.
include(FindPackageHandleStandardArgs)
find_path(UMFPACK_INCLUDE_DIR umfpack.h PATH_SUFFIXES suitesparse)
find_library(UMFPACK_LIBRARY umfpack)
find_library(UMFPACK_AMD_LIBRARY amd)
find_library(UMFPACK_CONFIG_LIBRARY suitesparseconfig)
if(UMFPACK_INCLUDE_DIR)
  file(STRINGS "${UMFPACK_INCLUDE_DIR}/umfpack.h" umfpack_numbers REGEX "^#define UMFPACK_(MAIN|SUB|SUBSUB)_VERSION ")
  string(REGEX MATCHALL "[0-9]+" UMFPACK_VERSION "${umfpack_numbers}")
  list(JOIN UMFPACK_VERSION "." UMFPACK_VERSION)
endif()
find_package_handle_standard_args(UMFPACK REQUIRED_VARS UMFPACK_LIBRARY UMFPACK_INCLUDE_DIR UMFPACK_AMD_LIBRARY
                                  UMFPACK_CONFIG_LIBRARY)
if(UMFPACK_FOUND AND NOT TARGET UMFPACK::UMFPACK)
  add_library(UMFPACK::UMFPACK INTERFACE IMPORTED)
  target_include_directories(UMFPACK::UMFPACK SYSTEM INTERFACE "${UMFPACK_INCLUDE_DIR}")
  target_link_libraries(UMFPACK::UMFPACK INTERFACE "${UMFPACK_LIBRARY}" "${UMFPACK_AMD_LIBRARY}"
                        "${UMFPACK_CONFIG_LIBRARY}")
endif()
