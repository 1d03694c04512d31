#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "console/source_flags.h"
#include "console/text_sink.h"
#include "export/people_record.h"
#include "export/stand_upright.h"
#include "export/write_people.h"
#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "io/files/depth_picture.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/open_recording.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

struct ExportArguments {
  std::string people, to, format, joints, images;
  std::optional<int> person;
  bool on_floor = true;
  RecordOptions record;
  bool quiet = false;
};

/// Returns the lines of people in an MCAP file that `vesalius record --people` wrote.
std::string lines_of_mcap(const std::string& path, bool quiet) {
  const std::unique_ptr<Recording> recording = open_recording(path);
  std::optional<std::size_t> wanted;
  const std::vector<RecordedTopic>& topics = recording->topics();
  for (std::size_t t = 0; t < topics.size(); ++t) {
    if (!topics[t].name.ends_with("/people/json") || topics[t].type != "std_msgs/String") continue;
    if (wanted) throw Error(fmt::format("{}: people of several cameras, expected those of one", path));
    wanted = t;
  }
  if (!wanted) throw Error(fmt::format("{}: no people in it, expected a recording of record --people", path));
  std::string lines;
  while (const auto message = recording->next()) {
    if (message->topic != *wanted) continue;
    lines += MessageFields(message->bytes, topics[*wanted].layout, path).text("data");
    lines += '\n';
  }
  if (!quiet) {
    for (const std::string& note : recording->notes()) say("note: " + note);
  }
  return lines;
}

/// Returns the format that is asked for, or that the file's name tells.
const ExportFormat& format_of(const ExportArguments& arguments) {
  if (arguments.to == "-") throw UsageError("--to expects the name of a file; /dev/stdout is standard output");
  const std::string extension = fs::path(arguments.to).extension().string();
  std::vector<std::string> endings;
  for (const ExportFormat& format : export_formats()) {
    if (!format.ending.empty()) endings.push_back(format.ending);
    const bool named = arguments.format.empty() && !extension.empty() && format.ending == extension;
    if (named || format.name == arguments.format) return format;
  }
  const std::string last = endings.back();
  endings.pop_back();
  throw UsageError(fmt::format("{}: expected a name that ends in {} or {}, or --format", arguments.to,
                               fmt::join(endings, ", "), last));
}

/// A file for one of several people: name.csv becomes name-3.csv.
std::string path_of(const std::string& path, int person) {
  fs::path file(path);
  const std::string name = fmt::format("{}-{}{}", file.stem().string(), person, file.extension().string());
  return file.replace_filename(name).string();
}

struct File {
  std::string path, bytes;
};

/// Returns the set that is asked for, or the format's usual one, or without that the first.
std::size_t find_set(const PeopleRecord& record, const ExportArguments& arguments, const ExportFormat& format) {
  if (record.sets.empty()) throw Error(arguments.people + ": nobody in any frame");
  if (!arguments.joints.empty()) return record.find_set(arguments.joints);
  return std::ranges::count(record.sets, format.joints) > 0 ? record.find_set(format.joints) : 0;
}

/// Finds the picture of each frame in a folder, by its name. The pixels of people are those of depth.
void find_pictures(const std::string& folder, PeopleRecord& record) {
  for (RecordedFrame& frame : record.frames) {
    for (const char* ending : {".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG"}) {
      if (frame.picture.empty() && fs::exists(fs::path(folder) / (frame.name + ending))) {
        frame.picture = frame.name + ending;
      }
    }
    if (frame.picture.empty()) {
      throw Error(fmt::format("{}: no picture of frame {}, expected {}.png or .jpg", folder, frame.name, frame.name));
    }
  }
  const RecordedFrame& first = record.frames.front();
  const std::string path = (fs::path(folder) / first.picture).string();
  if (may_be_depth(path)) throw Error(path + ": a picture of 16 bits, expected colour or grey of 8");
  const ColourImage picture = read_colour(path);
  if (picture.width() != first.camera.width || picture.height() != first.camera.height) {
    throw Error(
        fmt::format("{}: {}x{} pixels, expected {}x{} as depth has, whose pixels people are given in; detect "
                    "--out DIR --save colour writes such pictures",
                    path, picture.width(), picture.height(), first.camera.width, first.camera.height));
  }
}

