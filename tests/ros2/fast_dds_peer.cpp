// Another process that speaks ROS 2's types by ROS 2's usual middleware, Fast DDS. It prints a line of JSON for what it
// gets.
//
// usage: fast_dds_peer DOMAIN SECONDS ACTION...
//   listen TYPE TOPIC [latched|sensor]   prints each message; `sensor` reads as ROS 2 reads sensors, without repeats
//   relay TYPE FROM TO [metres]          publishes each message again; with `metres` depth of 16UC1 as 32FC1
//   spoil TOPIC INFO                     publishes pictures and calibrations that are not what they say, then some that
//   are
// It ends after SECONDS.

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "messagesPubSubTypes.h"

namespace {

using namespace eprosima::fastdds::dds;
using std_msgs::msg::dds_::Header_;

DomainParticipant* participant = nullptr;
Subscriber* subscriber = nullptr;
Publisher* publisher = nullptr;

std::string json_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return std::isfinite(value) ? text : "null";
}

std::string list(std::size_t count, const std::function<std::string(std::size_t)>& item) {
  std::string out = "[";
  for (std::size_t i = 0; i < count; ++i) out += (i == 0 ? "" : ", ") + item(i);
  return out + "]";
}

/// Tells bytes apart without printing them (FNV-1a).
std::string checksum(const std::vector<std::uint8_t>& bytes) {
  std::uint64_t sum = 14695981039346656037ULL;
  for (const std::uint8_t byte : bytes) sum = (sum ^ byte) * 1099511628211ULL;
  char text[20];
  std::snprintf(text, sizeof text, "\"%016llx\"", static_cast<unsigned long long>(sum));
  return text;
}

std::string stamp(const Header_& header) {
  const long long time_ns = header.stamp().sec() * 1000000000LL + header.stamp().nanosec();
  return "\"stamp_ns\": " + std::to_string(time_ns) + ", \"frame_id\": " + json_text(header.frame_id());
}

std::string describe(const sensor_msgs::msg::dds_::Image_& m) {
  return stamp(m.header()) + ", \"size\": [" + std::to_string(m.width()) + ", " + std::to_string(m.height()) +
         "], \"encoding\": " + json_text(m.encoding()) + ", \"step\": " + std::to_string(m.step()) +
         ", \"bytes\": " + std::to_string(m.data().size()) + ", \"sum\": " + checksum(m.data());
}
std::string describe(const sensor_msgs::msg::dds_::CameraInfo_& m) {
  return stamp(m.header()) + ", \"size\": [" + std::to_string(m.width()) + ", " + std::to_string(m.height()) +
         "], \"model\": " + json_text(m.distortion_model()) +
         ", \"d\": " + list(m.d().size(), [&](std::size_t i) { return number(m.d()[i]); }) +
         ", \"k\": " + list(9, [&](std::size_t i) { return number(m.k()[i]); }) +
         ", \"p\": " + list(12, [&](std::size_t i) { return number(m.p()[i]); });
}
std::string describe(const sensor_msgs::msg::dds_::PointCloud2_& m) {
  return stamp(m.header()) + ", \"size\": [" + std::to_string(m.width()) + ", " + std::to_string(m.height()) +
         "], \"fields\": " +
         list(m.fields().size(),
              [&](std::size_t i) {
                const auto& f = m.fields()[i];
                return "[" + json_text(f.name()) + ", " + std::to_string(f.offset()) + ", " +
                       std::to_string(f.datatype()) + ", " + std::to_string(f.count()) + "]";
              }) +
         ", \"point_step\": " + std::to_string(m.point_step()) + ", \"row_step\": " + std::to_string(m.row_step()) +
         ", \"dense\": " + (m.is_dense() ? "true" : "false") + ", \"bytes\": " + std::to_string(m.data().size()) +
         ", \"sum\": " + checksum(m.data());
}
std::string describe(const visualization_msgs::msg::dds_::MarkerArray_& m) {
  return "\"markers\": " + list(m.markers().size(), [&](std::size_t i) {
           const auto& one = m.markers()[i];
           return "{" + stamp(one.header()) + ", \"id\": " + std::to_string(one.id()) +
                  ", \"type\": " + std::to_string(one.type()) + ", \"points\": " + std::to_string(one.points().size()) +
                  ", \"text\": " + json_text(one.text()) + "}";
         });
}
std::string describe(const tf2_msgs::msg::dds_::TFMessage_& m) {
  return "\"transforms\": " + list(m.transforms().size(), [&](std::size_t i) {
           const auto& one = m.transforms()[i];
           const auto& t = one.transform().translation();
           const auto& q = one.transform().rotation();
           return "{" + stamp(one.header()) + ", \"child\": " + json_text(one.child_frame_id()) + ", \"t\": [" +
                  number(t.x()) + ", " + number(t.y()) + ", " + number(t.z()) + "], \"q\": [" + number(q.x()) + ", " +
                  number(q.y()) + ", " + number(q.z()) + ", " + number(q.w()) + "]}";
         });
}
std::string describe(const std_msgs::msg::dds_::String_& m) { return "\"data\": " + json_text(m.data()); }
std::string describe(const hri_msgs::msg::dds_::IdsList_& m) {
  return stamp(m.header()) + ", \"ids\": " + list(m.ids().size(), [&](std::size_t i) { return json_text(m.ids()[i]); });
}
std::string describe(const hri_msgs::msg::dds_::NormalizedRegionOfInterest2D_& m) {
  return stamp(m.header()) + ", \"box\": [" + number(m.xmin()) + ", " + number(m.ymin()) + ", " + number(m.xmax()) +
         ", " + number(m.ymax()) + "], \"c\": " + number(m.c());
}
std::string describe(const hri_msgs::msg::dds_::Skeleton2D_& m) {
  return stamp(m.header()) + ", \"joints\": " + list(18, [&](std::size_t i) {
           const auto& one = m.skeleton()[i];
           return "[" + number(one.x()) + ", " + number(one.y()) + ", " + number(one.c()) + "]";
         });
}
std::string gid(const rmw_dds_common::msg::dds_::Gid_& g) {
  std::string out;
  char text[3];
  for (const std::uint8_t byte : g.data()) {
    std::snprintf(text, sizeof text, "%02x", byte);
    out += text;
  }
  return json_text(out);
}
std::string describe(const rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_& m) {
  return "\"gid\": " + gid(m.gid()) + ", \"nodes\": " + list(m.node_entities_info_seq().size(), [&](std::size_t i) {
           const auto& node = m.node_entities_info_seq()[i];
           const auto& r = node.reader_gid_seq();
           const auto& w = node.writer_gid_seq();
           return "{\"namespace\": " + json_text(node.node_namespace().to_string()) +
                  ", \"name\": " + json_text(node.node_name().to_string()) +
                  ", \"readers\": " + list(r.size(), [&](std::size_t k) { return gid(r[k]); }) +
                  ", \"writers\": " + list(w.size(), [&](std::size_t k) { return gid(w[k]); }) + "}";
         });
}

