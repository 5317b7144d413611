# SPDX-License-Identifier: MIT
# Compile settings that every target of the project shares, and those of code that also runs on the controller.

add_library(armsig_warnings INTERFACE)
target_compile_options(armsig_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wdouble-promotion -Wold-style-cast
  -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wformat=2 -Wimplicit-fallthrough -Wundef)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # What GCC means by -Wconversion.
  target_compile_options(armsig_warnings INTERFACE -Wno-sign-conversion)
endif()
if(ARMSIG_SANITIZE)
  # Branches are counted for the fuzzer. The check of dynamic types needs RTTI, which the controller's libraries are built
  # without. Warnings are the other builds' business.
  target_compile_options(armsig_warnings INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize=vptr -fno-sanitize-recover=all -fno-omit-frame-pointer
    -D_GLIBCXX_ASSERTIONS -w)
  target_link_options(armsig_warnings INTERFACE -fsanitize=address,undefined)
endif()
if(ARMSIG_SANITIZE_THREADS)
  target_compile_options(armsig_warnings INTERFACE -fsanitize=thread -fno-omit-frame-pointer)
  target_link_options(armsig_warnings INTERFACE -fsanitize=thread)
endif()

# GCC clears and copies structures of more than 128 bytes by "rep stos" and "rep movs" on x86-64: in the time that these
# take to start, the C library has done it, and the matrices here have a few hundred bytes.
include(CheckCXXCompilerFlag)
set(ARMSIG_STRING_OPERATIONS -mmemset-strategy=libcall:-1:noalign -mmemcpy-strategy=libcall:-1:noalign)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  check_cxx_compiler_flag("${ARMSIG_STRING_OPERATIONS}" ARMSIG_HAS_STRING_OPERATIONS)
  if(ARMSIG_HAS_STRING_OPERATIONS)
    target_compile_options(armsig_warnings INTERFACE ${ARMSIG_STRING_OPERATIONS})
  endif()
endif()

# armsig_harden(): what this folder adds is hardened, on Linux. A stack that was written over, and a copy beyond an object
# whose size the compiler knows, end the process instead of being used (the drives then stop by themselves); addresses of
# the linker can't be written; jumps end where functions begin. Programs that may be loaded anywhere are the compiler's
# default. Held by host_tests/toolchain/hardened. core does without: it takes values that hal and firmware have checked,
# reads nothing from outside, and is what every tick waits for.
set(ARMSIG_HARDENED OFF)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT ARMSIG_SANITIZE AND NOT ARMSIG_SANITIZE_THREADS)
  set(ARMSIG_HARDENED ON)
endif()
macro(armsig_harden)
  if(ARMSIG_HARDENED)
    add_compile_options(-fstack-protector-strong "$<$<CONFIG:Release>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>")
    if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
      add_compile_options(-fcf-protection)
    endif()
    add_link_options(-Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
  endif()
endmacro()

# armsig_controller_library(name sources...): code that must also run on bare metal:
# no exceptions, no RTTI, and no implicit use of a heap.
function(armsig_controller_library name)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/armsig>)
  target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti)
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:armsig_warnings>)
  if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
    # Images are built without a cache of objects; reading Eigen once halves the time.
    target_precompile_headers(${name} PRIVATE <Eigen/Dense> <algorithm> <expected> <optional> <span>)
  endif()
endfunction()

# armsig_command(variable target): what starts the program `target` in a test, in one word: its file, or one that runs
# it by the emulator where it is of another machine.
function(armsig_command variable target)
  if(NOT CMAKE_CROSSCOMPILING)
    set(${variable} $<TARGET_FILE:${target}> PARENT_SCOPE)
    return()
  endif()
  set(command ${CMAKE_CURRENT_BINARY_DIR}/emulated/${target})
  list(JOIN CMAKE_CROSSCOMPILING_EMULATOR " " emulator)
  file(GENERATE OUTPUT ${command} CONTENT "#!/bin/sh\nexec ${emulator} $<TARGET_FILE:${target}> \"$@\"\n"
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
  set(${variable} ${command} PARENT_SCOPE)
endfunction()
