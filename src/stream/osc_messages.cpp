#include "stream/osc_messages.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "vesalius/body_model.h"
#include "vesalius/track/track_floor.h"

namespace vesalius {
namespace {

/// An Ethernet packet's data without the heads of IP and UDP.
constexpr std::size_t kMostBundle = 1432;

/// Texts end with a zero and fill whole words.
void append_text(std::string& to, std::string_view text) {
  to.append(text);
  to.append(4 - text.size() % 4, '\0');
}

void append_word(std::string& to, std::uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8) to += static_cast<char>(word >> shift & 255U);
}

/// Packs messages into as few bundles as they need.
class Bundles {
 public:
  void add(const OscMessage& message) {
    const std::string bytes = message.bytes();
    if (bundles_.empty() || bundles_.back().size() + 4 + bytes.size() > kMostBundle) {
      bundles_.emplace_back();
      append_text(bundles_.back(), "#bundle");
      append_word(bundles_.back(), 0);
      append_word(bundles_.back(), 1);  // the time tag that means at once
    }
    append_word(bundles_.back(), static_cast<std::uint32_t>(bytes.size()));
    bundles_.back() += bytes;
  }
  std::vector<std::string> take() { return std::move(bundles_); }

 private:
  std::vector<std::string> bundles_;
};

/// Adds a place with y up and z towards the camera.
OscMessage& add_place(OscMessage& message, const Eigen::Isometry3f& from_optical, const Eigen::Vector3f& optical) {
  const Eigen::Vector3f at = from_optical * optical;
  return message.add(at.x()).add(-at.y()).add(-at.z());
}

}  // namespace

OscMessage::OscMessage(std::string_view address) { append_text(address_, address); }

OscMessage& OscMessage::add(std::int32_t value) {
  types_ += 'i';
  append_word(values_, static_cast<std::uint32_t>(value));
  return *this;
}

OscMessage& OscMessage::add(float value) {
  types_ += 'f';
  append_word(values_, std::bit_cast<std::uint32_t>(value));
  return *this;
}

OscMessage& OscMessage::add(std::string_view text) {
  types_ += 's';
  append_text(values_, text);
  return *this;
}

std::string OscMessage::bytes() const {
  std::string all = address_;
  append_text(all, types_);
  return all + values_;
}

std::vector<std::string> osc_bundles(const TrackedFrame& people, const BodyModel& body, const OscOptions& options) {
  const std::size_t set = find_joint_set(body, options.joints);
  const JointSet& names = body.joint_sets[set];
  const bool stands = options.on_floor && people.floor.has_value();
  const Eigen::Isometry3f from_optical = stands ? floor_from_optical(*people.floor) : Eigen::Isometry3f::Identity();
  Bundles bundles;
  OscMessage all("/vesalius/people");
  all.add(static_cast<std::int32_t>(people.people.size()));
  for (const TrackedPerson& person : people.people) all.add(person.id);
  bundles.add(all);
  for (const TrackedPerson& person : people.people) {
    const std::string address = fmt::format("/vesalius/{}/", person.id);
    bundles.add(OscMessage(address + "state").add(to_string(person.state)));
    if (people.followed) {
      OscMessage position(address + "position");
      bundles.add(add_place(position, from_optical, person.position));
    }
    const std::vector<Joint>& joints = person.person.joints[set];
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (joints[j].state == State::none) continue;
      OscMessage message(address + names.joints[j].name);
      bundles.add(add_place(message, from_optical, joints[j].position).add(joints[j].confidence));
    }
  }
  return bundles.take();
}

}  // namespace vesalius
