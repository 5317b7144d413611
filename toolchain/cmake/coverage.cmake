# Included by toolchain/coverage after project(): the branches of the libraries ARMSIG_COUNTED are counted, those of the
# tests not. Little is optimised, so that a branch of the source is one of the program.
function(armsig_count_branches)
  foreach(target ${ARMSIG_COUNTED})
    target_compile_options(${target} PRIVATE --coverage -O1 -fno-inline -fno-if-conversion -fno-if-conversion2)
    target_link_options(${target} INTERFACE --coverage)
  endforeach()
endfunction()
cmake_language(DEFER CALL armsig_count_branches)
