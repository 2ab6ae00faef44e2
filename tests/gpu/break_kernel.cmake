# cmake -DSHADERS=DIR -DINTO=DIR -DGLSLANG=PROGRAM -DNAME=name -DPATTERN=glob -DFROM=text -DTO=text -DVARIANTS=one+other
#       -P break_kernel.cmake
# Copies the shaders, replaces a text in those that match, and compiles variants of the kernels to INTO/NAME_VARIANT.spv.h:
# f32, f32_packed, f32_exact and f64 of field.comp, mesh_f32, ... of mesh_field.comp, KERNEL_f32, ... of others.
# An error if nothing was replaced: a break that no longer breaks would go unseen.
string(REPLACE "\\n" "\n" TO "${TO}") # no build tool takes a line break in an argument
file(REMOVE_RECURSE ${INTO}/${NAME})
file(COPY ${SHADERS}/ DESTINATION ${INTO}/${NAME})
file(GLOB_RECURSE sources ${INTO}/${NAME}/${PATTERN})
set(replaced FALSE)
foreach(source IN LISTS sources)
    file(READ ${source} text)
    string(REPLACE "${FROM}" "${TO}" broken "${text}")
    if(NOT broken STREQUAL text)
        set(replaced TRUE)
        file(WRITE ${source} "${broken}")
    endif()
endforeach()
if(NOT replaced)
    message(FATAL_ERROR "the break \"${NAME}\" finds \"${FROM}\" nowhere in ${PATTERN}: the kernel's text changed; "
                        "adapt the break in tests/gpu/CMakeLists.txt")
endif()
string(REPLACE "+" ";" VARIANTS ${VARIANTS})
foreach(variant IN LISTS VARIANTS)
    set(definitions)
    if(variant STREQUAL "f32_packed")
        set(definitions -DFS_PACKED)
    elseif(variant MATCHES "exact")
        set(definitions -DFS_EXACT)
    elseif(variant MATCHES "f64")
        set(definitions -DFS_F64)
    endif()
    string(REGEX REPLACE "_?f(32|64)(_packed|_exact)?$" "" kernel ${variant})
    if(kernel STREQUAL "")
        set(kernel field)
    elseif(kernel STREQUAL "mesh")
        set(kernel mesh_field)
    endif()
    execute_process(
        COMMAND ${GLSLANG} -V --quiet --target-env vulkan1.1 -S comp -I${INTO}/${NAME} ${definitions}
                --vn ${NAME}_${variant} -o ${INTO}/${NAME}_${variant}.spv.h ${INTO}/${NAME}/${kernel}.comp
        COMMAND_ERROR_IS_FATAL ANY)
endforeach()
