# SPDX-License-Identifier: MIT
include_guard()
include(GNUInstallDirs)

# armsig_install_unit(name arguments of install()...): NAME.in, a unit of systemd whose paths are those of where it is installed:
# known when it is, since `cmake --install --prefix` and cpack take another prefix than the build. The build has it too, for tests.
function(armsig_install_unit file)
  get_filename_component(name ${file} NAME)
  configure_file(${file}.in ${name} @ONLY)
  install(CODE "
    get_filename_component(prefix \"\${CMAKE_INSTALL_PREFIX}\" ABSOLUTE)
    set(CMAKE_INSTALL_FULL_SBINDIR \"\${prefix}/${CMAKE_INSTALL_SBINDIR}\")
    set(CMAKE_INSTALL_FULL_DOCDIR \"\${prefix}/${CMAKE_INSTALL_DOCDIR}\")
    file(INSTALL DESTINATION \"\${prefix}/lib/systemd/system\" TYPE FILE RENAME ${name}
         FILES \"${CMAKE_CURRENT_SOURCE_DIR}/${file}.in\")
    configure_file(\"${CMAKE_CURRENT_SOURCE_DIR}/${file}.in\" \"\$ENV{DESTDIR}\${prefix}/lib/systemd/system/${name}\" @ONLY)"
    ${ARGN})
endfunction()
