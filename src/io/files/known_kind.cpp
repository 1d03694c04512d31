#include "io/files/known_kind.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace vesalius {
namespace {

using namespace std::literals;

struct Signature {
  std::size_t at;
  std::string_view magic;  ///< in small letters where it is text of a web page
  std::string_view what;
};

constexpr auto kKinds = std::to_array<Signature>({
    {0, "version https://git-lfs.github.com/spec/"sv,
     "this is a pointer of Git LFS, not the file itself; `git lfs pull` fetches it"},
    {0, "PK\3\4"sv, "a zip archive; unpack it first (unzip)"},
    {0, "7z\xBC\xAF\x27\x1C"sv, "a 7z archive; unpack it first (7z x)"},
    {0, "Rar!\x1A\x07"sv, "a RAR archive; unpack it first (unrar x)"},
    {257, "ustar"sv, "a tar archive; unpack it first (tar xf)"},
    {0, "\x1F\x8B"sv, "packed with gzip; unpack it first (gunzip, or tar xf where it is an archive)"},
    {0, "BZh"sv, "packed with bzip2; unpack it first (bunzip2, or tar xf where it is an archive)"},
    {0,
     "\xFD"
     "7zXZ\0"sv,
     "packed with xz; unpack it first (unxz, or tar xf where it is an archive)"},
    {0, "\x04\x22\x4D\x18"sv, "packed with LZ4; unpack it first (unlz4)"},
    {0, "\x28\xB5\x2F\xFD"sv, "packed with zstd; unpack it first (unzstd, or tar xf where it is an archive)"},
    {0, "#ROSRECORD V1"sv, "a ROS bag of version 1, expected 2.0; `rosbag fix` of an old ROS rewrites it"},
    {0, "#ROSBAG V1"sv, "a ROS bag of version 1, expected 2.0; `rosbag fix` of an old ROS rewrites it"},
    {0, "NI10"sv, "a recording of OpenNI (.oni), which is not read; record its topics or pictures while it plays"},
    {0, "\x89HDF\r\n\x1A\n"sv, "an HDF5 file, which is not read; write its depth as 16-bit PNG, a calibration as text"},
    {0, "MATLAB 5.0 MAT-file"sv,
     "a file of MATLAB, which is not read; write its depth as 16-bit PNG, a calibration as text"},
    {0, "\xFF\xD8\xFF"sv, "a JPEG, which cannot hold depth"},
    {8, "AVI "sv, "an AVI film; if it has depth of 16 bits: ffmpeg -i x.avi -pix_fmt gray16be depth/%04d.png"},
    {0, "RIFF"sv, "a WebP picture or sound, which cannot hold depth"},
    {4, "ftyphei"sv, "a HEIC picture, which cannot hold depth"},
    {4, "ftypmif1"sv, "a HEIC picture, which cannot hold depth"},
    {4, "ftyp"sv, "an MP4 or MOV film; if it has depth of 16 bits: ffmpeg -i x.mov -pix_fmt gray16be depth/%04d.png"},
    {4, "jP  "sv, "a JPEG 2000 picture, which is not read; write it as 16-bit PNG (opj_decompress)"},
    {0, "II+\0"sv, "a BigTIFF, which is not read; write it as TIFF or 16-bit PNG"},
    {0, "MM\0+"sv, "a BigTIFF, which is not read; write it as TIFF or 16-bit PNG"},
    {0, "P2\n"sv, "a PGM of text, which is not read; write it as 16-bit PNG or binary PGM (P5)"},
    {0, "ply\n"sv, "points of PLY, which have no rows; the depth pictures that they were made of are read"},
    {0, "ply\r"sv, "points of PLY, which have no rows; the depth pictures that they were made of are read"},
    {0, "RRF2"sv, "a recording of Rerun (.rrd), which is not read; give it the MCAP file or pictures it was made of"},
    {0, "%PDF"sv, "a PDF document"},
    {0, "<!doctype"sv, "a web page, not the file; its download went wrong"},
    {0, "<html"sv, "a web page, not the file; its download went wrong"},
});

bool is_same(char byte, char magic) { return byte == magic || std::tolower(static_cast<unsigned char>(byte)) == magic; }

}  // namespace

std::string_view known_kind(std::string_view first) {
  const auto found = std::ranges::find_if(kKinds, [&](const Signature& kind) {
    if (first.size() < kind.at + kind.magic.size()) return false;
    const std::string_view there = first.substr(kind.at, kind.magic.size());
    return kind.magic.front() == '<' ? std::ranges::equal(there, kind.magic, is_same) : there == kind.magic;
  });
  if (found != kKinds.end()) return found->what;
  const bool zeros = first.size() >= 16 && std::ranges::all_of(first, [](char byte) { return byte == '\0'; });
  return zeros ? "nothing but zeros at its beginning, as a copy leaves that was broken off"sv : ""sv;
}

std::string kind_or(std::string_view first, std::string_view otherwise) {
  const std::string_view kind = known_kind(first.substr(0, kKindBytes));
  return std::string(kind.empty() ? otherwise : kind);
}

}  // namespace vesalius
