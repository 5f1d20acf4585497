# Installs into a folder of its own and runs what is there, away from the build.
# -DBUILD=FOLDER -DTO=FOLDER
file(REMOVE_RECURSE ${TO})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${TO} RESULT_VARIABLE status
  OUTPUT_QUIET)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "cmake --install ends with ${status}")
endif()
foreach(file share/doc/hookeye/LICENSE share/doc/hookeye/README.md)
  if(NOT EXISTS ${TO}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
foreach(expected "0 --version" "0 --help" "2 check nowhere")
  separate_arguments(words UNIX_COMMAND "${expected}")
  list(POP_FRONT words right)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH ${TO}/bin/hookeye ${words}
    WORKING_DIRECTORY ${TO} RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if(NOT status EQUAL right)
    message(FATAL_ERROR "the installed hookeye ${words} ends with ${status}, not ${right}")
  endif()
endforeach()
file(REMOVE_RECURSE ${TO})
