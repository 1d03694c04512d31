// Writes what a model's network is shown of frames and what its heads say, for training/network/tests/oracle_test.py.
// For each frame, on the detector's grid: its focal length in pixels (f32), then five pictures, each as width, height
// and channels (u32) and its numbers, pixel after pixel: depth in mm (u16), the network's input (u8), logits, votes and
// ways to the parts' centres (i16; 0x0 where the network has none). Little endian.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <iostream>
#include <vector>

#include "../../tools/run_tool.h"
#include "io/files/atomic_file.h"
#include "io/files/byte_stream.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"
#include "vesalius/network/network_input.h"
#include "vesalius/network/run_network.h"
#include "vesalius/open_source.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

template <class T>
void write_picture(int width, int height, const T* values, int channels, ByteWriter& out) {
  for (const int n : {width, height, channels}) out.number(static_cast<std::uint32_t>(n));
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height * channels);
  for (std::size_t i = 0; i < count; ++i) out.number(values[i]);
}

void write_head(const WideImage& head, ByteWriter& out) {
  write_picture(head.width, head.height, head.values.data(), head.channels, out);
}

double milliseconds(const NetworkRunner& network, const NetworkInput& input, NetworkResult& result) {
  const std::clock_t begin = std::clock();
  network.run(input, result);
  return 1e3 * double(std::clock() - begin) / CLOCKS_PER_SEC;
}

double median_ms(const NetworkRunner& network, const NetworkInput& input, int runs, NetworkResult& result) {
  std::vector<double> times(static_cast<std::size_t>(runs));
  for (double& time : times) time = milliseconds(network, input, result);
  const auto middle = times.begin() + runs / 2;
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

int run(int argc, char** argv) {
  CLI::App app("Writes what a model's network says of frames, and the median processor time of a run on one thread");
  std::string model_file, source_name, out_file;
  int runs = 1;
  app.add_option("MODEL", model_file)->required();
  app.add_option("SOURCE", source_name, "What `vesalius detect` reads")->required();
  app.add_option("OUT", out_file)->required();
  app.add_option("--runs", runs, "Runs on each frame")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  const Model model = load_model(model_file);
  if (!model.network) throw Error(model_file + ": labels by trees, expected a network");
  const NetworkRunner network(*model.network, model.body.part_count());
  const ThreadLimit limit(1);
  ByteWriter out;
  NetworkInput input;
  NetworkResult result;
  const auto source = open_source(source_name);
  while (const auto frame = source->next()) {
    const Frame grid = every_nth(*frame, grid_step(frame->camera, {}));
    const DepthImage& depth = grid.depth;
    fill_network_input(depth, grid.camera.fx, input);
    std::cout << median_ms(network, input, runs, result) << " ms\n";
    out.real(grid.camera.fx);
    write_picture(depth.width(), depth.height(), depth.row(0), 1, out);
    write_picture(input.width, input.height, input.values.data(), kNetworkInputs, out);
    write_head(result.classes, out);
    write_head(result.person, out);
    write_head(result.centres, out);
  }
  write_file_atomically(out_file, out.bytes());
  return 0;
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  return vesalius::run_tool("vesalius_network_heads", [&] { return vesalius::run(argc, argv); });
}
