#include "ros2/dds/node.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <utility>

#include "ros2/dds/byte_type.h"
#include "ros2/messages/names.h"
#include "vesalius/error.h"

namespace vesalius::ros2 {
namespace {

constexpr const char* kDiscoveryTopic = "ros_discovery_info";
constexpr const char* kDiscoveryType = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

/// Without these watermarks a writer would wait for a reader that is gone until its lease ends, 20 s with Fast DDS. The
/// depth of its history bounds what it keeps. Publishers are flushed by us, all together.
/// Pictures are sent in fewer and larger fragments than usual, and all that a reader asks for again is sent at once: it
/// asks for 256 fragments at a time, and a picture must be whole before it leaves the history.
constexpr const char* kWriters =
    "<General><FragmentSize>14000 B</FragmentSize></General><Internal><MaxQueuedRexmitBytes>64 "
    "MB</MaxQueuedRexmitBytes>"
    "<MaxQueuedRexmitMessages>10000</MaxQueuedRexmitMessages><SocketReceiveBufferSize max=\"8 MB\"/>"
    "<Watermarks><WhcAdaptive>false</WhcAdaptive><WhcLow>1 kB</WhcLow><WhcHigh>1 GB</WhcHigh>"
    "<WhcHighInit>1 GB</WhcHighInit></Watermarks><WriterLingerDuration>0 s</WriterLingerDuration></Internal>";
/// The loopback does not say that it can multicast, yet it can: Fast DDS finds others by that alone. Cyclone itself
/// asks one by one there.
constexpr const char* kLocalhost =
    "<General><Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"true\"/></Interfaces>"
    "<AllowMulticast>spdp</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>";

/// Throws Error unless Cyclone returned a success.
std::int32_t expect(std::int32_t result, const std::string& what) {
  if (result < 0) throw Error(fmt::format("ROS 2: {}: {}", what, dds_strretcode(-result)));
  return result;
}

struct DeleteQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using QosPointer = std::unique_ptr<dds_qos_t, DeleteQos>;

QosPointer dds_qos(const Qos& qos) {
  constexpr dds_duration_t kMostWait = 0;
  QosPointer all(dds_create_qos());
  dds_qset_reliability(all.get(), qos.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, kMostWait);
  dds_qset_history(all.get(), DDS_HISTORY_KEEP_LAST, qos.depth);
  dds_qset_durability(all.get(), qos.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_durability_service(all.get(), 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED);
  return all;
}

Gid gid_of(dds_entity_t entity) {
  dds_guid_t guid;
  expect(dds_get_guid(entity, &guid), "an endpoint");
  Gid gid;
  static_assert(sizeof guid.v == sizeof gid);
  std::memcpy(gid.data(), guid.v, gid.size());
  return gid;
}

/// What Cyclone logs goes to whoever asked last: it has one log for a process.
class Log {
 public:
  static Log& instance() {
    static Log log;
    return log;
  }
  void say_to(std::function<void(const std::string&)> say) {
    const std::scoped_lock lock(mutex_);
    say_ = std::move(say);
  }
  /// Returns the last line, which is then forgotten; empty if there was none.
  std::string last() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(last_, {});
  }

 private:
  Log() {
    dds_set_log_mask(DDS_LC_FATAL | DDS_LC_ERROR | DDS_LC_WARNING | DDS_LC_CONFIG);
    dds_set_log_sink(line, this);
    dds_set_trace_sink([](void*, const dds_log_data_t*) {}, nullptr);
  }
  static void line(void* log, const dds_log_data_t* data) {
    auto* self = static_cast<Log*>(log);
    std::string text(data->message, data->size);  // without the time before it
    while (text.ends_with('\n')) text.pop_back();
    const std::scoped_lock lock(self->mutex_);
    self->last_ = text;
    if (self->say_) self->say_("DDS: " + text);
  }

  std::mutex mutex_;
  std::function<void(const std::string&)> say_;
  std::string last_;
};

/// A domain of this process; nodes in it share it, with the settings of the first.
class Domain {
 public:
  static std::shared_ptr<Domain> open(int number, bool localhost) {
    static std::mutex mutex;
    static std::map<int, std::weak_ptr<Domain>> open;
    const std::scoped_lock lock(mutex);
    std::shared_ptr<Domain> domain = open[number].lock();
    if (!domain) open[number] = domain = std::make_shared<Domain>(number, localhost);
    return domain;
  }

