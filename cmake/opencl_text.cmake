# Makes of the text TEXT the C source SOURCE, which defines conic_opencl_NAME_text.
file(READ ${TEXT} hex HEX)
string(LENGTH "${hex}" n_digits)
math(EXPR n_bytes "${n_digits} / 2")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
string(REGEX REPLACE "(0x0a,)" "\\1\n" bytes "${bytes}") # line by line
file(WRITE ${SOURCE} "#include \"opencl/program.h\"\n\nstatic const char bytes[] = {\n${bytes}0};\n\n"
  "const conic_opencl_text conic_opencl_${NAME}_text = {\"${NAME}\", bytes, ${n_bytes}};\n")
