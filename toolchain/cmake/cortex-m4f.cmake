# SPDX-License-Identifier: MIT
# Cortex-M4 with a single-precision FPU; the emulated board is the Arm MPS2 with image AN386.
set(ARMSIG_CPU_FLAGS "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard -mthumb")
set(ARMSIG_OPTIMISATION -O3)
set(ARMSIG_BOARD mps2)
set(ARMSIG_SELFTEST selftest_m4f)
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
