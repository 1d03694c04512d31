#pragma once

#include <string>

#include "cluster/map_task.h"
#include "commands/train/train_inputs.h"

namespace vesalius::cli {

/// Returns the sources of frames as text for the tasks of a cluster. Recipes and body are in it; datasets and motions
/// are named by absolute paths and must be there on every machine.
std::string frames_text(const TrainSources& sources, const TrainInputs& inputs);

/// Opens what such a text names; frames are numbered over all inputs. Throws Error for a source that this machine lacks
/// or whose frames would be others than on the machine that wrote the text.
TaskContext::ReadFrame open_frames(const std::string& text);

}  // namespace vesalius::cli