/// Something to look after from time to time.
struct Action {
  virtual ~Action() = default;
  virtual void poll() = 0;
};

std::string on_wire(const std::string& topic) {
  return topic == "/ros_discovery_info" ? topic.substr(1) : "rt" + topic;
}

template <class PubSub>
Topic* topic_of(const std::string& name) {
  TypeSupport type(new PubSub());
  type.register_type(participant);
  if (auto* known = dynamic_cast<Topic*>(participant->lookup_topicdescription(on_wire(name)))) return known;
  return participant->create_topic(on_wire(name), type.get_type_name(), TOPIC_QOS_DEFAULT);
}

template <class PubSub>
DataReader* reader_of(const std::string& topic, const std::string& how) {
  DataReaderQos qos = DATAREADER_QOS_DEFAULT;
  qos.reliability().kind = how == "sensor" ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = how == "latched" ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().depth = 60;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  return subscriber->create_datareader(topic_of<PubSub>(topic), qos);
}

template <class PubSub>
DataWriter* writer_of(const std::string& topic) {
  DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.history().depth = 60;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;
  return publisher->create_datawriter(topic_of<PubSub>(topic), qos);
}

template <class PubSub>
class Listen final : public Action {
 public:
  Listen(std::string topic, const std::string& how)
      : topic_(std::move(topic)), reader_(reader_of<PubSub>(topic_, how)) {}
  void poll() override {
    typename PubSub::type message;
    SampleInfo info;
    while (reader_->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      std::printf("{\"topic\": %s, %s}\n", json_text(topic_).c_str(), describe(message).c_str());
    }
  }

 private:
  std::string topic_;
  DataReader* reader_;
};

void to_metres(sensor_msgs::msg::dds_::Image_& image) {
  std::vector<std::uint8_t> metres(image.data().size() * 2);
  for (std::size_t i = 0; i < image.data().size() / 2; ++i) {
    std::uint16_t depth_mm;
    std::memcpy(&depth_mm, image.data().data() + 2 * i, 2);
    const float depth_m =
        depth_mm == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(depth_mm) / 1000.F;
    std::memcpy(metres.data() + 4 * i, &depth_m, 4);
  }
  image.data(std::move(metres));
  image.step(image.step() * 2);
  image.encoding("32FC1");
}
template <class Message>
void to_metres(Message&) {}

template <class PubSub>
class Relay final : public Action {
 public:
  Relay(const std::string& from, const std::string& to, bool metres)
      : reader_(reader_of<PubSub>(from, "")), writer_(writer_of<PubSub>(to)), metres_(metres) {}
  void poll() override {
    typename PubSub::type message;
    SampleInfo info;
    while (reader_->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      if (metres_) to_metres(message);
      writer_->write(&message);
    }
  }

 private:
  DataReader* reader_;
  DataWriter* writer_;
  bool metres_;
};

class Spoil final : public Action {
 public:
  Spoil(const std::string& topic, const std::string& info)
      : pictures_(writer_of<sensor_msgs::msg::dds_::Image_PubSubType>(topic)),
        infos_(writer_of<sensor_msgs::msg::dds_::CameraInfo_PubSubType>(info)) {}