std::vector<File> make_files(const ExportArguments& arguments, const ExportFormat& format) {
  const bool is_mcap = arguments.people.ends_with(".mcap");
  const std::string lines = is_mcap ? lines_of_mcap(arguments.people, arguments.quiet) : read_file(arguments.people);
  PeopleRecord record = parse_people(lines, arguments.people, arguments.record);
  if (format.stands && arguments.on_floor && !stand_upright(record)) {
    record.notes.push_back(arguments.people +
                           ": no floor is known; places are those of the camera, however it is tilted");
  }
  if (!arguments.images.empty()) find_pictures(arguments.images, record);
  if (!arguments.quiet) {
    for (const std::string& note : record.notes) say("note: " + note);
  }
  ExportRequest request{0, arguments.person, "", arguments.people};
  if (!format.joints.empty()) request.set = find_set(record, arguments, format);
  return with_context(arguments.people, [&] {
    std::vector<std::optional<int>> people{arguments.person};
    if (format.files != nullptr && !arguments.person) {
      const std::vector<int> all = format.files(record);
      people.assign(all.begin(), all.end());
    }
    std::vector<File> files;
    for (const std::optional<int>& person : people) {
      const std::string path = people.size() > 1 ? path_of(arguments.to, *person) : arguments.to;
      request.person = person;
      request.name = fs::path(path).filename().string();
      files.push_back({path, format.write(record, request)});
    }
    return files;
  });
}

void run_export(const ExportArguments& arguments) {
  const ExportFormat& format = format_of(arguments);
  if (arguments.person && !format.of_one)
    throw UsageError("--person goes with trc, bvh and glb: the others have all people");
  if (!arguments.images.empty() && format.name != "coco") throw UsageError("--images goes with coco");
  for (const File& file : make_files(arguments, format)) {
    write_file_atomically(file.path, file.bytes);
    if (!arguments.quiet) say(fmt::format("{}: {} bytes", file.path, file.bytes.size()));
  }
}

}  // namespace

void add_export(CLI::App& program) {
  CLI::App* command = program.add_subcommand("export", "Write people in the formats of other programs");
  const auto arguments = std::make_shared<ExportArguments>();
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) names.push_back(format.name);
  command->add_option("PEOPLE", arguments->people, "What detect --json wrote, or an MCAP file of record --people")
      ->required();
  command
      ->add_option("--to", arguments->to,
                   "File to write: .csv (a table), .trc (OpenSim), .bvh or .glb (animation; people need fitted bodies, "
                   "detect --track); others with --format. Of several people .trc and .bvh take a file each, NAME-ID")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--format", arguments->format, "csv, trc, bvh, glb, coco (keypoints), k4abt (Azure Kinect's JSON)")
      ->check(CLI::IsMember(names))
      ->type_name("NAME");
  command
      ->add_option("--joints", arguments->joints,
                   "Joint set of csv, trc and coco (default: coco17 for coco, else k4abt32)")
      ->type_name("SET");
  command
      ->add_option(
          "--images", arguments->images,
          "Folder with the frames' pictures, PNG or JPEG, which coco names (default: FRAME.png, as detect --out "
          "DIR --save colour writes them into DIR/colour)")
      ->type_name("DIR");
  command->add_option("--person", arguments->person, "Only the person with this id, in trc, bvh or glb")
      ->type_name("ID");
  add_places_flag(*command, "--frame", arguments->on_floor, "Whose places csv, trc, bvh and glb have");
  command->add_flag("--smoothed", arguments->record.smoothed, "Smoothed joints, where people were followed");
  command->add_option("--rate", arguments->record.rate_hz, "Frames a second where frames have no times")
      ->type_name("HZ")
      ->check(CLI::Range(0.01, 10000.0))
      ->capture_default_str();
  command->add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  command->footer(R"(
On the floor and in trc (millimetres), bvh (centimetres) and glb (metres) y is up and z points towards the camera; csv (metres) with --frame camera
and k4abt (millimetres) have the optical frame: x right, y down, z away.

Examples:
  vesalius detect frames/ --track --json people.jsonl
  vesalius export people.jsonl --to people.csv
  vesalius export people.jsonl --to walk.bvh --person 1
  vesalius export session.mcap --to keypoints.json --format coco
  vesalius export people.jsonl --to keypoints.json --format coco --images frames/rgb)");
  command->callback([arguments] { run_export(*arguments); });
}

}  // namespace vesalius::cli
