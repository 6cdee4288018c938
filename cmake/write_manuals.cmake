# Asks the program (PROGRAM, through EMULATOR where that is set) for the manual pages of all its commands and for the
# completion of three shells, and writes them below FOLDER as they are installed.
execute_process(COMMAND ${EMULATOR} ${PROGRAM} help --format json OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
string(JSON n_commands LENGTH "${table}" commands)
math(EXPR last "${n_commands} - 1")

function(write file) # ARGUMENTS of conic help …
  execute_process(COMMAND ${EMULATOR} ${PROGRAM} help --format ${ARGN} OUTPUT_FILE ${FOLDER}/${file}
    COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${FOLDER}/man1)
file(MAKE_DIRECTORY ${FOLDER}/man1 ${FOLDER}/bash ${FOLDER}/zsh ${FOLDER}/fish)
write(man1/conic.1 man)
foreach(i RANGE ${last})
  string(JSON name GET "${table}" commands ${i} name)
  write(man1/conic-${name}.1 man ${name})
endforeach()
write(bash/conic bash)
write(zsh/_conic zsh)
write(fish/conic.fish fish)
