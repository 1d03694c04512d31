// People in the frames of a folder: detect_people MODEL SOURCE.

#include <iostream>

#include "vesalius/detect.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const vesalius::Detector detector(vesalius::load_model(argv[1]));
  const auto source = vesalius::open_source(argv[2]);
  while (const auto frame = source->next())
    for (const vesalius::Person& person : detector.detect(*frame))
      std::cout << frame->name << ": " << person.skeleton.found << " parts\n";
}
