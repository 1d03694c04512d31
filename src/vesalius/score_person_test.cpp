#include "vesalius/score_person.h"

#include <gmock/gmock.h>

#include <cmath>

namespace vesalius {
namespace {

const Camera kCamera{40, 30, 100.F, 100.F, 19.5F, 14.5F};

/// A square of 10 x 10 pixels at 2 m, in front of a surface at `behind_mm`.
struct Square {
  explicit Square(std::uint16_t behind_mm) {
    frame.camera = kCamera;
    frame.depth = DepthImage(40, 30, behind_mm);
    for (int v = 10; v < 20; ++v) {
      for (int u = 15; u < 25; ++u) {
        frame.depth(u, v) = 2000;
        mask(u, v) = 1;
      }
    }
    skeleton.parts.resize(paper_body().parts.size());
  }
  Evidence evidence() const {
    return gather_evidence(frame, mask, labels, posteriors, {flat, 0.1F, 7}, skeleton, paper_body());
  }
  void observe(const char* part, const Eigen::Vector3f& centre) {
    SkeletonPart& p = skeleton.parts[paper_body().find_part(part)];
    p.state = State::observed;
    p.centre = centre;
  }

  Frame frame;
  Mask mask{40, 30, 0};
  Mask flat{40, 30, 0};
  PersonLabels labels{LabelImage(40, 30, kBackground), {}, 0.F};
  Posteriors posteriors{40, 30, 26, 255, std::vector<std::uint16_t>(std::size_t{40} * 30 * 26, 0)};
  Skeleton skeleton;
};

TEST(GatherEvidence, FindsAnOpenOutlineBeforeAFarWallAndAClosedOneOnIt) {
  EXPECT_FLOAT_EQ(Square(3000).evidence().open, 1.F);
  EXPECT_FLOAT_EQ(Square(0).evidence().open, 1.F);  // holes are far
  EXPECT_FLOAT_EQ(Square(2050).evidence().open, 0.F);
}

TEST(GatherEvidence, SkipsARimWithoutReadings) {
  Square s(2050);
  for (int v = 8; v < 22; ++v) {
    for (int u = 13; u < 27; ++u) {
      if (s.mask(u, v) == 0) s.frame.depth(u, v) = 0;
    }
  }
  EXPECT_FLOAT_EQ(s.evidence().open, 0.F);
}

TEST(GatherEvidence, IgnoresTheOutlineBehindAnOccluder) {
  Square s(3000);
  for (int u = 15; u < 25; ++u) s.frame.depth(u, 20) = 1500;  // a surface in front of its lower edge
  EXPECT_FLOAT_EQ(s.evidence().open, 1.F);
  for (int u = 15; u < 25; ++u) s.frame.depth(u, 9) = 2010;  // and a surface that it touches above
  EXPECT_NEAR(s.evidence().open, 20.F / 30.F, 1e-5);
}

TEST(GatherEvidence, MeasuresTheOccludedShareOfTheOutline) {
  Square s(3000);
  EXPECT_FLOAT_EQ(s.evidence().occluded, 0.F);
  for (int u = 15; u < 25; ++u) s.frame.depth(u, 20) = 1500;
  EXPECT_FLOAT_EQ(s.evidence().occluded, 0.25F);
  for (int u = 15; u < 25; ++u) s.frame.depth(u, 20) = 1950;  // touches
  EXPECT_FLOAT_EQ(s.evidence().occluded, 0.F);
}

TEST(GatherEvidence, MeasuresWhatIsLackingWhereNothingHidesIt) {
  Square s(3000);
  EXPECT_FLOAT_EQ(s.evidence().lacking, 0.6F) << "no part, nothing hidden";
  for (int u = 15; u < 25; ++u) s.frame.depth(u, 20) = 1500;  // hides what is below a quarter of the outline
  EXPECT_FLOAT_EQ(s.evidence().lacking, 0.6F * (1.F - 1.5F * 0.25F));
  s.skeleton.score = 0.6F * float(paper_body().part_count());
  EXPECT_FLOAT_EQ(s.evidence().lacking, 0.F) << "as likely as a whole person";
}

TEST(GatherEvidence, MeasuresNearnessByTheMeanDepthBeyondAMetre) {
  Square s(3000);
  EXPECT_FLOAT_EQ(s.evidence().near, 0.5F);
  for (int v = 10; v < 20; ++v) {
    for (int u = 15; u < 25; ++u) s.frame.depth(u, v) = u < 20 ? 3000 : 5000;
  }
  EXPECT_FLOAT_EQ(s.evidence().near, 0.25F);
  for (int v = 10; v < 20; ++v) {
    for (int u = 15; u < 25; ++u) s.frame.depth(u, v) = 700;
  }
  EXPECT_FLOAT_EQ(s.evidence().near, 1.F);
}

TEST(GatherEvidence, MeasuresPixelsExplainedByTheirPartOrItsPartnerNearby) {
  Square s(3000);
  const auto knee = static_cast<std::uint8_t>(paper_body().find_part("l_knee"));
  for (int v = 10; v < 20; ++v) {
    for (int u = 15; u < 20; ++u) s.labels.labels(u, v) = knee;
  }
  EXPECT_FLOAT_EQ(s.evidence().explained, 0.F);
  s.observe("r_knee", {0.F, 0.F, 2.F});
  EXPECT_FLOAT_EQ(s.evidence().explained, 0.5F);
  s.observe("r_knee", {0.F, 0.F, 2.5F});
  EXPECT_FLOAT_EQ(s.evidence().explained, 0.F);
}

TEST(GatherEvidence, MeasuresTheFoundRootsAndTheirNeighbours) {
  Square s(3000);
  EXPECT_FLOAT_EQ(s.evidence().core, 0.F);
  s.observe("neck", {0.F, 0.F, 2.F});
  s.observe("l_face_top", {0.F, 0.F, 2.F});
  s.observe("l_foot", {0.F, 0.F, 2.F});           // is not
  EXPECT_FLOAT_EQ(s.evidence().core, 2.F / 7.F);  // neck, four face quarters, two chest halves
}

TEST(GatherEvidence, MeasuresThePartsShareOfThePosterior) {
  Square s(3000);
  for (int v = 10; v < 20; ++v) {
    for (int u = 15; u < 25; ++u) {
      s.posteriors.at(u, v)[3] = 50;
      s.posteriors.at(u, v)[7] = 100;
      s.posteriors.at(u, v)[25] = u < 20 ? 50 : 150;  // the background: 0.25 and 0.5
    }
  }
  EXPECT_FLOAT_EQ(s.evidence().body, 0.5F * (0.75F + 0.5F));
}

TEST(GatherEvidence, TakesTheCertaintyOfTheSecondPass) {
  Square s(3000);
  s.labels.certain = 0.375F;
  EXPECT_FLOAT_EQ(s.evidence().certain, 0.375F);
}

TEST(GatherEvidence, MeasuresTheBodyBesideTheMask) {
  Square s(3000);
  EXPECT_FLOAT_EQ(s.evidence().beside, 0.F);  // nothing is known there
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) {
      s.posteriors.at(u, v)[3] = u < 15 ? 100 : 50;  // left of the square half, elsewhere a quarter
      s.posteriors.at(u, v)[25] = u < 15 ? 100 : 150;
    }
  }
  EXPECT_FLOAT_EQ(s.evidence().beside, (0.5F + 3.F * 0.25F) / 4.F);
}

