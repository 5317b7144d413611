# SPDX-License-Identifier: MIT
# Cortex-R5F of a Zynq UltraScale+, double-precision FPU; the emulated board is the ZCU102.
set(ARMSIG_CPU_FLAGS "-mcpu=cortex-r5 -mfpu=vfpv3-d16 -mfloat-abi=hard -mthumb")
set(ARMSIG_OPTIMISATION -Os)  # the image runs from on-chip memory
set(ARMSIG_BOARD r5f)
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
