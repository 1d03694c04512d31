#pragma once

#include <memory>
#include <string>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/population.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

/// MakeHuman's base mesh, morph targets, rig and weights (CC0), from which bodies are made.
class MakeHumanModel {
 public:
  /// The paths of the files as `read` takes them.
  struct Files {
    std::string mesh;                  ///< 3dobjs/base.obj
    std::string skeleton;              ///< rigs/default.mhskel
    std::string weights;               ///< rigs/default_weights.mhw
    std::vector<std::string> targets;  ///< targets/macrodetails/**.target; a name says to which bodies it applies
  };
  /// Returns the files below MakeHuman's folder `data`, given the existing targets.
  static Files files(const std::string& data_folder, std::vector<std::string> targets);

  /// Throws Error naming file and place if the files are damaged or do not fit together.
  MakeHumanModel(const ReadText& read, const Files& files);
  ~MakeHumanModel();
  MakeHumanModel(const MakeHumanModel&) = delete;
  MakeHumanModel& operator=(const MakeHumanModel&) = delete;

 private:
  friend BodyMesh make_body(const MakeHumanModel&, const MakeHumanFactors&, const BodyModel&);
  struct State;
  std::unique_ptr<const State> state_;
};

/// Returns the body of these factors, labelled by the surface rules of `body`, with its feet on y = 0. It may be called
/// from several threads.
BodyMesh make_body(const MakeHumanModel& model, const MakeHumanFactors& factors, const BodyModel& body);

/// Returns bodies that need no files: MakeHuman's with a sixth of its vertices, of the mean of all peoples, muscles and
/// limbs' lengths, so that gender, age, weight and stature alone change them. tools/make_builtin_body.py makes them.
/// Left and right are exact mirror images.
const MakeHumanModel& builtin_bodies();

}  // namespace vesalius::synth
