#include "cluster/train_job.h"

#include <utility>

#include "cluster/message.h"
#include "io/files/options_file.h"

namespace vesalius {
namespace {

std::string toml_of(TrainOptions options) {
  return options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
}

}  // namespace

void visit_fields(auto& visit, Is<FeatureConvention> auto& of) {
  visit("offset unit", of.offset_unit)("focal length", of.reference_focal_px)("hole", of.hole_mm);
  visit("outside", of.outside_mm)("clip", of.clip_mm);
}
/// All but its body.
void visit_fields(auto& visit, Is<Forest> auto& of) {
  visit("convention", of.convention)("background", of.has_background)("trees", of.trees);
  visit("headings", of.headings)("unit of logits", of.logit_unit);
}

std::vector<NodeRange> row_groups(const std::vector<LevelNode>& nodes, const SplitOptions& options) {
  return node_runs({0, static_cast<std::int32_t>(nodes.size())}, options.split_pixels,
                   [&](std::int32_t n) { return nodes[n].counted; });
}

std::string set_name(const std::string& sets, std::size_t shard) { return fmt::format("{}/{:06}", sets, shard); }

std::string job_folder(const std::string& name) { return "jobs/" + name; }

std::string job_file(const std::string& name) { return job_folder(name) + "/job"; }

std::string serialise(const TrainJob& job) {
  MessageWriter out;
  out("build", program_build())("body", job.forest.body.toml)("options", toml_of(job.options))("job", job);
  return sealed(out.bytes());
}

TrainJob parse_train_job(std::string_view bytes, const std::string& name) {
  const std::string message = opened(bytes, name);
  MessageReader in(message, name);
  std::string build, body, options;
  in("build", build);
  expect_this_build(build, name);
  TrainJob job;
  in("body", body);
  job.forest.body = parse_body_model(body, name);
  in("options", options);
  parse_options(options, name, [&](OptionVisitor& visitor) { visit_options("", job.options, visitor); });
  in("job", job);
  in.expect_end();
  if (job.kind > JobKind::kFacing) in.fail("kind of job");
  if (job.first_frames.empty()) in.fail("no shards");
  return job;
}

}  // namespace vesalius
