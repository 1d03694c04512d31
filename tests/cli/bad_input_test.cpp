#include <gmock/gmock.h>

#include <cstdlib>
#include <string_view>

#include "io/model/model_sections.h"
#include "run_program.h"
#include "small_world.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

class BadInput : public SmallWorld {
 protected:
  /// Expects one line on standard error, perhaps with what a source holds below it, indented, nothing on standard
  /// output and no file left behind.
  static void expect_refused(const Outcome& run, int exit_code, const std::string& reason) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, StartsWith("vesalius: "));
    EXPECT_THAT(run.err, HasSubstr(reason));
    const std::string_view message = run.err;
    for (auto end = message.find('\n'); end + 1 < message.size(); end = message.find('\n', end + 1)) {
      EXPECT_EQ(message.substr(end + 1, 2), "  ") << run.err;
    }
    EXPECT_TRUE(message.ends_with('\n')) << run.err;
  }
  static void detect(const std::string& source, const std::string& used_model, const std::string& more, int exit_code,
                     const std::string& reason) {
    SCOPED_TRACE(source + " " + used_model + more);
    expect_refused(run_program("detect " + source + " -q -m " + used_model + more), exit_code, reason);
  }
};

TEST_F(BadInput, DamagedModelsAreRefused) {
  const std::string good = bytes_of(model());
  write("cut.forest", good.substr(0, good.size() / 2));
  std::string newer = good;
  newer[8] = static_cast<char>(kModelVersion + 1);
  write("newer.forest", newer);
  std::string damaged = good;
  damaged[good.size() / 2] = static_cast<char>(damaged[good.size() / 2] ^ 1);
  write("damaged.forest", damaged);
  write("empty.forest", "");
  write("text.forest", "20\n 1 2 3 4 5\n");
  detect(frames(), path("none.forest"), "", 1, "none.forest");
  detect(frames(), path(""), "", 1, "");
  detect(frames(), path("cut.forest"), "", 1, "truncated, ");
  detect(frames(), path("newer.forest"), "", 1, "written by a newer version: format 4, this program reads 3");
  detect(frames(), path("damaged.forest"), "", 1, "checksum does not match");
  detect(frames(), path("empty.forest"), "", 1, "empty file");
  detect(frames(), path("text.forest"), "", 1, "not a vesalius model");
}

TEST_F(BadInput, DamagedBodiesAreRefused) {
  std::string other = bytes_of(std::string(VESALIUS_SOURCE_DIR) + "/data/bodies/paper25.toml");
  for (std::size_t at = 0; (at = other.find("\"neck\"", at)) != std::string::npos; ++at)
    other.replace(at, 6, "\"nape\"");
  write("other.toml", other);
  write("broken.toml", "name = \n");
  detect(frames(), model(), " --body " + path("other.toml"), 1, "part 10 is nape, in the model neck");
  detect(frames(), model(), " --body " + path("broken.toml"), 1, "broken.toml:1: not valid TOML");
}

TEST_F(BadInput, DamagedFramesAreRefused) {
  fs::create_directories(path("empty"));
  write_png(Image<std::uint8_t>(320, 240, 9), path("eight.png"));
  write_png(Image<std::uint16_t>(123, 77, 2000), path("odd.png"));
  fs::copy(frames(), path("mixed"), fs::copy_options::recursive);
  write_png(Image<std::uint16_t>(64, 48, 2000), path("mixed/depth/b.png"));
  detect(path("nowhere"), model(), "", 1, "nowhere");
  detect(path("empty"), model(), "", 1, "empty");
  detect(path("eight.png"), model(), " --fx 500", 1, "eight.png");
  detect(path("odd.png"), model(), "", 1, "odd.png");
  detect(path("mixed"), model(), "", 1, "b.png: 64x48 pixels");
}

TEST_F(BadInput, InvalidOptionsAreRefused) {
  write("unknown.toml", "serach.min-parts = 3\n");
  write("range.toml", "search.min-parts = 0\n");
  std::string deep = "a";
  for (int i = 0; i < 50000; ++i) deep += ".a";
  write("deep.toml", deep + " = 1\n");
  detect(frames(), model(), " --options " + path("deep.toml"), 1, "deep.toml: 100006 bytes, expected at most 16384");
  detect(frames(), model(), " --options " + path("unknown.toml"), 1, "did you mean \"search.min-parts\"?");
  detect(frames(), model(), " --options " + path("range.toml"), 1, "range.toml:1: option search.min-parts is 0");
  detect(frames(), model(), " --search.min-parts 0", 2, "option search.min-parts is 0");
  detect(frames(), model(), " --cluster.max-gap nan", 2, "option cluster.max-gap is nan");
  detect(frames(), model(), " --search.min-parts few", 2, "few");
}