TEST(GatherEvidence, MeasuresTheResolutionByTheNumberOfPixels) {
  EXPECT_FLOAT_EQ(Square(3000).evidence().resolution, 0.4F);  // 100 pixels
}

TEST(GatherEvidence, MeasuresTheShareOfTheOutlineAtThePicturesBorder) {
  Square s(3000);
  EXPECT_FLOAT_EQ(s.evidence().border, 0.F);
  s.mask = Mask(40, 30, 0);
  for (int v = 20; v < 30; ++v) {
    for (int u = 30; u < 40; ++u) {
      s.frame.depth(u, v) = 2000;
      s.mask(u, v) = 1;
    }
  }
  EXPECT_FLOAT_EQ(s.evidence().border, 0.5F);
  for (int v = 20; v < 30; ++v) s.frame.depth(29, v) = 1000;  // hidden to the left
  EXPECT_FLOAT_EQ(s.evidence().border, 0.5F);
  EXPECT_FLOAT_EQ(s.evidence().occluded, 0.5F);
}

TEST(GatherEvidence, MeasuresSizeAsOneOnlyForTheUsualArea) {
  Square s(60000);  // 100 pixels of 4 cm^2 at 2 m
  EXPECT_NEAR(s.evidence().size, 0.04 / kUsualArea_m2, 1e-5);
  const auto at = [&](double z_m) {  // the area grows with the square of the distance
    for (std::size_t i = 0; i < s.mask.size(); ++i) {
      if (s.mask[i] != 0) s.frame.depth[i] = static_cast<std::uint16_t>(std::lround(1000.0 * z_m));
    }
    return s.evidence().size;
  };
  const double usual_at_m = 2.0 * std::sqrt(kUsualArea_m2 / 0.04);
  EXPECT_NEAR(at(usual_at_m), 1.F, 1e-3F);
  EXPECT_NEAR(at(usual_at_m * std::sqrt(2.0)), 0.5F, 1e-3F);
}

