#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/boosted_trees.h"
#include "vesalius/forest.h"
#include "vesalius/labeller.h"

namespace vesalius {

struct Network;

/// What a model file holds (vesalius/model_file.h) and a Detector takes: a body, what labels pixels with its parts, and
/// what makes more of the labels.
struct Model {
  Model() = default;
  /// A forest as training returns it; its regression of headings becomes the model's.
  Model(Forest trained);  // NOLINT(google-explicit-constructor)
  /// A labeller of your own needs no more than itself, where it labels the paper's parts.
  template <std::derived_from<Labeller> Own>
  Model(std::shared_ptr<Own> own, BodyModel of = paper_body())  // NOLINT(google-explicit-constructor)
      : body(std::move(of)), labeller(std::move(own)) {}

  BodyModel body;
  Forest forest;                             ///< trees that label pixels, until on_device makes a labeller of them
  std::shared_ptr<const Network> network;    ///< or a network that labels them in place of trees; until then
  std::shared_ptr<const Labeller> labeller;  ///< null until then
  FacingModel headings;  ///< how a person's heading follows from the headings of pixels; may be empty
  BoostedTrees context;  ///< which pixels are bodies, given what is around them (body_context.h); may be empty
  BoostedTrees judge;    ///< which proposals are people (score_person.h); empty: default_judge
};

/// Throws Error if the forest or the network is inconsistent, if it has other parts than the body, if there are both,
/// or if a regression or boosted trees could read what is not there.
void check(const Model& model);

/// Returns how what labels the model's pixels was made: the recipe of its forest or network.
const std::string& labeller_recipe(const Model& model);

/// A kind of device besides the processor that labels pixels.
struct LabellerDevice {
  std::string name;  ///< as users write it: "cuda"
  /// Returns a labeller of the model's forest or network on device `number`, from 0 on, of this kind. Throws Error for
  /// an inconsistent one and DeviceError where the device is not there or cannot take it.
  std::function<std::shared_ptr<const Labeller>(const Model& model, int number)> make;
};

/// The name of a device in parts: "cuda:1" is number 1 of kind "cuda".
struct DeviceName {
  std::string kind;
  int number = 0;
};
/// Returns an empty kind for what is no name of a device.
DeviceName parse_device(const std::string& name);

/// The devices that a program was built with, and where it hears of what "auto" decided.
struct LabellerDevices {
  std::vector<LabellerDevice> kinds;
  std::function<void(const std::string&)> note = {};  ///< may be called from any thread
};

/// Throws UsageError, which says what is known.
[[noreturn]] void throw_unknown_device(const std::string& device, const LabellerDevices& devices);

/// Returns the model with a labeller in place of its forest or network, on `device`:
///   "cpu"               the processor
///   "NAME", "NAME:N"    the first or N-th device (from 0 on) of a kind, e.g. "cuda:1"
///   "auto"              the first device that can be had, otherwise the processor. A device that fails later is left
///                       for good, with a note, and its pictures are labelled on the processor: with a gate above 1 the
///                       same bits.
/// A labeller that is there already stays. A forest without a background class is shown cut-outs (CutOutLabeller), and
/// judged by default_judge_of_cut_outs if the model has no judge. Throws Error for an inconsistent model, UsageError
/// for a device that this build does not know and DeviceError for one that this machine does not have.
Model on_device(Model model, const std::string& device = "cpu", const LabellerDevices& devices = {});

}  // namespace vesalius
