#pragma once

#include <string>
#include <vector>

#include "io/recordings/open_recording.h"

namespace vesalius::test {

/// Returns the texts (std_msgs/String of ROS 2) of a topic of a recording.
inline std::vector<std::string> recorded_texts(const std::string& path, const std::string& topic) {
  constexpr std::size_t kHead = 8;  // of CDR, and the text's length, which counts a 0 at the end
  std::vector<std::string> texts;
  const std::unique_ptr<Recording> recording = open_recording(path);
  while (const auto message = recording->next()) {
    if (recording->topics().at(message->topic).name != topic) continue;
    texts.emplace_back(message->bytes.substr(kHead, message->bytes.size() - kHead - 1));
  }
  return texts;
}

}  // namespace vesalius::test
