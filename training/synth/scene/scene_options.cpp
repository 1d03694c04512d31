#include "synth/scene/scene_options.h"

#include <fmt/format.h>

#include "vesalius/error.h"

namespace vesalius::synth {

void visit_options(const std::string& prefix, SceneOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "open-share", o.open_share, {"", 0.0, 1.0, "Share of scenes in a hall without walls."});
  visitor.option(prefix + "furniture-min", o.furniture_min, {"", 0, 50, "Fewest pieces of furniture."});
  visitor.option(prefix + "furniture-max", o.furniture_max, {"", 0, 50, "Most pieces of furniture."});
  visitor.option(prefix + "mannequin-share", o.mannequin_share,
                 {"", 0.0, 1.0, "Share of furniture that resembles people: coats on stands, mannequins, pillars."});
  visitor.option(prefix + "nobody-share", o.nobody_share,
                 {"", 0.0, 1.0,
                  "Share of furniture that is taken for people: hung clothes, jackets on chairs, machines with arms, "
                  "tilted boards and screens, bags, heaps of cushions and blankets."});
  visitor.option(prefix + "near-nobody-share", o.near_nobody_share,
                 {"", 0.0, 1.0, "Share of large things close to the camera that are of this sort."});
  visitor.option(prefix + "gear-share", o.gear_share,
                 {"", 0.0, 1.0,
                  "Share of furniture, also of things before people and close to the camera, that stands on feet, rods "
                  "and castors: office chairs, screens on arms, trolleys, walkers, dressed machines, ladders, lamps."});
  visitor.option(prefix + "occluder-probability", o.occluder_probability,
                 {"", 0.0, 1.0, "Probability that something stands between the camera and a person."});
  visitor.option(prefix + "near-probability", o.near_probability,
                 {"", 0.0, 1.0, "Probability that something large, such as a door leaf, stands close to the camera."});
  visitor.option(prefix + "table-probability", o.table_probability,
                 {"", 0.0, 1.0, "Probability of a table in front of a sitting person."});
  visitor.option(prefix + "sofa-probability", o.sofa_probability,
                 {"", 0.0, 1.0, "Probability that two sitting people try to share a sofa."});
  visitor.option(prefix + "beside-probability", o.beside_probability,
                 {"", 0.0, 1.0, "Probability that two standing people stand side by side and touch, or nearly."});
  visitor.option(
      prefix + "contact-probability", o.contact_probability,
      {"", 0.0, 1.0,
       "Probability that two people embrace, hand something over, hold hands, support or help each other up."});
  visitor.option(prefix + "bed-probability", o.bed_probability,
                 {"", 0.0, 1.0, "Probability that a lying person has a bed rather than the floor."});
  visitor.option(prefix + "soft-probability", o.soft_probability,
                 {"", 0.0, 1.0, "Probability that cushions swell around a person on a sofa, an armchair or a bed."});
  visitor.option(prefix + "soft-depth", o.soft_depth_m, {"m", 0.0, 0.2, "How deep people sink into those at most."});
  visitor.option(prefix + "blanket-probability", o.blanket_probability,
                 {"", 0.0, 1.0, "Probability of a blanket over a lying person or the legs of a sitting one."});
  visitor.option(prefix + "care-probability", o.care_probability,
                 {"", 0.0, 1.0,
                  "Probability of a wheelchair, toilet or bench below a sitting person, and of a bed with rails, often "
                  "with a blanket up to the neck, below a lying one who has a bed."});
  visitor.option(prefix + "load-probability", o.load_probability,
                 {"", 0.0, 1.0,
                  "Probability that somebody who stands with both hands in front carries a box or tray, or pushes a "
                  "trolley or walker; not in clips."});
  visitor.option(prefix + "lying-sofa-probability", o.lying_sofa_probability,
                 {"", 0.0, 1.0, "Probability of a sofa instead of the bed of a lying person."});
  visitor.option(prefix + "desk-probability", o.desk_probability,
                 {"", 0.0, 1.0,
                  "Probability of a desk with screens or a counter close before a sitting or standing person, which "
                  "hides all but head and shoulders from in front."});
  visitor.option(prefix + "wall-probability", o.wall_probability,
                 {"", 0.0, 1.0, "Probability of a wall close behind the people, as the camera sees them."});
  visitor.option(prefix + "wall-gap-max", o.wall_gap_max_m, {"m", 0.0, 2.0, "Greatest distance to that wall."});
  visitor.option(
      prefix + "doorway-probability", o.doorway_probability,
      {"", 0.0, 1.0, "Probability that a person is in or behind an opening in a wall, whose edge hides a part."});
  visitor.option(prefix + "picture-probability", o.picture_probability,
                 {"", 0.0, 1.0,
                  "Probability that posters, paintings, banners and screens with pictures, two in five of them of "
                  "people, are at the walls."});
  visitor.option(prefix + "border-share", o.border_share,
                 {"", 0.0, 1.0, "Share of people whom the left or right border of the picture is to cut."});
  visitor.option(prefix + "cut-share", o.cut_share,
                 {"", 0.0, 1.0,
                  "Share of cameras so near or so tilted that borders cut the first person, of whom a seventh may "
                  "remain instead of min-visible."});
  visitor.option(prefix + "dark-furniture", o.dark_furniture,
                 {"", 0.0, 1.0, "Share of furniture that sends back next to no infrared light, as black leather."});
  visitor.option(prefix + "dark-to-the-eye", o.dark_to_the_eye,
                 {"", 0.0, 1.0, "Share of such furniture that is dark in colour as well; the rest has any colour."});
  visitor.option(prefix + "frontal-share", o.frontal_share,
                 {"", 0.0, 1.0, "Share of people made to face the camera; the others face anywhere."});
  visitor.option(prefix + "frontal-range", o.frontal_range_deg,
                 {"deg", 0.0, 180.0, "Largest angle to the camera of those who face it."});
  visitor.option(prefix + "min-visible", o.min_visible,
                 {"", 0.0, 1.0, "Least share of a person's bones within the picture."});
  visitor.option(prefix + "detail", o.detail_px,
                 {"px", 0.0, 4.0, "How far the surface of people far away may be simplified; 0: not at all."});
}

void check(const SceneOptions& options) {
  SceneOptions copy = options;
  RangeCheck ranges;
  visit_options("scene.", copy, ranges);
  if (options.furniture_min > options.furniture_max) {
    throw UsageError(fmt::format("option scene.furniture-min is {}, above scene.furniture-max {}",
                                 options.furniture_min, options.furniture_max));
  }
}

}  // namespace vesalius::synth
