// Blocks of tetrahedra and reference meshes for tests.
#pragma once

#include <filesystem>
#include <functional>

#include "meshing/regions.h"
#include "meshing/tet_mesh.h"

namespace hookeye::test {

/// Block [0,lx] x [0,ly] x [0,lz] of nx x ny x nz cells, six tetrahedra each. With order 2 the mid
/// nodes lie on straight edges. `shake`: corner nodes inside move by up to this share of a cell
/// (a fixed pattern), so that no symmetry hides a fault.
TetMesh block(int nx, int ny, int nz, Eigen::Vector3d size, int order, double shake = 0.0);

/// "nnodes ntets nodes_per_tet" text of the reference data.
TetMesh read_reference_mesh(const std::filesystem::path& file);

/// Largest component [mm] by which the places `q` miss those of the reference's table (node, X, u;
/// CalculiX). Throws std::runtime_error where it lists other nodes than the mesh has.
double distance_to_reference(const std::filesystem::path& csv, const TetMesh& mesh,
                             const VectorXd& q);

/// Boundary faces all of whose nodes satisfy `inside` make the region.
Region region_where(const TetMesh& mesh, const std::function<bool(const Eigen::Vector3d&)>& inside);

/// Deterministic numbers in [-1, 1].
VectorXd noise(Eigen::Index n, unsigned seed);

}  // namespace hookeye::test
