# cmake --install build/release --prefix DIR, and the Debian package (cpack).
include(GNUInstallDirs)

# Made from the declared options and parameters, like the files in the repository.
set(manual ${CMAKE_CURRENT_BINARY_DIR}/sigmaflow.1)
set(completion ${CMAKE_CURRENT_BINARY_DIR}/sigmaflow.bash)
add_custom_command(OUTPUT ${manual} ${completion}
  COMMAND sigmaflow man > ${manual}
  COMMAND sigmaflow completion bash > ${completion}
  DEPENDS sigmaflow VERBATIM)
add_custom_target(manual ALL DEPENDS ${manual} ${completion})

install(TARGETS sigmaflow)
install(FILES ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${completion} RENAME sigmaflow
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES workflow.schema.json quickstart.json DESTINATION ${CMAKE_INSTALL_DATADIR}/sigmaflow)
install(DIRECTORY examples paper DESTINATION ${CMAKE_INSTALL_DATADIR}/sigmaflow
  FILES_MATCHING PATTERN "*.json" PATTERN "*.csv" PATTERN gallery EXCLUDE)
install(FILES reference.md README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_CONTACT "the sigmaflow developers <sigmaflow@localhost>")
set(CPACK_DEBIAN_FILE_NAME sigmaflow.deb)  # the version is inside; scripts need no pattern
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# opened at run time: fonts, and OpenGL without a display
set(CPACK_DEBIAN_PACKAGE_DEPENDS
  "fonts-dejavu-core, fonts-dejavu-extra, libegl1, libegl-mesa0, libgl1-mesa-dri")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
  "dense frictional suspensions sheared at an imposed stress
 Shears spheres with lubrication, friction and repulsion in Stokes flow at an imposed shear
 stress, as a JSON workflow file says, and writes numbers with error bars, pictures and ParaView
 files. No display is needed.")
include(CPack)