TEST(GatherEvidence, TellsWhatATenthOfThePixelsExceed) {
  Square s(3000);
  int n = 0;
  s.posteriors.classes = 26;
  for (int v = 10; v < 20; ++v) {
    for (int u = 15; u < 25; ++u, ++n) {
      std::uint16_t* sums = s.posteriors.at(u, v);
      sums[0] = static_cast<std::uint16_t>(n);  // shares from 0 to 0.99
      sums[25] = static_cast<std::uint16_t>(100 - n);
    }
  }
  EXPECT_NEAR(s.evidence().surest, 0.9F, 0.015F);
}

TEST(GatherEvidence, TellsTheLikeliestHeadingsProbability) {
  Square s(3000);
  EXPECT_FLOAT_EQ(s.evidence().facing, 0.F);
  s.labels.facing = Eigen::Vector4f(0.1F, 0.2F, 0.6F, 0.1F);
  EXPECT_FLOAT_EQ(s.evidence().facing, 0.6F);
}

TEST(GatherEvidence, CountsPixelsCloseToAFlatSurface) {
  Square s(2050);
  EXPECT_FLOAT_EQ(s.evidence().on_flat, 0.F);
  for (int u = 0; u < 40; ++u) {
    for (int v = 20; v < 30; ++v) s.flat(u, v) = 1;  // below
  }
  EXPECT_FLOAT_EQ(s.evidence().on_flat, 3.F) << "the 30 pixels of three rows over the side of 10";
  for (int u = 0; u < 40; ++u) {
    for (int v = 20; v < 30; ++v) s.frame.depth(u, v) = 2200;
  }
  EXPECT_FLOAT_EQ(s.evidence().on_flat, 0.F) << "far behind";
}

TEST(GatherEvidence, PassesTheSceneryOn) {
  EXPECT_FLOAT_EQ(Square(3000).evidence().elsewhere, 0.1F);
  EXPECT_FLOAT_EQ(Square(3000).evidence().rivals, 7.F);
}

TEST(MeanBodyOutside, LeavesOutCandidatesHolesAndSureBackground) {
  Square s(3000);
  constexpr int kParts = 25;
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) {
      s.posteriors.at(u, v)[3] = s.mask(u, v) != 0 ? 255 : v < 15 ? 51 : 0;
      s.posteriors.at(u, v)[kParts] = s.mask(u, v) != 0 ? 0 : v < 15 ? 204 : 255;
    }
  }
  const auto outside = [&] { return mean_body_outside(s.mask, s.frame.depth, s.posteriors, kParts); };
  // Of 20 x 15 pixels 20 x 8 are in the upper half; the mask covers 5 x 3 of them and 5 x 2 of the others.
  EXPECT_NEAR(outside(), 0.2 * 145 / 275, 1e-5);
  for (int v = 15; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) s.frame.depth(u, v) = 0;
  }
  EXPECT_NEAR(outside(), 0.2, 1e-5);
}

