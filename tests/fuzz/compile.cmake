# How the libraries are compiled for the fuzz targets: their edges counted, assertions on, and sanitized: addresses, and of
# what is undefined the arithmetic, which costs little; the rest of it would make the build half as long again.
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    message(FATAL_ERROR "libFuzzer is clang's: -DCMAKE_CXX_COMPILER=clang++")
endif()
if(NOT CMAKE_BUILD_TYPE STREQUAL Fuzz)
    message(FATAL_ERROR "the fuzz targets have flags of their own: -DCMAKE_BUILD_TYPE=Fuzz")
endif()
set(FORCESHADE_SANITIZE
    address,bounds,shift,signed-integer-overflow,integer-divide-by-zero,float-cast-overflow,bool,enum,return,unreachable
    CACHE STRING "" FORCE)
set(CMAKE_CXX_FLAGS_FUZZ "-O1 -gline-tables-only -D_GLIBCXX_ASSERTIONS")
add_compile_options(-fsanitize=fuzzer-no-link -fno-sanitize-recover=all -Wno-unknown-warning-option -Wno-missing-braces)
