#include "io/model/old_model.h"

#include <fmt/format.h>

#include "io/files/byte_stream.h"
#include "io/model/model_contents.h"
#include "io/model/model_sections.h"

namespace vesalius {
namespace {

constexpr std::size_t kChecksumAt = 20;
constexpr std::size_t kOldHeaderBytes = 28;  // magic, version, flags, size, checksum
// The first two flags are those of a forest (model_contents.h).
constexpr unsigned kForestFlags = kForestBackground | kForestLogits;
constexpr unsigned kJudge = 4, kContext = 8, kNames = 16;

}  // namespace

Model parse_old_model(std::string_view bytes, const std::string& name) {
  ByteReader in(bytes, name);
  in.take(10, "header");
  const auto flags = in.number<std::uint16_t>("flags");
  const auto size = in.number<std::uint64_t>("size");
  if (bytes.size() != size) throw Error(fmt::format("{}: damaged model, {} of {} bytes", name, bytes.size(), size));
  if (in.number<std::uint64_t>("checksum") != xxh64(bytes.substr(0, kChecksumAt), bytes.substr(kOldHeaderBytes))) {
    throw Error(name + ": damaged model, the checksum does not match");
  }
  Model model;
  Forest& forest = model.forest;
  model.body = parse_body_model(in.text("body model"), name + ": body model");
  forest.body = model.body;
  forest.recipe = in.text("recipe");
  read_forest(in, flags & kForestFlags, forest);
  if ((flags & kForestLogits) != 0) model.headings = read_headings(in, forest.headings, model.body.part_count());
  const bool names = (flags & kNames) != 0;
  if ((flags & kContext) != 0) model.context = read_boosted(in, "context of bodies", names);
  if ((flags & kJudge) != 0) model.judge = read_boosted(in, "judge of people", names);
  in.expect_end();
  with_context(name, [&] { check(model); });
  return model;
}

}  // namespace vesalius
