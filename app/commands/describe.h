// What several commands say about a body, a parameter, a material: as JSON and as lines.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "capture_io/capture.h"
#include "core/parameter.h"
#include "meshing/tet_mesh.h"

namespace hookeye {

nlohmann::ordered_json describe_mesh(const TetMesh& mesh);
std::string mesh_lines(const TetMesh& mesh);
/// How `hookeye mesh` mends what narrow triangles of a surface make of the mesh; empty: it is well.
std::string narrow_triangles_line(const TetMesh& mesh);
nlohmann::ordered_json describe_vector(const Vector3d& v);
/// "(1, 0, 2.5)"; what is tiny beside `scale` or its largest component reads as zero.
std::string vector_text(const Vector3d& v, double scale = 0.0);

}  // namespace hookeye
