#pragma once

#include <string>

#include "vesalius/base/options.h"

namespace vesalius::synth {

/// The properties of rooms, and how people are placed in them.
struct SceneOptions {
  float open_share = 0.12F;  ///< share of scenes in a hall whose walls are out of sight
  int furniture_min = 0;     ///< pieces other than those on which people sit and lie
  int furniture_max = 10;
  float mannequin_share = 0.1F;       ///< share of these pieces that resemble people
  float nobody_share = 0.F;           ///< share of these pieces that are of nobody.h
  float near_nobody_share = 0.F;      ///< share of large near things that are of nobody.h
  float gear_share = 0.F;             ///< share of pieces, of things before people and of near ones that are of gear.h
  float occluder_probability = 0.3F;  ///< something stands between the camera and a person
  float near_probability = 0.15F;     ///< something large stands close to the camera
  float table_probability = 0.35F;    ///< a table stands in front of a sitting person
  float sofa_probability = 0.4F;      ///< two sitting people share a sofa
  float beside_probability = 0.F;     ///< two standing people stand shoulder to shoulder
  float contact_probability = 0.F;    ///< people touch: contact_pair.h
  float bed_probability = 0.6F;       ///< a lying person has a bed or sofa rather than the floor
  float soft_probability = 0.F;       ///< cushions swell around a person who sits on a sofa or lies on a bed
  float soft_depth_m = 0.08F;         ///< greatest swell of those
  float blanket_probability = 0.F;  ///< a blanket lies over the legs of a sitting person, or up to a lying one's chest
  float care_probability =
      0.F;  ///< a wheelchair, toilet or bench instead of a seat; a bed with rails, covered to the neck
  float load_probability = 0.F;        ///< somebody who holds both hands before them carries or pushes something
  float lying_sofa_probability = 0.F;  ///< a lying person who has a bed gets a sofa instead, if they fit on it
  float desk_probability = 0.F;        ///< a desk with screens or a counter stands close before a person
  float wall_probability = 0.F;        ///< a wall is close behind the people as the camera sees them
  float wall_gap_max_m = 0.4F;         ///< greatest distance of that wall
  float doorway_probability = 0.F;     ///< a person stands in or behind an opening in a wall
  float picture_probability = 0.F;     ///< posters, paintings, banners and screens with pictures are at the walls
  float border_share = 0.F;            ///< share of groups of people whom the left or right border is to cut
  float cut_share = 0.F;               ///< share of cameras so near or tilted that borders cut the first people
  float frontal_share = 0.45F;         ///< share of people who face the camera within `frontal_range_deg`
  float frontal_range_deg = 60.F;
  float dark_furniture = 0.1F;  ///< share of all pieces that reflect almost no infrared light
  float dark_to_the_eye = 0.F;  ///< share of those that have a dark colour too
  float min_visible = 0.3F;     ///< smallest share of a person's bones within the picture
  float detail_px = 0.35F;      ///< largest error of coarser surfaces for people far away; 0 uses none
};

void visit_options(const std::string& prefix, SceneOptions& options, OptionVisitor& visitor);

/// Throws UsageError naming an option that is out of its range.
void check(const SceneOptions& options);

}  // namespace vesalius::synth
