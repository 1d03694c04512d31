#include "vesalius/track/track_look.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vesalius {
namespace {

TrackSize seen(float scale, int frames = 1) {
  TrackSize size;
  for (int i = 0; i < frames; ++i) size.add_scale(scale);
  return size;
}

TrackSize fitted(float size) {
  TrackSize track;
  track.fit(size);
  return track;
}

TEST(TrackSize, TellsNothingWhereOneIsNotKnown) {
  EXPECT_EQ(TrackSize::distance2({}, {}), 0.F);
  EXPECT_EQ(TrackSize::distance2({}, seen(0.5F)), 0.F);
  EXPECT_EQ(TrackSize::distance2(fitted(1.2F), {}), 0.F);
}

TEST(TrackSize, OfAFittedBodyTellsWhoASightingIs) {
  const TrackSize child = fitted(0.7F), adult = fitted(1.03F), small = seen(0.68F), large = seen(0.98F);
  EXPECT_LT(TrackSize::distance2(child, small), 1.F);
  EXPECT_LT(TrackSize::distance2(adult, large), 1.F);
  EXPECT_GT(TrackSize::distance2(child, large), 4.F);
  EXPECT_GT(TrackSize::distance2(adult, small), 4.F);
}

TEST(TrackSize, OfAFittedBodyCorrectsWhatPosesBias) {
  // Somebody whose links looked long, and whose body is small.
  TrackSize both = seen(1.1F, 50);
  const TrackSize links_alone = both, small = seen(0.8F);
  both.fit(0.8F);
  EXPECT_LT(TrackSize::distance2(both, small), TrackSize::distance2(links_alone, small));
  EXPECT_GT(TrackSize::distance2(both, small), TrackSize::distance2(fitted(0.8F), small));
  both.fit(1.15F);
  EXPECT_GT(TrackSize::distance2(both, small), TrackSize::distance2(links_alone, small))
      << "the last fit counts, and both together are surer";
}

}  // namespace
}  // namespace vesalius
