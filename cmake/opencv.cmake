# hookeye_opencv(PART...): OpenCV::PART from libopencv-PART-dev. OpenCV's own configuration comes with
# all of OpenCV alone, which brings Qt, ffmpeg and Java.
find_path(OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
file(STRINGS ${OPENCV_INCLUDE}/opencv2/core/version.hpp OpenCV_VERSION
     REGEX "define CV_VERSION_(MAJOR|MINOR|REVISION) ")
string(REGEX REPLACE "[^0-9;]" "" OpenCV_VERSION "${OpenCV_VERSION}")
string(REPLACE ";" "." OpenCV_VERSION "${OpenCV_VERSION}")

function(hookeye_opencv)
  foreach(part IN LISTS ARGN)
    if(TARGET OpenCV::${part})
      continue()
    endif()
    find_library(OPENCV_${part}_LIBRARY opencv_${part} REQUIRED)
    add_library(OpenCV::${part} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(OpenCV::${part} PROPERTIES
      IMPORTED_LOCATION ${OPENCV_${part}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE})
  endforeach()
endfunction()
