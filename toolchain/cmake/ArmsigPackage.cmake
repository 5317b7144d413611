# SPDX-License-Identifier: MIT
# What Debian wants of a package and an installation need not have: manual pages compressed, and a changelog in Debian's form.
# Run by cpack (CPACK_PRE_BUILD_SCRIPTS) over what it has installed into its own folder.
find_program(GZIP gzip REQUIRED)
file(GLOB_RECURSE pages ${CPACK_TEMPORARY_DIRECTORY}/usr/share/man/*.[0-9])
set(changelog ${CPACK_TEMPORARY_DIRECTORY}/usr/share/doc/armsig/changelog)
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${changelog}
  "armsig (${CPACK_PACKAGE_VERSION}) unstable; urgency=low\n\n"
  "  * As CHANGELOG.md of the sources says.\n\n"
  " -- ${CPACK_PACKAGE_CONTACT}  ${now}\n")
foreach(file ${pages} ${changelog})
  execute_process(COMMAND ${GZIP} -9n ${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
