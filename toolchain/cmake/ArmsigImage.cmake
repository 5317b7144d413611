# SPDX-License-Identifier: MIT
# Images for bare metal.

# armsig_image(name BOARD board BUDGET file SOURCES sources... LIBRARIES libraries...): one flashable program. Its link
# map is searched for what must not be there and its size and stack are held against the budget: over it, the build fails.
function(armsig_image name)
  cmake_parse_arguments(image "" "BOARD;BUDGET;SCRIPT" "SOURCES;LIBRARIES" ${ARGN})
  set(board ${PROJECT_SOURCE_DIR}/toolchain/boards/${image_BOARD})
  if(NOT image_SCRIPT)
    set(image_SCRIPT ${board}/${image_BOARD}.ld)
  endif()
  add_executable(${name} ${image_SOURCES} ${board}/startup.cpp)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${image_LIBRARIES} armsig_warnings)
  # A linker script may include others of its board.
  file(GLOB scripts ${board}/*.ld)
  set_target_properties(${name} PROPERTIES SUFFIX .elf LINK_DEPENDS "${scripts};${image_BUDGET}")
  target_link_options(${name} PRIVATE
    -nostartfiles -L ${board} -T ${image_SCRIPT} -Wl,--gc-sections -Wl,-Map=${CMAKE_CURRENT_BINARY_DIR}/${name}.map
    -Wl,--fatal-warnings -Wl,--no-warn-rwx-segments)
  add_custom_command(TARGET ${name} POST_BUILD VERBATIM
    COMMAND ${PROJECT_SOURCE_DIR}/toolchain/check_image $<TARGET_FILE:${name}> ${image_BUDGET} ${PROJECT_BINARY_DIR}
    COMMENT "Checking ${name} against its budget")
endfunction()
