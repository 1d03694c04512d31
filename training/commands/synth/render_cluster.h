#pragma once

#include <string>

#include "commands/cluster/cluster_flags.h"
#include "commands/synth/frame_maker.h"
#include "commands/synth/synth_recipe.h"
#include "dataset/labelled_dataset.h"

namespace vesalius::cli {

/// What is rendered, as tasks on other machines need it.
struct RenderRequest {
  synth::Recipe recipe;
  BodyModel body;
  AssetPlaces places;
  ClipRequest clip;
};

/// Renders the shards that a dataset lacks as one job of map tasks, and puts them into `folder`: the files are those of
/// one process. Throws Error as DatasetWriter and Engine::run do.
void render_on_cluster(const RenderRequest& request, const DatasetInfo& info, const std::string& folder,
                       const ClusterFlags& flags, bool shown);

/// Adds `vesalius synth map`, the task.
void add_render_task(CLI::App& synth);

}  // namespace vesalius::cli
