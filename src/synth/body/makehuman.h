#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/surface_parts.h"
#include "synth/text/read_text.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// What a MakeHuman body looks like. Values outside their range are taken as the nearest within.
struct MakeHumanFactors {
  float gender = 0.5F;       ///< 0 woman, 1 man
  float age_years = 30.F;    ///< 10 child, 25 young, 90 old; younger children are small ones of 10
  float muscle = 0.5F;       ///< 0-1
  float weight = 0.5F;       ///< 0 thin, 1 heavy
  float height = 0.5F;       ///< 0-1: short to long limbs for the age
  float proportions = 0.5F;  ///< 0-1: towards ideal above 0.5
  float african = 1.F / 3.F, asian = 1.F / 3.F, caucasian = 1.F / 3.F;  ///< shares; any sum above 0
  float stature_m = 0.F;  ///< height the body is scaled to; 0: as the factors make it
};

/// A person at random: age 5 to 85, stature within 2.5 standard deviations of its age and sex.
MakeHumanFactors sample_factors(Random& random);

/// MakeHuman's base mesh, morph targets, rig and weights (CC0), ready to make bodies of.
class MakeHumanModel {
 public:
  /// Paths of files as `read` takes them.
  struct Files {
    std::string mesh;                  ///< 3dobjs/base.obj
    std::string skeleton;              ///< rigs/default.mhskel
    std::string weights;               ///< rigs/default_weights.mhw
    std::vector<std::string> targets;  ///< targets/macrodetails/**.target; their names say when they apply
  };
  /// The files below MakeHuman's folder `data`, given what targets there are.
  static Files files(const std::string& data_folder, std::vector<std::string> targets);

  /// Throws Error naming file and place for anything that does not fit together.
  MakeHumanModel(const ReadText& read, const Files& files);
  ~MakeHumanModel();
  MakeHumanModel(const MakeHumanModel&) = delete;
  MakeHumanModel& operator=(const MakeHumanModel&) = delete;

  /// Bytes that the targets take.
  std::size_t target_bytes() const;

 private:
  friend BodyMesh make_body(const MakeHumanModel&, const MakeHumanFactors&, const BodyModel&);
  struct State;
  std::unique_ptr<const State> state_;
};

std::shared_ptr<const MakeHumanModel> load_makehuman(const ReadText& read, const MakeHumanModel::Files& files);

/// The body of these factors, labelled by the surface rules of `body`, its feet on y = 0. Safe to call from several
/// threads.
BodyMesh make_body(const MakeHumanModel& model, const MakeHumanFactors& factors, const BodyModel& body);

}  // namespace vesalius::synth