  void poll() override {
    const auto now = std::chrono::steady_clock::now();
    PublicationMatchedStatus pictures, infos;
    pictures_->get_publication_matched_status(pictures);
    infos_->get_publication_matched_status(infos);
    if (now < next_ || pictures.current_count == 0 || infos.current_count == 0) return;
    next_ = now + std::chrono::milliseconds(50);
    const int kind = std::min(sent_++ / 4, 8);
    sensor_msgs::msg::dds_::CameraInfo_ info;
    info.header().frame_id("camera");
    info.header().stamp().sec(1 + sent_);
    info.width(kWidth);
    info.height(kHeight);
    info.distortion_model("plumb_bob");
    info.k({60, 0, 32, 0, 60, 24, 0, 0, 1});
    if (kind == 0) info.k({std::nan(""), 0, 32, 0, 60, 24, 0, 0, 1});
    if (kind == 1) info.k({0, 0, 0, 0, 0, 0, 0, 0, 0});
    if (kind == 2) info.width(4000000000U);
    infos_->write(&info);
    sensor_msgs::msg::dds_::Image_ image;
    image.header(info.header());
    image.width(kWidth);
    image.height(kHeight);
    image.encoding("16UC1");
    image.step(2 * kWidth);
    image.data(std::vector<std::uint8_t>(2 * kWidth * kHeight, 8));
    if (kind == 3) image.encoding("rgb8");
    if (kind == 4) image.data().resize(100);  // shorter than its rows
    if (kind == 5) image.step(3);             // shorter than its columns
    if (kind == 6) image.height(0);
    if (kind == 7) image.width(kWidth / 2);  // not the calibration's
    pictures_->write(&image);
  }

 private:
  static constexpr std::uint32_t kWidth = 64, kHeight = 48;
  DataWriter *pictures_, *infos_;
  int sent_ = 0;
  std::chrono::steady_clock::time_point next_;
};

using Make = std::function<std::unique_ptr<Action>(const std::vector<std::string>&)>;

template <class PubSub>
void add(std::map<std::string, std::pair<Make, Make>>& types, const std::string& name) {
  types[name] = {
      [](const std::vector<std::string>& w) { return std::make_unique<Listen<PubSub>>(w[0], w[1]); },
      [](const std::vector<std::string>& w) { return std::make_unique<Relay<PubSub>>(w[0], w[1], w[2] == "metres"); }};
}

std::map<std::string, std::pair<Make, Make>> all_types() {
  std::map<std::string, std::pair<Make, Make>> types;
  add<sensor_msgs::msg::dds_::Image_PubSubType>(types, "sensor_msgs/Image");
  add<sensor_msgs::msg::dds_::CameraInfo_PubSubType>(types, "sensor_msgs/CameraInfo");
  add<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(types, "sensor_msgs/PointCloud2");
  add<visualization_msgs::msg::dds_::MarkerArray_PubSubType>(types, "visualization_msgs/MarkerArray");
  add<tf2_msgs::msg::dds_::TFMessage_PubSubType>(types, "tf2_msgs/TFMessage");
  add<std_msgs::msg::dds_::String_PubSubType>(types, "std_msgs/String");
  add<hri_msgs::msg::dds_::IdsList_PubSubType>(types, "hri_msgs/IdsList");
  add<hri_msgs::msg::dds_::NormalizedRegionOfInterest2D_PubSubType>(types, "hri_msgs/NormalizedRegionOfInterest2D");
  add<hri_msgs::msg::dds_::Skeleton2D_PubSubType>(types, "hri_msgs/Skeleton2D");
  add<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType>(types, "rmw_dds_common/ParticipantEntitiesInfo");
  return types;
}

std::vector<std::unique_ptr<Action>> parse(const std::vector<std::string>& words) {
  const auto types = all_types();
  std::vector<std::unique_ptr<Action>> actions;
  for (std::size_t i = 0; i < words.size();) {
    const std::string action = words[i++];
    const auto is_action = [](const std::string& word) {
      return word == "listen" || word == "relay" || word == "spoil";
    };
    std::vector<std::string> rest;
    while (i < words.size() && !is_action(words[i])) rest.push_back(words[i++]);
    rest.resize(4);
    if (action == "spoil") {
      actions.push_back(std::make_unique<Spoil>(rest[0], rest[1]));
      continue;
    }
    const auto& [listen, relay] = types.at(rest[0]);
    rest.erase(rest.begin());
    actions.push_back((action == "listen" ? listen : relay)(rest));
  }
  return actions;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  qos.transport().listen_socket_buffer_size = 4U << 20U;
  qos.transport().send_socket_buffer_size = 4U << 20U;
  participant =
      DomainParticipantFactory::get_instance()->create_participant(static_cast<std::uint32_t>(std::atoi(argv[1])), qos);
  if (participant == nullptr) return 1;
  subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
  const auto actions = parse({argv + 3, argv + argc});
  std::printf("{\"ready\": true}\n");
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(std::lround(1e3 * std::atof(argv[2])));
  while (std::chrono::steady_clock::now() < end) {
    for (const auto& action : actions) action->poll();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::fflush(stdout);
  std::_Exit(0);  // nobody is told: the other side must stand that
}
