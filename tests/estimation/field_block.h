// A block whose displacements (or strains) under a few loads are told as fields, without a camera
// or a photo.
#pragma once

#include <memory>
#include <string>

#include "estimation/model/model.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

struct FieldBlock {
  double mu = 0.05;                     ///< of the truth; told: 0.04
  Vector3d gravity = Vector3d::Zero();  ///< of the truth, [mm/s^2]; the capture tells none
  double sigma = 0.01;                  ///< of the noise [mm]
  double told = 0.0;                    ///< sigma in the capture; 0: as it is
  bool alike = false;                   ///< noise is one in each 3 x 3 points
  std::string keys = {};                ///< further keys of every field: ", correlation: 0"
  bool rest = true;                     ///< a field of the body at rest
  bool in_plane = false;                ///< files without Z and W, each face in a frame of its own
  unsigned seed = 1;
  bool from_pull = false;   ///< the fields of `bend` start from the state of `pull`
  std::string strain = {};  ///< the fields hold strains by this measure; sigma is of them

  /// Writes capture.yaml, block.obj and the fields of two faces of every example.
  void write(const std::filesystem::path& folder) const;
  std::shared_ptr<const Scene> scene() const;  ///< the same, read
};

/// The block with `from` replaced by `to`, once, in a file of its folder.
struct ChangedBlock {
  FieldBlock block;
  std::string file, from, to;
  void write(const std::filesystem::path& folder) const;  ///< throws where `from` is not there
  std::shared_ptr<const Scene> scene() const;
  /// Why it is not read, with names of files as from its folder; "": it is.
  std::string refusal() const;
};

}  // namespace hookeye::test
