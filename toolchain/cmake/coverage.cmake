# SPDX-License-Identifier: MIT
# Included by toolchain/coverage after project(): branches are counted of what counted.txt names, in the libraries and, of
# their headers, in the tests too, because which of the copies of an inline function runs is the linker's choice.
set(CMAKE_CXX_FLAGS_RELEASE "-O1")
add_compile_options(-fprofile-instr-generate -fcoverage-mapping "-fprofile-list=${CMAKE_CURRENT_LIST_DIR}/counted.txt")
add_link_options(-fprofile-instr-generate)
