// Captures made from photographs that nobody here took (shared data, real/). Each function reads
// the data's folder and writes a capture folder as a user would: photos, body, capture.yaml.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hookeye::real {

namespace fs = std::filesystem;

/// Open-hole tension of a carbon/epoxy bar, one camera seen as orthographic (95 um/px). Texture
/// from the first photo; the second one, unloaded too, tells the floor. The jaws are out of sight:
/// both ends of a bar that reaches one width beyond the picture move as unknown rigid bodies.
/// `steps`: numbers of the loaded photos, 2..11.
void write_openhole(const fs::path& data, const fs::path& capture, const std::vector<int>& steps);

/// A place in the first photo and its displacement, both in px of the image axes.
struct DicPoint {
  double x_px, y_px, u_px, v_px;
};
/// Published displacements of a step against the first photo (image axes).
std::vector<DicPoint> published_displacements(const fs::path& data, int step);

/// A silicone bar with heads at both ends, one head clamped, sagging under its weight: one
/// silhouette cut out of the colour photo.
struct Silicone {
  char material = 'e';           ///< e: Ecoflex 00-50 (red), m: Mold Star 15 (blue)
  double density_si = 1070.0;    ///< kg/m^3, told
  double start_mu_si = 25000.0;  ///< Pa
  bool fit_placement = true;
  double edge = 1.2;  ///< of the tetrahedra [cm]
};
void write_diffcal(const fs::path& data, const fs::path& capture, const Silicone& silicone);

/// Printed elastomer sheets pulled between jaws; silhouettes cut out of grey photos by brightness.
struct TangoFrame {
  int frame = 0;
  double left_px = 0, right_px = 0;   ///< where the stiff ends meet the sheet
  double stroke_mm = 0, force_N = 0;  ///< force as the load cell showed it
};
std::vector<TangoFrame> tango_frames(const fs::path& data, bool notched_sheet);
/// A sheet in tension: which frames, and what the capture tells of them.
struct Tension {
  std::vector<int> frames;
  std::vector<int> held_out;       ///< of those: `use: validate`
  double load_cell_zero_N = 0.17;  ///< taken off the told force (what it shows without load)
  bool fit_jaw = true;             ///< false: moved as the photos' edges tell
  std::string material = "{law: neo-hookean, mu: 0.3, kappa_over_mu: 100}";
  std::string fit = "mu";  ///< names, comma-separated
};
void write_tango_holes(const fs::path& data, const fs::path& capture, const Tension& tension);
/// The sheet with two notches; no force is told.
void write_tango_notched(const fs::path& data, const fs::path& capture, const Tension& tension);

/// A block that CalculiX solved (shared data, reference/), read from its deck: MESH_A, stretched
/// and bent, or MESH_B, a heavy cantilever. No photo; a camera that can look at it.
void write_reference(const fs::path& data, const fs::path& capture, const std::string& deck);

}  // namespace hookeye::real
