// Every threshold of the inspection, with its unit and where it comes from. "Measured": over the
// right captures of docs/check.md, whose figures stand there.
#pragma once

namespace hookeye {

struct InspectionOptions {
  /// One coarse solve a load case, for the drawn first guess and for what is said about loads.
  /// Without it only what stands still is looked at.
  bool first_guess = true;

  // How photos are looked at.
  int look_px = 640;          ///< longest side [px]: a speckle of 3 px in 2500 px still shows
  int patch_px = 33;          ///< side of a patch [px of the small photo]: ten speckles of 10 px
  int light_px = 17;          ///< window of the light that is taken out: half a patch, so that a
                              ///< step in the midst of one leaves a half of it to the texture
  int most_patches = 90;      ///< of one photo: their share is known to 5 %
  double still_reach = 0.05;  ///< of the photo's diagonal: how far a patch of the body at rest is
                              ///< sought. A knocked camera moves pictures by 1 %
  double moved_reach = 0.13;  ///< the same for a loaded body: soft bodies move by a tenth
  double alike = 0.6;         ///< least correlation of a found patch (right: 0.8 and more)
  double alike_elsewhere = 0.8;  ///< most likeness of a patch to another place of its own picture:
                                 ///< an edge has 0.9 and more, which a found patch cannot beat
  int least_patches = 8;         ///< fewer say nothing of the whole photo
  double least_contrast = 0.08;  ///< deviation over mean within a patch: shading has less
  double most_light = 0.5;  ///< share of a patch's variance that the means of such windows have:
                            ///< from half on light and shadow are seen there, and no texture

  // Whether a camera sees the body where its photo shows it.
  double lost_share = 0.3;   ///< of patches found: below it camera and photo do not belong together
  double found_share = 0.6;  ///< from it on they do
  double lost_shift = 0.02;  ///< of the photo's diagonal, where the photos themselves are the
                             ///< texture: they show one state of the body. A knocked camera moves
                             ///< pictures by 1 %. (Of a told texture a weight that is not told
                             ///< moves the body as far as it likes.)
  double lost_overlap = 0.7;  ///< of silhouettes, where there is no texture
  double found_overlap = 0.85;
  double usual_overlap = 0.95;  ///< below it is told what parts the silhouettes (right: 0.97)

  // Whether the place that is told for the body goes with its outline. Both have to be exceeded by
  // a quarter of the model's rim.
  double outline_of_body =
      0.02;  ///< of the body's size in the photo: as far as measured points may
             ///< lie off the mesh, so as far as a cast may differ from its CAD
  double outline_of_noise = 3.0;  ///< times what the outline is ragged by

  // Distortion told of straight photos.
  double least_bent_px = 0.06;  ///< shift of the patches at rest [px]: right cameras have half
  double straighter = 0.4;      ///< of that shift is left without the distortion

  // Stored values.
  int most_bits_of_16 = 12;        ///< a photo of 16 bits that uses no more is one of 12 or less
  double times_better_read = 3.0;  ///< fall of the squares left by the other reading (measured: 31
                                   ///< and more where the told one is wrong)

  // Sizes in SI, which tell units that go together but not with the numbers.
  double smallest_body = 5e-5;   ///< [m]: fewer than a hundred pixels of a light microscope
  double largest_body = 10.0;    ///< [m]: balloons and airbags are smaller
  double softest_guess = 1.0;    ///< [Pa]: the softest gels have 10; a guess may be ten times off
  double stiffest_guess = 1e10;  ///< [Pa]: hard plastics have 1e9

  /// Of numbers that have the digits of radians by chance: a capture in a few hundred would get a
  /// false word, one with two angles in 40000.
  double digits_by_chance = 0.005;

  // Weight.
  double least_density = 1.0;     ///< [kg/m^3]: aerogel
  double most_density = 25000.0;  ///< [kg/m^3]: above all metals
  double least_gravity = 0.5;     ///< [m/s^2]: a third of the moon's
  double most_gravity = 100.0;    ///< [m/s^2]: ten times the earth's, as on a turntable

  // Where a loaded body moves. Cosines are those of all found points together, seen against
  // expected.
  double least_motion_px = 1.0;  ///< rms: below it a camera's tremble has a direction, too
  double sure_motion_px = 4.0;   ///< expected rms that cannot stay unseen
  double sure_astray_px = 2.0;   ///< rms across the expected motion from which it is told where no
                                 ///< slip explains it: twice what has a direction
  double astray_cosine = 0.5;    ///< below it the motion is another one (measured: 0.86 and more)
  double sure_cosine = 0.85;     ///< from it on a slip explains it
  double flat_cosine = 0.94;     ///< facets within 20 degrees of a region's normal are its face
  double most_of_face = 0.85;    ///< a region that covers more of its face was meant so
  double left_of_motion = 0.06;  ///< of the squares of motions are astray (measured: 0.14 and 0.41
                                 ///< with half of a region)
  double left_by_grown = 0.25;   ///< of those are left if the region covers its face

  // Photos or measured values that stand in one another's places.
  double better_by_pair = 0.6;  ///< what an exchange of two leaves, of what was left: a half where
                                ///< one of them is right then, as within a longer mix-up
  double left_of_exchanged = 0.04;  ///< of the squares is astray where something is exchanged: two
                                    ///< pulls whose forces are as 1 to 1.2
  double left_by_exchange = 0.25;   ///< of those are left once it is exchanged back

  // Measured values.
  double sure_sigmas = 5.0;  ///< their length, from which the direction is that of the load
  double heaviest_soft =
      2500.0;                 ///< [kg/m^3]: filled silicones have 2000. No less force than such
                              ///< a weight has a sure sign: the capture may leave the weight out
  double weight_moved = 0.3;  ///< of it changes between load cases: soft bodies strain by as much

  // Fields of strains, read another way.
  int strain_points = 400;         ///< of a field are looked at
  double steps_about = 1.6;        ///< from point to point: the eight next ones of a square grid
  double left_by_reading = 0.5;    ///< of what is left of the strains as told, at most
  double sure_reading = 0.9;       ///< least cosine to what the other reading says
  double sigmas_of_reading = 1.0;  ///< rms that is left as told, at least: noise has no reading
  double close_unit = 1.3;         ///< of units, which are a thousand or a hundred times each other

  // How far it moves, against the first guess to first order.
  double most_times_by_force = 30.0;  ///< a modulus that is told ten times wrong is found by a fit;
                                      ///< measured: 0.65 to 2.0
  double most_times_moved = 3.0;  ///< a prescribed motion is known better; measured: 0.87 to 1.08
  double close_turn = 1.6;   ///< of radians, which are 57 degrees each: a large turn seen to first
                             ///< order is longer than it is
  double usual_times = 3.0;  ///< beyond it, either way, it is remarked: right loads had 0.65 to 2.0

  // The coarse solve.
  int coarse_nodes = 4000;     ///< of linear tetrahedra: half a CPU-second a load case
  double across_thin = 2.0;    ///< fewer linear tetrahedra across a body lock where it bends
  double most_locked = 2.0;    ///< quadratic ones move it that many times as far: more than linear
                               ///< ones are too stiff by anyway
  int coarse_iterations = 60;  ///< Newton's, of all load steps: twice what a strain of 1 takes
  double most_strain = 3.0;    ///< to first order: beyond it nobody photographs a soft body
};

}  // namespace hookeye
