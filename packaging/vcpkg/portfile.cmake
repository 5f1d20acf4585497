# Not tried. An overlay port: vcpkg install hookeye --overlay-ports=packaging/vcpkg
# vcpkg has no TetGen as a library: give one by -DTETGEN_LIBRARY=FILE below.
vcpkg_download_distfile(ARCHIVE
  URLS SOURCE/hookeye-${VERSION}.tar.xz FILENAME hookeye-${VERSION}.tar.xz SHA512 SHA512_OF_THE_ARCHIVE)
vcpkg_extract_source_archive(SOURCE_PATH ARCHIVE ${ARCHIVE})
vcpkg_cmake_configure(SOURCE_PATH ${SOURCE_PATH}
  OPTIONS -DHOOKEYE_TESTS=OFF -DHOOKEYE_UNITY=ON -DHOOKEYE_PYTHON=OFF -DHOOKEYE_WITH_GMSH=OFF)
vcpkg_cmake_install()
vcpkg_copy_tools(TOOL_NAMES hookeye AUTO_CLEAN)
file(REMOVE_RECURSE ${CURRENT_PACKAGES_DIR}/debug)
vcpkg_install_copyright(FILE_LIST ${SOURCE_PATH}/LICENSE)
