# cmake -DSHADERS=DIR -DINTO=DIR -DGLSLANG=PROGRAM -DNAME=name -DPATTERN=glob -DFROM=text -DTO=text -P break_kernel.cmake
# Copies the shaders, replaces a text in those that match, and compiles field.comp to INTO/NAME_{f32,f32_packed,f64}.spv.h
# mesh_field.comp to INTO/NAME_mesh_{f32,f64}.spv.h and path.comp to INTO/NAME_path_{f32,f64}.spv.h.
# An error if nothing was replaced: a break that no longer breaks would go unseen.
string(REPLACE "\\n" "\n" TO "${TO}") # no build tool takes a line break in an argument
file(REMOVE_RECURSE ${INTO}/${NAME})
file(COPY ${SHADERS}/ DESTINATION ${INTO}/${NAME})
if(NOT FROM STREQUAL "")
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
endif()
foreach(variant f32 f32_packed f64 mesh_f32 mesh_f64 path_f32 path_f64)
    set(definitions)
    set(kernel field.comp)
    if(variant STREQUAL "f32_packed")
        set(definitions -DFS_PACKED)
    elseif(variant MATCHES "f64")
        set(definitions -DFS_F64)
    endif()
    if(variant MATCHES "mesh")
        set(kernel mesh_field.comp)
    elseif(variant MATCHES "path")
        set(kernel path.comp)
    endif()
    execute_process(
        COMMAND ${GLSLANG} -V --quiet --target-env vulkan1.1 -S comp -I${INTO}/${NAME} ${definitions}
                --vn ${NAME}_${variant} -o ${INTO}/${NAME}_${variant}.spv.h ${INTO}/${NAME}/${kernel}
        COMMAND_ERROR_IS_FATAL ANY)
endforeach()
