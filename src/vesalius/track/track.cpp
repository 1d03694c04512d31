#include "vesalius/track/track.h"

namespace vesalius {

Track::Track(int number, const Sighting& sighting, double time_s)
    : id(number), motion(sighting.trunk.position, sighting.trunk.sigma_m), since_s(time_s) {
  take_sighting(sighting, time_s);
}

void Track::take_sighting(const Sighting& sighting, double time_s) {
  motion.update(sighting.trunk.position, sighting.trunk.sigma_m);
  ++found;
  seen_s = time_s;
  look.add_histogram(sighting.look);
  if (sighting.scale) size.add_scale(*sighting.scale);
  place = sighting.place;
  place_position = motion.position();
  person = sighting.person;
  person.mask = {};
  person.labels = {};
  person.points = {};
  expected = {};
}

}  // namespace vesalius
