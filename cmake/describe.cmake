# cmake -DSOURCE=FOLDER -DOUT=FILE -P describe.cmake: which state of the sources is built, into a header
# that is only touched where it has changed. From git; a source archive (./release) carries it in the
# file `described`. Where neither tells, it is empty.
cmake_minimum_required(VERSION 3.25)
set(told "")
if(EXISTS ${SOURCE}/described)
  file(STRINGS ${SOURCE}/described told LIMIT_COUNT 1)
elseif(EXISTS ${SOURCE}/.git)  # not of a repository that the folder merely lies in
  execute_process(COMMAND git -C ${SOURCE} describe --tags --match v[0-9]* --always --dirty
    OUTPUT_VARIABLE told OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT told MATCHES "^[A-Za-z0-9._+~-]+$")
  set(told "")
endif()
set(text "#define HOOKEYE_DESCRIBED \"${told}\"\n")
set(before "")
if(EXISTS ${OUT})
  file(READ ${OUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUT} "${text}")
endif()
