#include "cuda/cuda_device.h"

#if defined(__HIPCC__)
#include "cuda/cuda_names_of_hip.h"
#else
#include <cuda_runtime.h>
#endif

#include <algorithm>
#include <string_view>
#include <utility>

#include "cuda/kernels.cuh"
#include "vesalius/error.h"
// Behind the kernels.
#include "cuda/card_kernels.cuh"

namespace vesalius::gpu {
namespace {

std::string number_of(int number) { return "cuda:" + std::to_string(number); }

/// What a destructor cannot report: the device is lost, or will be when it is asked next.
void ignore(cudaError_t /*result*/) {}

/// Throws DeviceError unless a call of the runtime succeeded. An error that it reports is taken back, so that it is not
/// reported again to whoever asks next.
void expect(cudaError_t result, const std::string& device, const std::string& what) {
  if (result == cudaSuccess) return;
  ignore(cudaGetLastError());
  throw DeviceError(device + ": " + what + ": " + cudaGetErrorString(result));
}

class CudaEvent : public Event {
 public:
  explicit CudaEvent(std::string device) : device_(std::move(device)) {
    expect(cudaEventCreate(&event_), device_, "cannot make an event");
  }
  ~CudaEvent() override { ignore(cudaEventDestroy(event_)); }
  CudaEvent(const CudaEvent&) = delete;
  CudaEvent& operator=(const CudaEvent&) = delete;

  double ms_since(const Event& earlier) const override {
    float ms = 0.F;
    expect(cudaEventElapsedTime(&ms, dynamic_cast<const CudaEvent&>(earlier).event_, event_), device_,
           "cannot tell the time between events");
    return ms;
  }
  cudaEvent_t get() const { return event_; }

 private:
  std::string device_;
  cudaEvent_t event_ = nullptr;
};

class CudaStream : public Stream {
 public:
  CudaStream(std::string device, int number, std::vector<CardKernel> kernels)
      : device_(std::move(device)), number_(number), kernels_(std::move(kernels)) {
    select();
    expect(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), device_, "cannot make a stream");
  }
  ~CudaStream() override {
    ignore(cudaSetDevice(number_));
    ignore(cudaStreamSynchronize(stream_));  // what it works on goes next
    ignore(cudaStreamDestroy(stream_));
  }
  CudaStream(const CudaStream&) = delete;
  CudaStream& operator=(const CudaStream&) = delete;

  void copy_to_device(void* to, const void* from, std::size_t bytes) override {
    select();
    expect(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream_), device_, "cannot copy to it");
  }
  void copy_to_host(void* to, const void* from, std::size_t bytes) override {
    select();
    expect(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream_), device_, "cannot copy from it");
  }
  void clear(void* at, std::size_t bytes) override {
    select();
    expect(cudaMemsetAsync(at, 0, bytes, stream_), device_, "cannot clear its memory");
  }
  void launch(const KernelCall& call, const LaunchShape& shape) override {
    select();
    const dim3 blocks(shape.blocks_x, shape.blocks_y), threads(shape.threads);
    auto* arguments = const_cast<void*>(call.arguments());
    expect(cudaLaunchKernel(code_of(call), blocks, threads, &arguments, 0, stream_), device_, "cannot start a kernel");
  }
  void record(Event& event) override {
    select();
    expect(cudaEventRecord(dynamic_cast<CudaEvent&>(event).get(), stream_), device_, "cannot record an event");
  }
  void wait() override {
    select();
    expect(cudaStreamSynchronize(stream_), device_, "failed");
  }

 private:
  /// A thread's card is its own affair, and streams are used from any thread.
  void select() const { expect(cudaSetDevice(number_), device_, "cannot be used"); }

  const void* code_of(const KernelCall& call) const {
    const std::string_view name = call.name();
    const auto found = std::ranges::find(kernels_, name, &CardKernel::name);
    if (found == kernels_.end()) throw std::logic_error(device_ + ": was not opened for the kernel " + call.name());
    return found->code;
  }

  std::string device_;
  int number_;
  std::vector<CardKernel> kernels_;
  cudaStream_t stream_ = nullptr;
};

