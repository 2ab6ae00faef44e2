# Optimisation levels and precompiled headers. Without forceshade_compile a target has
# CMake's own -O3 and no precompiled headers, as what calls CGAL must: its flags are others.

# ccache sees what a precompiled header holds by -fpch-preprocess; clang's hold their build folder's path, and would not
# fit another clone.
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES ccache)
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
        add_compile_options(-fpch-preprocess)
    else()
        set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
    endif()
endif()
set(standard_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <span> <string>
    <string_view> <vector> <fmt/format.h>)

# GCC 12 turns double(float(x)) of neighbouring members into x, which single precision must not be (mesh_files_test
# fails without this at -O2),
set(exact_rounding -fno-tree-slp-vectorize)
# and with precompiled headers it sees overruns of std::string that are none (its bug 105329).
set(false_alarms -Wno-array-bounds -Wno-restrict -Wno-stringop-overread -Wno-stringop-overflow)

# forceshade_headers(NAME LEVEL LINK target ... HEADERS <header> ...)
function(forceshade_headers name level)
    cmake_parse_arguments(ARG "" "" "LINK;HEADERS" ${ARGN})
    set(target forceshade_headers_${name}_O${level})
    file(WRITE ${PROJECT_BINARY_DIR}/headers/${name}.cpp "")
    add_library(${target} OBJECT ${PROJECT_BINARY_DIR}/headers/${name}.cpp)
    target_link_libraries(${target} PRIVATE fmt::fmt ${ARG_LINK})
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O${level}>)
    if(level EQUAL 2)
        target_compile_options(${target} PRIVATE ${exact_rounding})
    endif()
    target_precompile_headers(${target} PRIVATE ${standard_headers} ${ARG_HEADERS})
endfunction()
forceshade_headers(plain 1)
forceshade_headers(plain 2)
forceshade_headers(plain 3)
if(NOT FORCESHADE_LIBRARY_ONLY)
    forceshade_headers(json 1 LINK nlohmann_json::nlohmann_json HEADERS <nlohmann/json.hpp>)
endif()

# forceshade_compile(LEVEL HEADERS target ...): -O3 for the oracle, the mesh and the live loop, where benchmarks show a
# difference (the plan of a mesh's field takes 2.5 times as long at -O2), -O1 where run time does not matter, -O2 elsewhere.
function(forceshade_compile level headers)
    foreach(target ${ARGN})
        target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O${level}> ${false_alarms})
        if(level EQUAL 2)
            target_compile_options(${target} PRIVATE ${exact_rounding})
        endif()
        target_compile_definitions(${target} PRIVATE FMT_SHARED) # as in the precompiled headers
        target_precompile_headers(${target} REUSE_FROM forceshade_headers_${headers}_O${level})
    endforeach()
endfunction()
