# SPDX-License-Identifier: MIT
# What Debian wants of a package and an installation need not have: manual pages and notes compressed, a notice and a changelog in
# Debian's form, units without the folder where the package is made. Run by cpack (CPACK_PRE_BUILD_SCRIPTS) over what it has installed, each
# component in a folder of its own.
find_program(GZIP gzip REQUIRED)
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr)
  file(GLOB units ${root}/lib/systemd/system/*.service)
  foreach(unit IN LISTS units)
    file(READ ${unit} text)
    string(REPLACE "${CPACK_TEMPORARY_DIRECTORY}/${component}/" "/" text "${text}")
    file(WRITE ${unit} "${text}")
  endforeach()
  file(GLOB_RECURSE pages ${root}/share/man/*.[0-9])
  file(WRITE ${root}/share/doc/${package}/changelog
    "${package} (${CPACK_PACKAGE_VERSION}) unstable; urgency=low\n\n"
    "  * As CHANGELOG.md of the sources says.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${now}\n")
  file(COPY ${CMAKE_CURRENT_LIST_DIR}/../debian/copyright DESTINATION ${root}/share/doc/${package})
  foreach(file ${pages} ${root}/share/doc/${package}/changelog)
    execute_process(COMMAND ${GZIP} -9n ${file} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endforeach()
