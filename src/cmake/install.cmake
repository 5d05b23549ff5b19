# What `cmake --install` puts where: the program with its pages for man and the completion of shells, the plugin headers
# (the program looks for them in ../include beside its own folder), the README and the pages, the problems with their
# constants, a package so that find_package(tchat) gives tchat::plugin and tchat::core, and the commands of TC-HAT in a folder of their
# own: AUTO-07p has commands of the same names.
include(CMakePackageConfigHelpers)

install(TARGETS tchat)
file(GLOB tc_hat_commands CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/scripts/@*")
install(PROGRAMS ${tc_hat_commands} DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/tchat")
install(FILES scripts/tc-hat DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/tchat")
install(FILES README.md LICENSE TYPE DOC)
# The pages lie as in the source tree, with a link to the problems, so that their links and those of the README hold.
install(DIRECTORY src/docs DESTINATION "${CMAKE_INSTALL_DOCDIR}/src" FILES_MATCHING PATTERN "*.md" PATTERN "library/*"
        PATTERN "gallery/*" PATTERN "notebooks/*.ipynb")
install(CODE "file(CREATE_LINK \"../../tchat/problems\"
  \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}/problems\" SYMBOLIC)")
install(TARGETS tchat_plugin EXPORT tchatPlugin FILE_SET HEADERS)
# The library with the headers of its rooms, for programs that compute without the executable.
install(TARGETS tchat_core ARCHIVE)
foreach(room ${core_rooms})
  install(DIRECTORY "src/${room}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/tchat-core" FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(DIRECTORY problems constants DESTINATION "${CMAKE_INSTALL_DATADIR}/tchat"
        PATTERN "*.so" EXCLUDE PATTERN "*.o" EXCLUDE PATTERN "*~" EXCLUDE)

install(FILES src/completion/tchat.bash DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" RENAME tchat)
install(FILES src/completion/_tchat DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions")

# The program itself writes its pages for man, from its help.
set(manual_folder "${PROJECT_BINARY_DIR}/manual")
add_custom_command(OUTPUT "${manual_folder}/tchat.1" COMMAND tchat manual "${manual_folder}" DEPENDS tchat VERBATIM)
add_custom_target(tchat_manual ALL DEPENDS "${manual_folder}/tchat.1")
install(DIRECTORY "${manual_folder}/" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" FILES_MATCHING PATTERN "*.1")

# find_package(tchat) gives tchat::plugin, which depends on nothing; with COMPONENTS core also tchat::core.
set(package_folder "${CMAKE_INSTALL_DATADIR}/cmake/tchat")
install(EXPORT tchatPlugin NAMESPACE tchat:: DESTINATION "${package_folder}")
configure_package_config_file(src/cmake/tchatConfig.cmake.in "${PROJECT_BINARY_DIR}/tchatConfig.cmake"
                              INSTALL_DESTINATION "${package_folder}"
                              PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_INCLUDEDIR)
install(FILES "${PROJECT_BINARY_DIR}/tchatConfig.cmake" src/cmake/FindUMFPACK.cmake DESTINATION "${package_folder}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/tchatConfigVersion.cmake" COMPATIBILITY SameMajorVersion
                                 ARCH_INDEPENDENT)
install(FILES "${PROJECT_BINARY_DIR}/tchatConfigVersion.cmake" DESTINATION "${package_folder}")
