# Installs into a folder of its own and runs what is there, away from the build.
# -DBUILD=FOLDER -DTO=FOLDER [-DPYTHON=PROGRAM]
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
# A tetrahedron to mesh, and a capture of what was meshed: the libraries are found too.
file(WRITE ${TO}/body.obj "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
file(WRITE ${TO}/capture.yaml [==[
hookeye: 1
units: {length: mm, force: N}
body: {volume: body.vtu}
model: {material: {law: neo-hookean, mu: 0.05, kappa: 0.5}, fit: [mu]}
regions:
  base: {box: [[-1, -1, -0.1], [11, 11, 0.1]]}
  top: {sphere: {center: [0, 0, 10], radius: 1}}
examples:
  pull:
    supports: [{region: base, fix: [x, y, z]}]
    loads: [{region: top, force: [0, 0, 0.001]}]
    measured: [{position_of: [0, 0, 10], value: [0, 0, 10.02], sigma: 0.1}]
]==])
foreach(expected "0 --version" "0 --help" "2 check nowhere" "0 mesh body.obj -o body.vtu --edge 3"
    "0 check capture.yaml" "0 simulate capture.yaml -o out" "0 fit capture.yaml -o run")
  separate_arguments(words UNIX_COMMAND "${expected}")
  list(POP_FRONT words right)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH ${TO}/bin/hookeye ${words}
    WORKING_DIRECTORY ${TO} RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if(NOT status EQUAL right)
    message(FATAL_ERROR "the installed hookeye ${words} ends with ${status}, not ${right}")
  endif()
endforeach()
foreach(file out/deformed/pull.vtu run/steps/00-base/metrics.json)
  if(NOT EXISTS ${TO}/${file})
    message(FATAL_ERROR "the installed hookeye has not written ${file}")
  endif()
endforeach()
# The module finds the helper programs from where it lies.
set(packages ${TO}/lib/python3/dist-packages)
file(GLOB module ${packages}/hookeye/_hookeye*.so)
if(module)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${packages} ${PYTHON} -c
    "import hookeye as he; he.fit(he.Capture('.'), out='python-run')"
    WORKING_DIRECTORY ${TO} RESULT_VARIABLE status ERROR_VARIABLE said)
  if(NOT status EQUAL 0 OR NOT EXISTS ${TO}/python-run/steps/00-base/metrics.json)
    message(FATAL_ERROR "the installed module does not fit: ${said}")
  endif()
endif()
file(REMOVE_RECURSE ${TO})
