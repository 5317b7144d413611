# SPDX-License-Identifier: MIT
# Common to every bare-metal ARM target: Debian's arm-none-eabi GCC with newlib. Included by cortex-*.cmake, which set
# ARMSIG_CPU_FLAGS and ARMSIG_OPTIMISATION.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_AR arm-none-eabi-gcc-ar)
set(CMAKE_RANLIB arm-none-eabi-gcc-ranlib)
# A program needs our linker script, which the compiler's own check does not have.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

# Eigen is headers only: the host's package serves. Programs are the host's, libraries the target's.
set(CMAKE_PREFIX_PATH /usr)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)

set(CMAKE_CXX_FLAGS_INIT
    "${ARMSIG_CPU_FLAGS} -ffunction-sections -fdata-sections -fno-exceptions -fno-rtti -fno-threadsafe-statics")
string(APPEND CMAKE_CXX_FLAGS_INIT " -Wno-psabi -fno-unwind-tables -fno-asynchronous-unwind-tables -fcallgraph-info=su")
# The call graph is written beside each object, where a cache of objects would lose it.
set(CMAKE_CXX_COMPILER_LAUNCHER "" CACHE STRING "")
# Fused multiply-add where there is one; what must give the same numbers everywhere forbids it for itself.
string(APPEND CMAKE_CXX_FLAGS_INIT " -ffp-contract=fast")
# Not _INIT, to which CMake would append its own -O3.
set(CMAKE_CXX_FLAGS_RELEASE "${ARMSIG_OPTIMISATION} -DNDEBUG" CACHE STRING "")
