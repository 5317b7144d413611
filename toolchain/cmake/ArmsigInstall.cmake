# SPDX-License-Identifier: MIT
# What `cmake --install` puts where: the command with its manual page and completion, and core as a CMake package
# (find_package(armsig), armsig::core and armsig::analysis). `cpack -G DEB` makes Debian packages of the same.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS armsig RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES ${PROJECT_SOURCE_DIR}/docs/man/armsig.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${PROJECT_SOURCE_DIR}/toolchain/completion/armsig ${PROJECT_SOURCE_DIR}/toolchain/completion/armsigd
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${PROJECT_SOURCE_DIR}/toolchain/debian/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}
        FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg" PATTERN man EXCLUDE PATTERN examples EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/examples DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The public face: from ranges and sweeps to a signature and to poses. These headers and what they include, no others;
# included from the root of the project: "core/identification.hpp".
set(public_headers
  core/identification.hpp firmware/analysis/layout.hpp core/base/links.hpp
  core/measurement/ping_median.hpp core/measurement/speed_of_sound.hpp core/measurement/trilateration.hpp
  firmware/analysis/evaluation/fusion.hpp core/features/sweep_estimator.hpp core/frames/link_frames.hpp core/pseudo_dh/pseudo_dh.hpp
  firmware/analysis/postures/cold_start.hpp core/kinematics/inverse.hpp core/kinematics/s_model_chain.hpp)
set(found_headers "")
while(public_headers)
  list(POP_FRONT public_headers header)
  if(header IN_LIST found_headers)
    continue()
  endif()
  list(APPEND found_headers ${header})
  file(STRINGS ${PROJECT_SOURCE_DIR}/${header} includes REGEX "^#include \"(core|firmware/analysis)/")
  list(TRANSFORM includes REPLACE "^#include \"(.*)\"$" "\\1")
  list(APPEND public_headers ${includes})
endwhile()
foreach(header IN LISTS found_headers)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/armsig/${folder})
endforeach()
foreach(library core analysis)
  set_target_properties(armsig_${library} PROPERTIES EXPORT_NAME ${library})
endforeach()
target_compile_features(armsig_core PUBLIC cxx_std_23)
install(TARGETS armsig_core armsig_analysis EXPORT armsigTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/armsig)
install(EXPORT armsigTargets NAMESPACE armsig:: DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/armsigConfig.cmake.in
  ${PROJECT_BINARY_DIR}/armsigConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/armsigConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/armsigConfig.cmake ${PROJECT_BINARY_DIR}/armsigConfigVersion.cmake
        DESTINATION ${package_dir})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME armsig)
set(CPACK_PACKAGE_CONTACT "armsig maintainers <maintainers@armsig.example>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "finds the arm signature of a robot arm")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
# What belongs to no component is the command's and the controller's package.
set(CPACK_COMPONENTS_ALL Unspecified library development python)
if(ARMSIG_FLEET_BUILT)
  list(APPEND CPACK_COMPONENTS_ALL fleet)
endif()
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME armsig)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SECTION science)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_DEPENDS "systemd | systemd-standalone-sysusers | systemd-sysusers")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libarmsig1)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/toolchain/debian/triggers)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION
"A library that loads a signature: forward and inverse kinematics of the arm as
it was found, corrected targets for closed controllers, and uncertainty.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libarmsig-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libarmsig1 (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"The headers of libarmsig for C and C++, and its file for pkg-config.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-armsig)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy, libarmsig1 (= ${PROJECT_VERSION}), armsig (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION
"Identification, kinematics and corrected targets in Python, on arrays of numpy.")
set(CPACK_DEBIAN_FLEET_PACKAGE_NAME armsig-fleet)
set(CPACK_DEBIAN_FLEET_PACKAGE_SECTION science)
set(CPACK_DEBIAN_FLEET_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FLEET_PACKAGE_DEPENDS "systemd | systemd-standalone-sysusers | systemd-sysusers")
set(CPACK_DEBIAN_FLEET_PACKAGE_SUGGESTS "armsig, mosquitto, postgresql, prometheus")
set(CPACK_DEBIAN_FLEET_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/toolchain/debian/fleet/postinst)
set(CPACK_DEBIAN_FLEET_DESCRIPTION
"What the controllers of a plant report, kept in one record: armsig-node beside
each controller sends it, armsig-fleet on one host takes it and shows it.")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/toolchain/debian/postinst)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_UNSPECIFIED_DESCRIPTION
"Finds the actual kinematic parameters of one individual robot arm, from
measurements of points on it while its joints move, and exports them. With
armsigd, a controller that finds them by itself and servos with them.")
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/ArmsigPackage.cmake)
include(CPack)
