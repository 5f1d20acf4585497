"""Not tried. For a spack repository: packages/hookeye/package.py."""

from spack.package import *


class Hookeye(CMakePackage):
    """Elastic models of soft objects from photos under known loads."""

    url = "SOURCE/hookeye-0.2.0.tar.xz"
    license("AGPL-3.0-or-later")

    version("0.2.0", sha256="SHA256")

    variant("python", default=True, description="The Python module")
    variant("gmsh", default=False, description="Read msh and medit meshes")
    variant("cgal", default=True, description="Mend surfaces: hookeye mesh --repair")

    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("boost")
    depends_on("ceres-solver")
    depends_on("cli11@2")
    depends_on("cpp-httplib")
    depends_on("eigen@3.4")
    depends_on("embree@3")
    depends_on("fmt")
    depends_on("highway")
    depends_on("metis")
    depends_on("nlohmann-json")
    depends_on("openblas threads=pthreads")
    depends_on("opencv+calib3d+imgproc+video+contrib")
    depends_on("openimageio")
    depends_on("pugixml")
    depends_on("spdlog")
    depends_on("suite-sparse")
    depends_on("intel-oneapi-tbb")
    depends_on("tetgen")
    depends_on("tinyobjloader")
    depends_on("tl-expected")
    depends_on("sqlite")
    depends_on("xxhash")
    depends_on("yaml-cpp")
    depends_on("zlib-api")
    depends_on("cgal", when="+cgal")
    depends_on("gmsh", when="+gmsh")
    depends_on("python@3.9:", when="+python", type=("build", "link", "run"))
    depends_on("py-numpy", when="+python", type=("build", "run"))
    depends_on("py-pybind11@2.9:", when="+python", type="build")
    extends("python", when="+python")

    generator("ninja")

    def cmake_args(self):
        args = [
            self.define("HOOKEYE_TESTS", False),
            self.define("HOOKEYE_UNITY", True),
            self.define_from_variant("HOOKEYE_PYTHON", "python"),
            self.define_from_variant("HOOKEYE_WITH_GMSH", "gmsh"),
            self.define_from_variant("HOOKEYE_WITH_CGAL", "cgal"),
        ]
        if self.spec.satisfies("+python"):
            args.append(self.define("HOOKEYE_PYTHON_PROGRAM", python.path))
            args.append(self.define("HOOKEYE_PYTHON_FOLDER", python_platlib))
        return args
