# Every third-party package, found once. Debian package names: packages.txt.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
include(opencv)
hookeye_opencv(core imgproc video)
# Without these `hookeye calibrate` says how to get them.
find_library(OPENCV_calib3d_LIBRARY opencv_calib3d)
find_library(OPENCV_aruco_LIBRARY opencv_aruco)
if(OPENCV_calib3d_LIBRARY AND OPENCV_aruco_LIBRARY)
  hookeye_opencv(calib3d aruco features2d)
endif()
# Not by its own CMake files: Debian's ask for programs of another package (openimageio-tools, Qt).
find_package(PkgConfig REQUIRED)
find_package(Imath REQUIRED)
pkg_check_modules(OpenImageIO REQUIRED IMPORTED_TARGET OpenImageIO)
add_library(OpenImageIO::OpenImageIO INTERFACE IMPORTED)
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
  INTERFACE_LINK_LIBRARIES "PkgConfig::OpenImageIO;Imath::Imath")
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 3 REQUIRED)
find_package(Ceres REQUIRED)
find_package(Boost REQUIRED)
find_package(CLI11 REQUIRED)
find_package(pugixml REQUIRED)
find_package(ZLIB REQUIRED)

find_path(CHOLMOD_INCLUDE cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
find_library(XXHASH_LIBRARY xxhash REQUIRED)
find_library(HWY_LIBRARY hwy REQUIRED)
find_library(METIS_LIBRARY metis REQUIRED)
find_library(TETGEN_LIBRARY NAMES tet tetgen REQUIRED)
find_library(TINYOBJ_LIBRARY tinyobjloader_double REQUIRED)
find_library(GMSH_LIBRARY gmsh)  # without it no msh is read, and no medit mesh
find_package(CGAL QUIET)  # without it `hookeye mesh --repair` says so
find_library(OPENBLAS_LIBRARY openblas)
if(NOT OPENBLAS_LIBRARY)
  message(WARNING "OpenBLAS is not there: factorizations will be 4-8 times slower")
  find_package(BLAS REQUIRED)
  set(OPENBLAS_LIBRARY ${BLAS_LIBRARIES})
endif()
# First on every link line: Ceres brings whatever BLAS it finds (ATLAS where that is installed), and
# the first library that knows dgemm serves CHOLMOD and Eigen too.
link_libraries(${OPENBLAS_LIBRARY})
find_package(OpenMP REQUIRED COMPONENTS CXX)
