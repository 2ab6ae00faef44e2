# Writes the texts of FILES (a list parted by commas) as raw string literals NAME_text into OUTPUT, in NAMESPACE.
set(header "#pragma once\n\n#include <string_view>\n\nnamespace ${NAMESPACE} {\n\n")
string(REPLACE "," ";" files "${FILES}")
foreach(entry ${files})
    string(REPLACE "=" ";" parts "${entry}")
    list(GET parts 0 name)
    list(GET parts 1 path)
    file(READ "${path}" text)
    string(APPEND header "inline constexpr char ${name}_text[] = R\"embedded(${text})embedded\";\n"
           "inline constexpr std::string_view ${name}{${name}_text, sizeof ${name}_text - 1};\n")
endforeach()
file(WRITE "${OUTPUT}" "${header}\n} // namespace ${NAMESPACE}\n")