  Domain(int number, bool localhost) {
    std::string settings =
        fmt::format("<CycloneDDS><Domain id=\"any\">{}{}</Domain></CycloneDDS>", kWriters, localhost ? kLocalhost : "");
    // As ROS 2's own node does: what the user sets comes after.
    if (const char* more = std::getenv("CYCLONEDDS_URI"); more != nullptr && *more != '\0') {
      settings += fmt::format(",{}", more);
    }
    Log::instance().last();
    domain_ = dds_create_domain(static_cast<dds_domainid_t>(number), settings.c_str());
    if (domain_ >= 0) return;
    const std::string why = Log::instance().last();
    throw Error(fmt::format("ROS 2: domain {}: {}", number, why.empty() ? dds_strretcode(-domain_) : why));
  }
  ~Domain() { dds_delete(domain_); }
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;

 private:
  dds_entity_t domain_;
};

NodeOptions checked(const NodeOptions& options) {
  check_node_name(options.name, "node");
  check_full_name(options.name_space, "namespace", true);
  if (options.domain < 0 || options.domain > kMostDomain) {
    throw UsageError(fmt::format("domain {}: expected 0 to {}", options.domain, kMostDomain));
  }
  return options;
}

}  // namespace

class Participant {
 public:
  explicit Participant(const NodeOptions& options)
      : domain_(Domain::open(options.domain, options.localhost)), gid_bytes_(options.gid_bytes) {
    entities_.name_space = options.name_space;
    entities_.name = options.name;
    constexpr std::string_view kEnclave = "enclave=/;";  // by this ROS 2 knows its own
    const QosPointer qos(dds_create_qos());
    dds_qset_userdata(qos.get(), kEnclave.data(), kEnclave.size());
    entity_ = expect(dds_create_participant(static_cast<dds_domainid_t>(options.domain), qos.get(), nullptr),
                     fmt::format("domain {}", options.domain));
    waitset_ = expect(dds_create_waitset(entity_), "waiting");
    publications_ =
        expect(dds_create_reader(entity_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr), "discovery");
    discovery_ = create_writer(kDiscoveryTopic, kDiscoveryType, {.latched = true, .depth = 1});
    announce();
  }
  ~Participant() { dds_delete(entity_); }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds_entity_t add_writer(const std::string& topic, const std::string& type, const Qos& qos) {
    const std::scoped_lock lock(mutex_);
    const dds_entity_t writer = create_writer(topic_on_wire(topic), type_on_wire(type), qos);
    entities_.writers.push_back(gid_of(writer));
    announce();
    return writer;
  }

  dds_entity_t add_reader(const std::string& topic, const std::string& type, const Qos& qos) {
    const std::scoped_lock lock(mutex_);
    const dds_entity_t of = create_topic(topic_on_wire(topic), type_on_wire(type));
    const dds_entity_t reader = expect(dds_create_reader(entity_, of, dds_qos(qos).get(), nullptr), topic);
    dds_delete(of);  // lives as long as its reader
    const dds_entity_t has_data = expect(
        dds_create_readcondition(reader, DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ANY_INSTANCE_STATE), topic);
    expect(dds_waitset_attach(waitset_, has_data, reader), topic);
    entities_.readers.push_back(gid_of(reader));
    announce();
    return reader;
  }

  void remove(dds_entity_t endpoint) noexcept {
    const std::scoped_lock lock(mutex_);
    try {
      const Gid gid = gid_of(endpoint);
      std::erase(entities_.writers, gid);
      std::erase(entities_.readers, gid);
      dds_delete(endpoint);
      announce();
    } catch (const Error&) {  // it is gone either way
    }
  }

  bool wait(std::chrono::milliseconds most) {
    return expect(dds_waitset_wait(waitset_, nullptr, 0, DDS_MSECS(most.count())), "waiting") > 0;
  }

