// Patches of one picture found again in another: the only motion that is sought without a model.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "capture_io/image.h"
#include "estimation/inspection/options.h"

namespace hookeye::inspection {

struct Patch {
  Eigen::Vector2d at;                               ///< its centre [px]
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< to where it is found best
  double likeness = 0.0;                            ///< normalised cross-correlation there, -1 .. 1
  double elsewhere = 0.0;  ///< the same with other places of its own picture
  bool found = false;      ///< alike, and moved as its neighbours are
};

struct PatchField {
  std::vector<Patch> patches;  ///< all that were sought
  int found() const;
  double share() const;     ///< of patches that were found; 0: none sought
  double shift_px() const;  ///< root mean square over found ones; 0: none
};

/// Seeks patches that lie within `body` (per pixel of `from`) and have contrast in `to`, each up to
/// `reach` px away, to a tenth of a pixel. Where a patch shows light more than texture, as across
/// the edge of a bright and a dark face, it is sought in levelled pictures: without the mean of the
/// neighbourhood and over its deviation, in windows of options.light_px. A patch that is as good as
/// found in its own picture elsewhere is not sought: along an edge it tells motion across it alone
/// (the aperture problem). A patch counts as found if its likeness is options.alike or more, and no
/// less than to those places, and it moves as the median of its neighbours does (the median test of
/// Westerweel and Scarano 2005, with room for strain and rotation).
/// The only file that touches OpenCV's template matching is patches.cpp.
PatchField find_patches(const Image& from, const std::vector<unsigned char>& body, const Image& to,
                        double reach, const InspectionOptions& options);

/// The same of one picture in many others, which have its size: what is of that one is done once.
class SoughtPatches {
 public:
  /// `from` is held, not copied.
  SoughtPatches(const Image& from, const std::vector<unsigned char>& body, double reach,
                const InspectionOptions& options);
  SoughtPatches(SoughtPatches&&) noexcept;
  ~SoughtPatches();
  /// find_patches(): the same patches in the same order in each picture.
  PatchField in(const Image& to) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Normalised cross-correlation of two pictures over the pixels of `counted`; NaN: too few.
double correlation(const Image& one, const Image& other, const std::vector<unsigned char>& counted);

}  // namespace hookeye::inspection
