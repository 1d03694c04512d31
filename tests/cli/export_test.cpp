#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "run_program.h"
#include "small_world.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Export : public SmallWorld {
 protected:
  /// Writes the people of the small frames, followed and fitted.
  std::string people() const {
    const std::string file = path("people.jsonl");
    const Outcome run = run_program("detect " + frames() + " --track -q --json " + file + " -m " + model());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return file;
  }
  std::string exported(const std::string& from, const std::string& name, const std::string& more = "") const {
    const Outcome run = run_program("export " + from + " -q --to " + path(name) + more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read_file(path(name));
  }
  void refused(const std::string& arguments, int exit_code, const std::string& why) const {
    const Outcome run = run_program("export " + arguments);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(why));
  }
};

TEST_F(Export, WritesEveryFormat) {
  const std::string from = people();
  EXPECT_THAT(exported(from, "p.csv"), StartsWith("frame,time_s,person,score,pelvis_x_m"));
  EXPECT_THAT(exported(from, "p.csv", " --joints nite15 --smoothed"), StartsWith("frame,time_s,person,score,head_x_m"));
  EXPECT_THAT(exported(from, "p.trc", " --person 1"), StartsWith("PathFileType\t4\t(X/Y/Z)\tp.trc\n"));
  EXPECT_THAT(exported(from, "p.bvh", " --person 1"), StartsWith("HIERARCHY\nROOT Hips\n"));
  EXPECT_THAT(exported(from, "p.glb"), StartsWith("glTF"));
  EXPECT_THAT(exported(from, "coco.json", " --format coco"), HasSubstr("\"num_keypoints\":"));
  EXPECT_THAT(exported(from, "k4abt.json", " --format k4abt"), HasSubstr("\"joint_names\":[\"PELVIS\""));
}

TEST_F(Export, NamesPicturesThatOpen) {
  const std::string from = path("people.jsonl");
  const Outcome run = run_program("detect " + frames() + " -q --json " + from + " --out " + path("found") +
                                  " --save colour -m " + model());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string images = " --format coco --images " + path("found/colour");
  const std::string coco = exported(from, "coco.json", images);
  EXPECT_EQ(coco, exported(from, "usual.json", " --format coco")) << "the usual names are those of the pictures";
  constexpr const char* kKey = "\"file_name\":\"";
  const std::size_t at = coco.find(kKey);
  ASSERT_NE(at, coco.npos);
  const std::size_t begin = at + std::string(kKey).size();
  const std::string name = coco.substr(begin, coco.find('"', begin) - begin);
  EXPECT_TRUE(std::filesystem::is_regular_file(path("found/colour/" + name))) << name;
  refused(from + " --to " + path("x.json") + " --format coco --images " + path("nothing"), 1, "no picture of frame");
  refused(from + " --to " + path("x.csv") + " --images " + path("found"), 2, "--images goes with coco");
  refused(from + " --to " + path("x.json") + " --format coco --images " + frames() + "/depth", 1, "expected colour");
  write_png(ColourImage(8, 6), path("found/colour/" + name));
  refused(from + " --to " + path("x.json") + images, 1, "pixels, expected ");
}

TEST_F(Export, TakesThePeopleOfARecording) {
  const std::string recording = path("session.mcap");
  const Outcome run = run_program("record " + frames() + " --track -q --out " + recording + " -m " + model());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(exported(recording, "mcap.glb"), exported(people(), "json.glb"));
  const std::string bare = path("bare.mcap");
  ASSERT_EQ(run_program("record " + frames() + " -q --out " + bare).exit_code, 0);
  refused(bare + " --to " + path("x.csv"), 1, "bare.mcap: no people in it");
}

TEST_F(Export, RefusesWhatItCannotReadOrWrite) {
  const std::string from = people();
  refused(from + " --to " + path("x.xyz"), 2, "expected a name that ends in .csv, .trc, .bvh or .glb");
  refused(from + " --to " + path("x.csv") + " --joints feet", 2, "joint set \"feet\" is not in the recording");
  refused(from + " --to " + path("x.csv") + " --person 1", 2, "--person goes with trc, bvh and glb");
  refused(from + " --to " + path("x.trc") + " --person 99", 1, "people.jsonl: person 99 is in no frame");
  refused(from + " --to " + path("none/x.csv"), 1, "none/x.csv: cannot be written");
  refused(path("none.jsonl") + " --to " + path("x.csv"), 1, "none.jsonl: cannot be read");
  const std::string damaged = path("damaged.jsonl");
  write_file_atomically(damaged, read_file(from).substr(0, 2000));
  refused(damaged + " --to " + path("x.csv"), 1, "damaged.jsonl: line 1: no JSON from byte");
  const Outcome single = run_program("detect " + frames() + " -q --json " + path("single.jsonl") + " -m " + model());
  ASSERT_EQ(single.exit_code, 0);
  refused(path("single.jsonl") + " --to " + path("x.bvh"), 1, "nobody has a fitted body");
  for (const char* left : {"x.csv", "x.trc", "x.bvh"}) EXPECT_FALSE(std::filesystem::exists(path(left))) << left;
}

}  // namespace
}  // namespace vesalius
