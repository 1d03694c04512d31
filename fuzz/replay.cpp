// Runs the fuzz targets without libFuzzer, so that every change can be tried with whatever compiler and sanitizers
// there are: each seed as it is, cut short, and changed at random, always in the same way. Whatever the bytes are, they
// are read or refused within bounds of time and memory.
//
// Usage: fuzz_replay TARGET RUNS FOLDER

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace {

using Target = int (*)(const std::uint8_t*, std::size_t);
using Bytes = std::vector<std::uint8_t>;

}  // namespace

#define REPLAY(name) extern "C" int replay_##name(const std::uint8_t* data, std::size_t size);
#include "targets.inc"
#undef REPLAY

namespace {

struct Named {
  std::string_view name;
  Target run;
};

#define REPLAY(name) Named{#name, &replay_##name},
constexpr auto kTargets = std::to_array<Named>({
#include "targets.inc"
});
#undef REPLAY

std::vector<Bytes> seeds_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file()) paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  std::vector<Bytes> seeds;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return seeds;
}

/// Changes what parsers trip over: single bits, numbers at their limits, digits, missing and repeated pieces.
void change(Bytes& bytes, std::mt19937& random) {
  if (bytes.empty()) return;
  const std::size_t at = random() % bytes.size();
  const std::size_t count = std::min<std::size_t>(1 + random() % 64, bytes.size() - at);
  const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  const auto end = place + static_cast<std::ptrdiff_t>(count);
  switch (random() % 6) {
    case 0:
      *place ^= static_cast<std::uint8_t>(1U << random() % 8);
      break;
    case 1:
      std::fill(place, place + static_cast<std::ptrdiff_t>(std::min<std::size_t>(count, 4)),
                random() % 2 ? 0xFF : 0x00);
      break;
    case 2:
      *place = static_cast<std::uint8_t>("0123456789-.e{}[]\","[random() % 19]);
      break;
    case 3:
      bytes.erase(place, end);
      break;
    case 4: {
      const Bytes piece(place, end);
      bytes.insert(place, piece.begin(), piece.end());
      break;
    }
    default:
      *place = static_cast<std::uint8_t>(random());
  }
}

Bytes changed(const std::vector<Bytes>& seeds, std::mt19937& random) {
  Bytes bytes = seeds[random() % seeds.size()];
  if (random() % 8 == 0) bytes.resize(random() % (bytes.size() + 1));
  for (unsigned left = 1 + random() % 4; left > 0; --left) change(bytes, random);
  return bytes;
}

/// Runs the target. Ends the program and keeps the input where that takes too long, by the processor, or the program
/// has grown too large, sanitizers and what they keep of freed memory included.
void run_bounded(const Named& target, const Bytes& bytes) {
  constexpr double kMost_s = 10.0;
  constexpr long kMost_kB = 2 << 20;
  const std::clock_t start = std::clock();
  target.run(bytes.data(), bytes.size());
  const double took_s = double(std::clock() - start) / CLOCKS_PER_SEC;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  if (took_s <= kMost_s && usage.ru_maxrss <= kMost_kB) return;
  const std::string kept = std::string(target.name) + "-bounds";
  std::ofstream(kept, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  std::fprintf(stderr, "%s: %.1f s and %ld MiB, expected at most %.0f s and %ld MiB; input kept in %s\n", kept.c_str(),
               took_s, usage.ru_maxrss >> 10, kMost_s, kMost_kB >> 10, kept.c_str());
  std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::fputs("usage: fuzz_replay TARGET RUNS FOLDER\n", stderr), 2;
  const auto target = std::ranges::find(kTargets, std::string_view(argv[1]), &Named::name);
  const std::vector<Bytes> seeds = seeds_in(argv[3]);
  if (target == kTargets.end() || seeds.empty()) {
    return std::fprintf(stderr, "%s: no such target, or no seeds in %s\n", argv[1], argv[3]), 2;
  }
  for (const Bytes& seed : seeds) run_bounded(*target, seed);
  std::mt19937 random(1);
  const int runs = std::atoi(argv[2]);
  for (int run = 0; run < runs; ++run) {
    run_bounded(*target, changed(seeds, random));
  }
  std::printf("%s: %zu seeds and %d changes of them\n", argv[1], seeds.size(), runs);
}
