# Finds SLICOT (Debian: libslicot-dev), used for the periodic QZ algorithm. Defines the target SLICOT::SLICOT.
include(FindPackageHandleStandardArgs)
find_library(SLICOT_LIBRARY slicot)
find_package_handle_standard_args(SLICOT REQUIRED_VARS SLICOT_LIBRARY)
if(SLICOT_FOUND AND NOT TARGET SLICOT::SLICOT)
  find_package(LAPACK REQUIRED)
  add_library(SLICOT::SLICOT INTERFACE IMPORTED)
  target_link_libraries(SLICOT::SLICOT INTERFACE "${SLICOT_LIBRARY}" LAPACK::LAPACK)
endif()