class CudaDevice : public Device {
 public:
  CudaDevice(int number, const std::string& name, std::vector<CardKernel> kernels)
      : number_(number), name_(number_of(number) + " (" + name + ")"), kernels_(std::move(kernels)) {}

  std::string name() const override { return name_; }
  void* allocate(std::size_t bytes) override {
    select();
    void* at = nullptr;
    expect(cudaMalloc(&at, bytes), name_, "no room for " + std::to_string(bytes) + " bytes in its memory");
    return at;
  }
  void release(void* at) noexcept override {
    ignore(cudaSetDevice(number_));
    ignore(cudaFree(at));
  }
  void* allocate_pinned(std::size_t bytes) override {
    select();
    void* at = nullptr;
    expect(cudaMallocHost(&at, bytes), name_,
           "cannot pin " + std::to_string(bytes) + " bytes of this machine's memory");
    return at;
  }
  void release_pinned(void* at) noexcept override {
    ignore(cudaSetDevice(number_));
    ignore(cudaFreeHost(at));
  }
  std::unique_ptr<Stream> make_stream() override { return std::make_unique<CudaStream>(name_, number_, kernels_); }
  std::unique_ptr<Event> make_event() override {
    select();
    return std::make_unique<CudaEvent>(name_);
  }

 private:
  void select() const { expect(cudaSetDevice(number_), name_, "cannot be used"); }

  int number_;
  std::string name_;
  std::vector<CardKernel> kernels_;
};

KernelFacts facts_of(const CardKernel& kernel, const std::string& device) {
  constexpr int kThreads = 256;
  cudaFuncAttributes attributes{};
  expect(cudaFuncGetAttributes(&attributes, kernel.code), device, "this build has no kernels for it");
  int blocks = 0, threads = 0, current = 0;
  expect(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel.code, kThreads, 0), device,
         "cannot tell its occupancy");
  expect(cudaGetDevice(&current), device, "cannot be asked");
  expect(cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerMultiProcessor, current), device,
         "cannot tell its threads");
  return {kernel.name, attributes.numRegs, attributes.sharedSizeBytes, attributes.localSizeBytes,
          float(blocks * kThreads) / float(threads)};
}

}  // namespace

bool has_cuda() { return true; }

std::vector<CudaFacts> cuda_devices() {
  int count = 0;
  expect(cudaGetDeviceCount(&count), "cuda", "no card can be used");
  if (count == 0) throw DeviceError("cuda: no card is there");
  std::vector<CudaFacts> found;
  for (int i = 0; i < count; ++i) {
    cudaDeviceProp properties{};
    expect(cudaGetDeviceProperties(&properties, i), number_of(i), "cannot be asked");
    found.push_back({properties.name, properties.major, properties.minor, properties.totalGlobalMem,
                     properties.multiProcessorCount});
  }
  return found;
}

std::vector<CardKernel> label_kernels_on_cards() { return card_kernels(LabelKernels{}); }

std::shared_ptr<Device> open_cuda_device(int number, std::vector<CardKernel> kernels) {
  const std::vector<CudaFacts> found = cuda_devices();
  if (number >= int(found.size())) {
    throw DeviceError(number_of(number) + ": is not there; this machine has " + std::to_string(found.size()));
  }
  const CudaFacts& facts = found[static_cast<std::size_t>(number)];
  kernel_facts(number, kernels);  // says if there is no kernel for this card
  return std::make_shared<CudaDevice>(number, facts.name, std::move(kernels));
}

std::vector<KernelFacts> kernel_facts(int number, const std::vector<CardKernel>& kernels) {
  const std::string device = number_of(number);
  expect(cudaSetDevice(number), device, "cannot be used");
  std::vector<KernelFacts> facts;
  for (const CardKernel& kernel : kernels) facts.push_back(facts_of(kernel, device));
  return facts;
}

}  // namespace vesalius::gpu
