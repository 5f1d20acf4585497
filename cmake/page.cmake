# The page (studio/) built by Vite and turned into an object that is linked into the program:
# hookeye_page(TARGET). Without Node.js the program still builds, and `hookeye report` says why it
# cannot work. A source archive (./release) carries the page built, in studio/built: then neither
# Node.js nor a network is asked.
set(HOOKEYE_PAGE "" CACHE FILEPATH "A built page (page.html), to be taken as it is")
find_program(NODE NAMES node nodejs)
find_program(NPM npm)

# Sets NPM_COMMAND in the caller: the machine's npm, else one file of the registry that the page's
# packages come from too. Debian's npm brings 360 packages.
function(hookeye_npm)
  set(NPM_COMMAND ${NPM} PARENT_SCOPE)
  if(NPM OR NOT NODE)
    return()
  endif()
  set(version 9.9.4)
  set(hash
    37371088ba6a0ee2e16af772276277b4627f9e2fde6dca87545664bf50b8ffa9
    5b96b6943db3e0089e1585be286b71458516b6623f60039f23187ff3b4ab9e35)
  list(JOIN hash "" hash)
  set(folder ${CMAKE_BINARY_DIR}/npm-${version})
  if(NOT EXISTS ${folder}/package/bin/npm-cli.js)
    message(STATUS "Fetching npm ${version}")
    file(DOWNLOAD https://registry.npmjs.org/npm/-/npm-${version}.tgz ${folder}.tgz STATUS status)
    file(SHA512 ${folder}.tgz got)
    if(NOT got STREQUAL hash)
      message(WARNING "npm ${version} could not be fetched: ${status}")
      return()
    endif()
    file(ARCHIVE_EXTRACT INPUT ${folder}.tgz DESTINATION ${folder})
  endif()
  set(NPM_COMMAND ${NODE} ${folder}/package/bin/npm-cli.js PARENT_SCOPE)
endfunction()

# Sets PAGE_FILE in the caller: the page that is given, or that the archive carries; empty: neither.
function(hookeye_given_page)
  set(page "${HOOKEYE_PAGE}")
  if(page AND NOT EXISTS ${page})
    message(FATAL_ERROR "HOOKEYE_PAGE: there is no file ${page}")
  elseif(NOT page AND EXISTS ${CMAKE_SOURCE_DIR}/studio/built/page.html)
    set(page ${CMAKE_SOURCE_DIR}/studio/built/page.html)
  endif()
  set(PAGE_FILE "${page}" PARENT_SCOPE)
endfunction()

# Builds OUT/page.html from studio/; sets PAGE_BUILT in the caller, empty where it cannot be.
function(hookeye_build_page out)
  set(PAGE_BUILT "" PARENT_SCOPE)
  hookeye_npm()
  if(NOT NODE OR NOT NPM_COMMAND)
    message(WARNING "node or npm is not there: 'hookeye report' and 'hookeye studio' will not work "
                    "(install the packages of packages.txt and configure again)")
    return()
  endif()
  set(PAGE_BUILT ON PARENT_SCOPE)
  set(source ${CMAKE_SOURCE_DIR}/studio)
  file(GLOB_RECURSE inputs CONFIGURE_DEPENDS ${source}/src/*)
  # Types are checked, and a browser is driven, where there are tests.
  set(omit --omit=dev)
  set(check_types "")
  if(HOOKEYE_TESTS)
    set(omit "")
    set(check_types COMMAND ${NPM_COMMAND} run --silent types)
  endif()
  set(fetched ${CMAKE_BINARY_DIR}/page-packages${omit})
  add_custom_command(
    OUTPUT ${fetched}
    COMMAND ${NPM_COMMAND} install --no-save --no-audit --no-fund --loglevel=error ${omit}
    COMMAND ${CMAKE_COMMAND} -E touch ${fetched}
    DEPENDS ${source}/package.json ${source}/package-lock.json
    WORKING_DIRECTORY ${source}
    COMMENT "Fetching what the page is built with")
  add_custom_command(
    OUTPUT ${out}/page.html
    ${check_types}
    COMMAND ${NPM_COMMAND} run --silent build -- --outDir ${out} --logLevel warn
    DEPENDS ${inputs} ${source}/page.html ${source}/vite.config.ts ${source}/tsconfig.json
            ${fetched}
    WORKING_DIRECTORY ${source}
    COMMENT "Building the page")
endfunction()

function(hookeye_page target)
  set(out ${CMAKE_BINARY_DIR}/page)
  hookeye_given_page()
  if(PAGE_FILE)
    add_custom_command(
      OUTPUT ${out}/page.html
      COMMAND ${CMAKE_COMMAND} -E copy ${PAGE_FILE} ${out}/page.html
      DEPENDS ${PAGE_FILE}
      COMMENT "Taking the page ${PAGE_FILE}")
  else()
    hookeye_build_page(${out})
    if(NOT PAGE_BUILT)
      return()
    endif()
  endif()
  add_custom_target(built_page DEPENDS ${out}/page.html)  # alone, for ./release
  # The object's symbols are named after the file as it is given: _binary_page_html_start.
  add_custom_command(
    OUTPUT ${out}/page.o
    COMMAND ${CMAKE_LINKER} -r -b binary -z noexecstack -o page.o page.html
    DEPENDS ${out}/page.html
    WORKING_DIRECTORY ${out}
    COMMENT "Putting the page into the program")
  set_source_files_properties(${out}/page.o PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
  target_sources(${target} PRIVATE ${out}/page.o)
  target_compile_definitions(${target} PRIVATE HOOKEYE_HAS_PAGE)
endfunction()
