#include "ros2/dds/byte_type.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstring>
#include <memory>

namespace vesalius::ros2 {
namespace {

/// A sample: its bytes, with zeros up to a whole number of four, since so many are sent.
struct ByteSample : ddsi_serdata {
  std::string bytes;
};

const ByteSample& sample_of(const ddsi_serdata* data) { return *static_cast<const ByteSample*>(data); }

std::unique_ptr<ByteSample> new_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) {
  constexpr std::size_t kWord = 4;
  auto sample = std::make_unique<ByteSample>();
  ddsi_serdata_init(sample.get(), type, kind);
  sample->bytes.resize((size + kWord - 1) / kWord * kWord);
  return sample;
}

bool same_key(const ddsi_serdata*, const ddsi_serdata*) { return true; }  // none of the types has one

std::uint32_t size_of(const ddsi_serdata* data) { return static_cast<std::uint32_t>(sample_of(data).bytes.size()); }

ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
  auto sample = new_sample(type, kind, size);
  std::uint32_t at = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= at) continue;  // they may overlap
    if (fragment->min > at || fragment->maxp1 > size) return nullptr;
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(sample->bytes.data() + at, payload + (at - fragment->min), fragment->maxp1 - at);
    at = fragment->maxp1;
  }
  return sample.release();
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                          const ddsrt_iovec_t* pieces, std::size_t size) {
  auto sample = new_sample(type, kind, size);
  std::size_t at = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && at < size; ++i) {
    const std::size_t length = std::min<std::size_t>(pieces[i].iov_len, size - at);
    std::memcpy(sample->bytes.data() + at, pieces[i].iov_base, length);
    at += length;
  }
  return sample.release();
}

ddsi_serdata* from_key_hash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return new_sample(type, SDK_KEY, 0).release();
}

/// What a writer was given: a std::string_view.
ddsi_serdata* from_message(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* message) {
  const std::string_view bytes = kind == SDK_DATA ? *static_cast<const std::string_view*>(message) : "";
  auto sample = new_sample(type, kind, bytes.size());
  std::ranges::copy(bytes, sample->bytes.begin());
  return sample.release();
}

void to_buffer(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* buffer) {
  std::memcpy(buffer, sample_of(data).bytes.data() + offset, size);
}

ddsi_serdata* lend_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, ddsrt_iovec_t* lent) {
  lent->iov_base = const_cast<char*>(sample_of(data).bytes.data()) + offset;
  lent->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(data);
}

void take_back(ddsi_serdata* data, const ddsrt_iovec_t*) { ddsi_serdata_unref(data); }

// Samples are taken as they are (dds_takecdr), never turned into others.
bool to_message(const ddsi_serdata*, void*, void**, void*) { return false; }
bool key_to_message(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return false; }

ddsi_serdata* without_type(const ddsi_serdata* data) { return new_sample(data->type, SDK_KEY, 0).release(); }

void free_sample(ddsi_serdata* data) { delete static_cast<ByteSample*>(data); }

std::size_t print_sample(const ddsi_sertype*, const ddsi_serdata*, char* buffer, std::size_t size) {
  return static_cast<std::size_t>(std::snprintf(buffer, size, "(message)"));
}

void key_hash(const ddsi_serdata*, ddsi_keyhash* hash, bool) { *hash = {}; }

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}
bool same_type(const ddsi_sertype*, const ddsi_sertype*) { return true; }  // their names are the same
std::uint32_t type_hash(const ddsi_sertype*) { return 0; }
void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

const ddsi_serdata_ops& sample_functions() {
  static const ddsi_serdata_ops functions = [] {
    ddsi_serdata_ops f{};
    f.eqkey = same_key;
    f.get_size = size_of;
    f.from_ser = from_fragments;
    f.from_ser_iov = from_pieces;
    f.from_keyhash = from_key_hash;
    f.from_sample = from_message;
    f.to_ser = to_buffer;
    f.to_ser_ref = lend_bytes;
    f.to_ser_unref = take_back;
    f.to_sample = to_message;
    f.to_untyped = without_type;
    f.untyped_to_sample = key_to_message;
    f.free = free_sample;
    f.print = print_sample;
    f.get_keyhash = key_hash;
    return f;
  }();
  return functions;
}

const ddsi_sertype_ops& type_functions() {
  static const ddsi_sertype_ops functions = [] {
    ddsi_sertype_ops f{};
    f.version = ddsi_sertype_v0;
    f.free = free_type;
    f.zero_samples = zero_samples;
    f.realloc_samples = realloc_samples;
    f.free_samples = free_samples;
    f.equal = same_type;
    f.hash = type_hash;
    return f;
  }();
  return functions;
}

}  // namespace

ddsi_sertype* make_byte_type(const std::string& name) {
  auto type = std::make_unique<ddsi_sertype>();
  ddsi_sertype_init_flags(type.get(), name.c_str(), &type_functions(), &sample_functions(),
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type.release();
}

std::string_view message_of(const ddsi_serdata& sample) { return sample_of(&sample).bytes; }

}  // namespace vesalius::ros2