  std::vector<TopicType> published() {
    constexpr std::size_t kAtOnce = 4096;
    std::vector<void*> samples(kAtOnce, nullptr);
    std::vector<dds_sample_info_t> infos(kAtOnce);
    const int count = expect(dds_read(publications_, samples.data(), infos.data(), kAtOnce, kAtOnce), "discovery");
    const Gid own = gid_of(entity_);
    std::vector<TopicType> topics;
    for (int i = 0; i < count; ++i) {
      const dds_sample_info_t& info = infos[static_cast<std::size_t>(i)];
      const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[static_cast<std::size_t>(i)]);
      if (!info.valid_data || info.instance_state != DDS_IST_ALIVE) continue;
      if (std::memcmp(endpoint->participant_key.v, own.data(), own.size()) == 0) continue;
      if (auto topic = topic_from_wire(endpoint->topic_name, endpoint->type_name)) topics.push_back(std::move(*topic));
    }
    if (count > 0) dds_return_loan(publications_, samples.data(), count);
    std::ranges::sort(topics, {}, [](const TopicType& topic) { return std::pair(topic.name, topic.type); });
    topics.erase(std::unique(topics.begin(), topics.end()), topics.end());
    return topics;
  }

 private:
  dds_entity_t create_topic(const std::string& name, const std::string& type) {
    ddsi_sertype* of = make_byte_type(type);
    const dds_entity_t topic = dds_create_topic_sertype(entity_, name.c_str(), &of, nullptr, nullptr, nullptr);
    if (topic < 0) ddsi_sertype_unref(of);
    return expect(topic, name);
  }

  dds_entity_t create_writer(const std::string& topic, const std::string& type, const Qos& qos) {
    const dds_entity_t of = create_topic(topic, type);
    const dds_entity_t writer = dds_create_writer(entity_, of, dds_qos(qos).get(), nullptr);
    dds_delete(of);  // lives as long as its writer
    return expect(writer, topic);
  }

  void announce() {
    const std::string message = discovery_message(gid_of(entity_), entities_, gid_bytes_);
    const std::string_view bytes = message;
    expect(dds_write(discovery_, &bytes), kDiscoveryTopic);
  }

  std::shared_ptr<Domain> domain_;
  std::size_t gid_bytes_;
  dds_entity_t entity_ = 0, waitset_ = 0, publications_ = 0, discovery_ = 0;
  std::mutex mutex_;  ///< guards the entities
  NodeEntities entities_;
};

Publisher::Publisher(std::shared_ptr<Participant> participant, std::int32_t writer)
    : participant_(std::move(participant)), writer_(writer) {}
Publisher::~Publisher() { participant_->remove(writer_); }

void Publisher::publish(std::string_view message) {
  const dds_return_t result = dds_write(writer_, &message);
  if (result != DDS_RETCODE_TIMEOUT) expect(result, "a message");
}

int Publisher::readers() const {
  dds_publication_matched_status_t status;
  expect(dds_get_publication_matched_status(writer_, &status), "a topic's readers");
  return int(status.current_count);
}

bool Publisher::wait_until_read(std::chrono::milliseconds most) const {
  return dds_wait_for_acks(writer_, DDS_MSECS(most.count())) == DDS_RETCODE_OK;
}

Subscription::Subscription(std::shared_ptr<Participant> participant, std::int32_t reader)
    : participant_(std::move(participant)), reader_(reader) {}
Subscription::~Subscription() { participant_->remove(reader_); }

std::optional<std::string> Subscription::take() {
  for (;;) {
    ddsi_serdata* sample = nullptr;
    dds_sample_info_t info;
    const int count = expect(dds_takecdr(reader_, &sample, 1, &info, DDS_ANY_STATE), "a message");
    if (count == 0) return std::nullopt;
    std::optional<std::string> message;
    if (info.valid_data) message = message_of(*sample);
    ddsi_serdata_unref(sample);
    if (message) return message;  // others say that a writer is gone
  }
}

Node::Node(const NodeOptions& options) : options_(checked(options)) {
  Log::instance().say_to(options.say);
  participant_ = std::make_shared<Participant>(options_);
}
Node::~Node() { Log::instance().say_to({}); }

std::unique_ptr<Publisher> Node::advertise(const std::string& topic, const std::string& type, const Qos& qos) {
  check_full_name(topic, "topic");
  return std::make_unique<Publisher>(participant_, participant_->add_writer(topic, type, qos));
}

std::unique_ptr<Subscription> Node::subscribe(const std::string& topic, const std::string& type, const Qos& qos) {
  check_full_name(topic, "topic");
  return std::make_unique<Subscription>(participant_, participant_->add_reader(topic, type, qos));
}

bool Node::wait(std::chrono::milliseconds most) { return participant_->wait(most); }

std::vector<TopicType> Node::published() { return participant_->published(); }

}  // namespace vesalius::ros2