TEST_F(BadInput, InvalidCommandLinesAreRefused) {
  detect(frames(), model(), " --save mask", 2, "--save needs --out");
  detect(frames(), model(), " --out x --save masks", 2, "masks");
  detect(frames(), model(), " --threads -1", 2, "--threads");
  for (const char* value : {"0", "-1", "nan", "inf", "1e30"}) {
    detect(frames(), model(), std::string(" --fx ") + value, 2, "\"fx\": expected a positive number of pixels");
  }
  detect(frames(), model(), " --cx nan", 2, "\"cx\": expected a number of pixels");
  detect(frames(), model(), " --depth-scale 0", 2, "\"depth_scale\": expected stored units per metre");
  detect(frames(), model(), " --out ''", 2, "--out: expected a value, found none");
  detect("''", model(), "", 2, "SOURCE: expected a value, found none");
  detect(frames(), model(), " --depth-bits upside", 2, "--depth-bits: upside not in {plain,rotated,swapped}");
  detect(frames(), model(), " --search.min-parts few", 2, "--search.min-parts: few is not a value of it, expected a");
  detect(frames(), model(), " --jsno -", 2, "unknown argument --jsno, did you mean --json?");
  detect("", model(), "", 2, "SOURCE is required");
  expect_refused(run_program("detcet"), 2, "unknown argument detcet, did you mean detect?");
  expect_refused(run_program("convert one.txt two.txt"), 2, "two.txt: expected a name that ends in .forest");
  expect_refused(run_program("convert a b c --to tum"), 2, "--to expects a source and one folder");
}

TEST_F(BadInput, PlacesThatCannotBeWrittenAreRefused) {
  write("file", "");
  detect(frames(), model(), " --json /dev/full", 1, "/dev/full: cannot be written: No space left on device");
  detect(frames(), model(), " --json " + path("no/such/folder.jsonl"), 1, "folder.jsonl");
  detect(frames(), model(), " --out " + path("file"), 1, "file: cannot make the folder");
  expect_refused(run_program("options >/dev/full"), 1, "standard output: cannot be written: No space left on device");
  expect_refused(run_program("--help >/dev/full"), 1, "standard output: cannot be written");
}

TEST_F(BadInput, FailedOutputIsAnError) {
  expect_refused(run_program("detect " + frames() + " -m " + model() + " >/dev/full"), 1,
                 "standard output: cannot be written: No space left on device");
}

TEST_F(BadInput, NamesDoNotControlTheTerminal) {
  fs::create_directories(path("odd"));
  write("odd/depth.txt", "1 \x1b[31m.png\n");
  detect(path("odd"), model(), " --fx 50", 1, "/odd/ [31m.png: cannot be read");
}

TEST_F(BadInput, PicturesOfDifferentFramesDoNotReplaceEachOther) {
  fs::copy(frames(), path("twins"), fs::copy_options::recursive);
  fs::copy(path("twins/depth/a.png"), path("twins/depth/a.PNG"));
  detect(path("twins"), model(), " --out " + path("twins_out"), 1, "frame \"a\": its pictures would replace");
}

TEST_F(BadInput, FilesOverTheShellsLimitAreRemoved) {
  const std::string command = "ulimit -f 1; '" VESALIUS_PROGRAM "' detect " + frames() + " -q -m " + model() +
                              " --json " + path("limited.jsonl") + " 2>" + path("limited.err");
  EXPECT_NE(std::system(("(" + command + ")").c_str()), 0);
  EXPECT_THAT(bytes_of(path("limited.err")), HasSubstr("limited.jsonl: cannot be written: File too large"));
  for (const auto& entry : fs::directory_iterator(path(""))) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("limited.jsonl")) << entry.path();
  }
}

TEST_F(BadInput, InterruptsKeepFinishedFramesOnly) {
  std::string list;  // takes longer than the test
  for (int i = 0; i < 100000; ++i) list += std::to_string(i) + " ../frames/depth/c.png\n";
  fs::create_directories(path("long"));
  write("long/depth.txt", list);
  // The signal is sent after the first output appears, however slow the machine is. It is not SIGINT, because a shell
  // makes background programs ignore that one, and the program respects this.
  const auto interrupted = [](const std::string& signal, const std::string& arguments, const std::string& outputs) {
    const std::string err = path("interrupted.err");
    const std::string command =
        "'" VESALIUS_PROGRAM "' " + arguments + " -q 2>" + err + " & pid=$!; i=0; while [ $i -lt 1000 ] && ! ls -A " +
        outputs + " 2>/dev/null | grep -q .; do sleep 0.1; i=$((i + 1)); done; kill -" + signal + " $pid; wait $pid";
    EXPECT_NE(std::system(command.c_str()), 0);
    EXPECT_THAT(bytes_of(err), HasSubstr("interrupted after"));
  };
  fs::create_directories(path("stopped"));
  for (const std::string signal : {"TERM", "HUP"}) {
    interrupted(signal, "detect " + path("long") + " --fx 262 -m " + model() + " --json " + path("stopped/p.jsonl"),
                path("stopped"));
    const std::string people = bytes_of(path("stopped/p.jsonl"));
    EXPECT_THAT(people, HasSubstr("{\"complete\":false,\"frames\":")) << signal;
    EXPECT_THAT(people, HasSubstr("\"why\":\"interrupted after")) << signal;
    EXPECT_TRUE(people.ends_with("}\n"));
    EXPECT_EQ(std::distance(fs::directory_iterator(path("stopped")), {}), 1) << "nothing half written";
    fs::remove(path("stopped/p.jsonl"));
  }
  interrupted("TERM", "convert " + path("long") + " " + path("converted") + " --fx 262 --to folder", path("converted"));
}

TEST_F(BadInput, AClosedPipeEndsTheProgramQuietly) {
  const Outcome run = run_program("detect " + frames() + " -m " + model() + " -q --json - | true");
  EXPECT_EQ(run.err, "");
}

}  // namespace
}  // namespace vesalius
