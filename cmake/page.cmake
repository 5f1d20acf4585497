# The page (studio/) built by Vite and turned into an object that is linked into the program:
# hookeye_page(TARGET). Without Node.js the program still builds, and `hookeye report` says why it
# cannot work.
find_program(NODE NAMES node nodejs)
find_program(NPM npm)

function(hookeye_page target)
  if(NOT NODE OR NOT NPM)
    message(WARNING "node or npm is not there: 'hookeye report' and 'hookeye studio' will not work "
                    "(install the packages of packages.txt and configure again)")
    return()
  endif()
  set(source ${CMAKE_SOURCE_DIR}/studio)
  set(out ${CMAKE_BINARY_DIR}/page)
  file(GLOB_RECURSE inputs CONFIGURE_DEPENDS ${source}/src/*)
  # Types are checked, and a browser is driven, where there are tests.
  set(omit --omit=dev)
  set(check_types "")
  if(HOOKEYE_TESTS)
    set(omit "")
    set(check_types COMMAND ${NPM} run --silent types)
  endif()
  set(fetched ${CMAKE_BINARY_DIR}/page-packages${omit})
  add_custom_command(
    OUTPUT ${fetched}
    COMMAND ${NPM} install --no-save --no-audit --no-fund --loglevel=error ${omit}
    COMMAND ${CMAKE_COMMAND} -E touch ${fetched}
    DEPENDS ${source}/package.json ${source}/package-lock.json
    WORKING_DIRECTORY ${source}
    COMMENT "Fetching what the page is built with")
  add_custom_command(
    OUTPUT ${out}/page.html
    ${check_types}
    COMMAND ${NPM} run --silent build -- --outDir ${out} --logLevel warn
    DEPENDS ${inputs} ${source}/page.html ${source}/vite.config.ts ${source}/tsconfig.json
            ${fetched}
    WORKING_DIRECTORY ${source}
    COMMENT "Building the page")
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