TEST(GatherEvidence, SharesTheBodyAmongPartsOfBothSides) {
  const BodyModel& body = paper_body();
  Square s(3000);
  const int left = body.find_part("l_hand"), right = body.find_part("r_hand"), neck = body.find_part("neck");
  for (int v = 10; v < 20; ++v) {
    for (int u = 15; u < 25; ++u) {
      std::uint16_t* sums = s.posteriors.at(u, v);
      sums[left] = 10;
      sums[right] = 20;
      sums[neck] = 30;
      sums[25] = 40;
    }
  }
  const std::vector<int> slots = part_slots(body);
  const Evidence evidence = s.evidence();
  EXPECT_EQ(slots[left], slots[right]);
  EXPECT_NE(slots[left], slots[neck]);
  ASSERT_EQ(evidence.parts.size(), 13U) << "12 pairs and the neck";
  EXPECT_FLOAT_EQ(evidence.parts[slots[left]], 0.5F);
  EXPECT_FLOAT_EQ(evidence.parts[slots[neck]], 0.5F);
  const std::vector<std::string> names = judge_names(body);
  EXPECT_EQ(judge_features(evidence).size(), names.size());
  EXPECT_EQ(judge_signs(body).size(), names.size());
  const auto hands = std::ranges::find(names, "part:" + body.parts[std::min(left, right)].name) - names.begin();
  ASSERT_LT(hands, std::ssize(names));
  EXPECT_EQ(judge_features(evidence)[hands], 0.5F) << "of both hands together";
}

/// A wall of 200 x 150 pixels whose depth is a function of the column and row.
template <class Depth>
Evidence of_surface(const Depth& depth_m) {
  Frame frame;
  frame.camera = {200, 150, 200.F, 200.F, 99.5F, 74.5F};
  frame.depth = DepthImage(200, 150, 0);
  Mask mask(200, 150, 0);
  for (int v = 40; v < 110; ++v) {
    for (int u = 70; u < 130; ++u) {
      mask(u, v) = 1;
      frame.depth(u, v) = static_cast<std::uint16_t>(std::lround(1e3 * depth_m(u, v)));
    }
  }
  const PersonLabels labels{LabelImage(200, 150, kBackground), {}, 0.F};
  const Posteriors posteriors{200, 150, 26, 255, std::vector<std::uint16_t>(std::size_t{200} * 150 * 26, 0)};
  Skeleton skeleton;
  skeleton.parts.resize(paper_body().parts.size());
  const Mask flat(200, 150, 0);
  return gather_evidence(frame, mask, labels, posteriors, {flat}, skeleton, paper_body());
}

TEST(GatherEvidence, MeasuresTheShapeOfAFlatBoard) {
  const Evidence board = of_surface([](int, int) { return 2.0; });
  EXPECT_NEAR(board.depth_m, 0.F, 1e-3F);
  EXPECT_NEAR(board.length_m, 0.7F / std::sqrt(12.F), 2e-3F);  // 70 pixels of 1 cm
  EXPECT_NEAR(board.slant, 1.F, 1e-3F);
  EXPECT_NEAR(board.bend_m, 0.F, 1e-3F);
  EXPECT_NEAR(board.ragged, 2.F * (60.F + 70.F) / std::sqrt(4200.F), 1e-3F);
}

TEST(GatherEvidence, MeasuresHowASurfaceBendsAndSlants) {
  // A cylinder of 0.3 m about a vertical axis: 15 cm to the side it is 0.3 - sqrt(0.3^2 - 0.15^2) m further at its
  // front, and more at its sides; along the axis it is straight.
  const auto cylinder = [](int u, int) {
    const double x = std::min(0.299, std::abs(u - 99.5) * 0.01);
    return 2.0 - std::sqrt(0.09 - x * x);
  };
  const double least = 0.5 * (0.3 - std::sqrt(0.09 - 0.0225));
  EXPECT_GT(of_surface(cylinder).bend_m, 0.8 * least);
  EXPECT_LT(of_surface(cylinder).bend_m, 0.06);
  // A plane that recedes steeply to the right.
  const Evidence steep = of_surface([](int u, int) { return 2.0 / (1.0 - 1.5 * (u - 99.5) / 200.0); });
  EXPECT_LT(steep.slant, 0.65F);
  EXPECT_NEAR(steep.depth_m, 0.F, 2e-3F);
}

}  // namespace
}  // namespace vesalius
