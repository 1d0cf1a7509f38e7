# Runs scripts/make_pages.py. A failure is a warning: the build continues without pages.
#
# usage: cmake -D python=PYTHON -D script=FILE -D program=FILE -D folder=DIR -P make_pages.cmake
execute_process(COMMAND ${python} ${script} ${program} ${folder}
    RESULT_VARIABLE result ERROR_VARIABLE error)
if(NOT result STREQUAL 0)
    message(WARNING "No manual page and no completions: ${script} failed (${result}).\n${error}")
endif()
