# cmake -DNAME=name -DFROM=name.spv -DTO=name.spv.h -P embed.cmake: `const uint32_t NAME[]` of the words of a file.
file(READ ${FROM} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
file(WRITE ${TO} "const uint32_t ${NAME}[] = {${words}};\n")
