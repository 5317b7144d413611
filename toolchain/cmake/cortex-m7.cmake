# SPDX-License-Identifier: MIT
# Cortex-M7 with a double-precision FPU; the emulated board is the Arm MPS2 with image AN500.
set(ARMSIG_CPU_FLAGS "-mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard -mthumb")
set(ARMSIG_OPTIMISATION -O3)
set(ARMSIG_BOARD mps2)
set(ARMSIG_SELFTEST selftest_m7)
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
