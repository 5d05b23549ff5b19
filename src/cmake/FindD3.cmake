# Finds D3, version 3 (Debian: libjs-d3), which pages of `tchat plot -o FILE.html` have in them. Defines D3_SCRIPT, the
# path of the minified library.
include(FindPackageHandleStandardArgs)
find_file(D3_SCRIPT d3.min.js PATHS /usr/share/javascript/d3 PATH_SUFFIXES javascript/d3)
if(D3_SCRIPT)
  file(READ "${D3_SCRIPT}" d3_head LIMIT 200)
  string(REGEX MATCH "version:\"([0-9.]+)\"" d3_match "${d3_head}")
  set(D3_VERSION "${CMAKE_MATCH_1}")
endif()
find_package_handle_standard_args(D3 REQUIRED_VARS D3_SCRIPT VERSION_VAR D3_VERSION HANDLE_VERSION_RANGE)
