# The Debian package that `cpack` makes in the build folder: cmake --preset release, then cpack --config
# build/release/CPackConfig.cmake. Libraries are found by dpkg-shlibdeps (package dpkg-dev). At run time plugins are
# compiled: g++ is all that they need, tchat's headers use nothing but the standard library.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tchat)
set(CPACK_PACKAGE_VENDOR "tchat")
set(CPACK_PACKAGE_CONTACT "tchat <tchat@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "continuation of periodic orbits of hybrid dynamical systems")
set(CPACK_PACKAGE_DESCRIPTION
    "tchat follows periodic orbits of systems with impacts, friction and switching in\na parameter, with their Floquet multipliers, bifurcations and grazing points, and\nwrites files in the format of AUTO-07p.")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "tchat in Python\n Problems, branches and sweeps of tchat as objects with arrays of numpy.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Two packages: the component python, and the rest.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME tchat)
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-tchat)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "tchat (= ${PROJECT_VERSION}), python3, python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-matplotlib, jupyter-notebook")
set(CPACK_DEBIAN_PACKAGE_SECTION math)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_DEPENDS "g++ (>= 4:12), gnuplot-nox | gnuplot-qt | gnuplot-x11")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_RECOMMENDS make)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "gfortran, auto-07p, python3-tchat, gnuplot-qt")
include(CPack)

# In the package alone: python3 finds tchat by itself.
install(CODE "if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
  file(MAKE_DIRECTORY \"\$ENV{DESTDIR}/usr/lib/python3/dist-packages\")
  file(CREATE_LINK \"../../../share/tchat/python/tchat\" \"\$ENV{DESTDIR}/usr/lib/python3/dist-packages/tchat\" SYMBOLIC)
endif()" COMPONENT python)
