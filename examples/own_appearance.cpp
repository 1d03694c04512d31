// People grown by an appearance of one's own: own_appearance MODEL SOURCE. Cameras with a grey picture, such as an
// infrared one's, have no hue; here a person looks like steps of lightness.

#include <cstdint>
#include <iostream>
#include <memory>
#include <vector>

#include "vesalius/appearance.h"
#include "vesalius/detect.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"

namespace {

class Lightness : public vesalius::Appearance {
 public:
  int classes() const override { return 64; }

  std::vector<std::uint16_t> describe(const vesalius::Frame& frame) const override {
    std::vector<std::uint16_t> looks;
    for (const vesalius::Rgb colour : frame.colour) looks.push_back(colour.g / 4);
    return looks;
  }

  /// Neighbouring steps look alike.
  void blur(std::vector<float>& counts) const override {
    float before = 0.F;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const float here = counts[i];
      counts[i] = 0.5F * here + 0.25F * (before + (i + 1 < counts.size() ? counts[i + 1] : 0.F));
      before = here;
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const vesalius::Detector detector(vesalius::load_model(argv[1]), {}, std::make_shared<Lightness>());
  const auto source = vesalius::open_source(argv[2]);
  while (const auto frame = source->next())
    for (const vesalius::Person& person : detector.detect(*frame))
      std::cout << frame->name << ": " << person.box.width << "x" << person.box.height << " pixels\n";
}
