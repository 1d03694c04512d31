// Draws the people in the frames of a folder: MODEL FOLDER OUT.

#include <filesystem>
#include <iostream>

#include "vesalius/detect.h"
#include "vesalius/draw.h"
#include "vesalius/image_file.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const vesalius::Detector detector(vesalius::load_model(argv[1]));
  const auto source = vesalius::open_source(argv[2]);
  std::filesystem::create_directories(argv[3]);
  while (const auto frame = source->next()) {
    const std::string path = std::string(argv[3]) + "/" + frame->name + ".png";
    vesalius::write_png(vesalius::draw_people(*frame, detector.detect(*frame), detector.body()), path);
    std::cout << path << '\n';
  }
}
