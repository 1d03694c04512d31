#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synth/sensor/noise_kernel.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>

#include "synth/sensor/noise_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::synth::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kNoiseLanes>;
using Ints = hn::RebindToSigned<Floats>;
using Vec = hn::Vec<Floats>;

HWY_INLINE Vec Number(float value) { return hn::Set(Floats(), value); }
HWY_INLINE Vec Square(Vec x) { return hn::Mul(x, x); }
HWY_INLINE Vec Plus(Vec x, float y) { return hn::Add(x, Number(y)); }
HWY_INLINE Vec Times(Vec x, float y) { return hn::Mul(x, Number(y)); }

HWY_INLINE Vec AngleOf(Vec c) {
  const auto& a = kAngleSeries;
  const Vec series = Plus(hn::Mul(c, Plus(hn::Mul(c, Plus(Times(c, a[3]), a[2])), a[1])), a[0]);
  return hn::Mul(hn::Sqrt(hn::Sub(Number(1.F), c)), series);
}

/// Returns the logarithm to the base 2 of normal numbers with an error below 2e-7 of 1 or of the value. It uses the
/// exponent, and the series of artanh for a mantissa between 0.7 and 1.5.
HWY_INLINE Vec Log2(Vec x) {
  const Floats d;
  const Ints ints;
  constexpr float kPerLog2 = 1.44269504F;  // 1 / ln 2
  const auto bits = hn::BitCast(ints, x);
  const auto half = hn::BitCast(ints, Number(0.70710678F));
  const auto exponent = hn::ShiftRight<23>(hn::Sub(bits, half));
  const Vec mantissa = hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(exponent)));
  const Vec s = hn::Div(Plus(mantissa, -1.F), Plus(mantissa, 1.F));
  const Vec square = Square(s);
  const Vec series = Plus(
      hn::Mul(square,
              Plus(hn::Mul(square, Plus(hn::Mul(square, Plus(Times(square, 1.F / 9.F), 1.F / 7.F)), 0.2F)), 1.F / 3.F)),
      1.F);
  return hn::Add(hn::ConvertTo(d, exponent), Times(hn::Mul(s, series), 2.F * kPerLog2));
}

HWY_INLINE Vec AxialSigma(const Sensor& sensor, Vec z) {
  return Plus(Times(Square(Plus(z, -sensor.axial_z0_m)), sensor.axial_z2), sensor.axial_base_m);
}

/// Returns the depth of disparities that are quantised.
HWY_INLINE Vec Quantised(const Sensor& sensor, Vec disparity_px) {
  const float step = sensor.disparity_step_px;
  const Vec steps = hn::Floor(Plus(Times(disparity_px, 1.F / step), 0.5F));
  return hn::Div(Number(sensor.disparity_px_m), Times(steps, step));
}

HWY_INLINE Vec StructuredLight(const Sensor& sensor, Vec z, Vec angle, Vec error) {
  // Nguyen et al. 2012 give the axial sigma 0.0001 / sqrt(z) t^2 with t = angle / (pi/2 - angle) as an addition. It is
  // limited where it grows without bound.
  constexpr float kGrazing = 0.0001F, kLargestAngle = 1.55F, kHalfPi = 1.57079633F, kNearest_m = 0.1F;
  const Vec limited = hn::Min(angle, Number(kLargestAngle));
  const Vec t = hn::Div(limited, hn::Sub(Number(kHalfPi), limited));
  const Vec grazing = hn::Mul(Times(hn::Div(Number(1.F), hn::Sqrt(z)), kGrazing), Square(t));
  const Vec sigma = hn::Add(AxialSigma(sensor, z), grazing);
  // The formula was measured after the quantisation, whose share must not count twice.
  const Vec step = Times(Square(z), sensor.disparity_step_px / sensor.disparity_px_m);
  const Vec variance = hn::Sub(Square(sigma), Times(Square(step), 1.F / 12.F));
  const Vec before = hn::Sqrt(hn::Max(variance, Number(0.F)));
  const Vec measured = hn::Max(hn::Add(z, hn::Mul(before, error)), Number(kNearest_m));
  return Quantised(sensor, hn::Div(Number(sensor.disparity_px_m), measured));
}

HWY_INLINE Vec Stereo(const Sensor& sensor, Vec z, Vec error) {
  return Quantised(sensor, hn::Add(hn::Div(Number(sensor.disparity_px_m), z), Times(error, sensor.matching_px)));
}

HWY_INLINE Vec TimeOfFlight(const Sensor& sensor, Vec z, Vec signal, Vec error) {
  constexpr float kSmallestAmplitude = 1e-4F;
  const Vec amplitude = hn::Max(signal, Number(kSmallestAmplitude));
  const Vec sigma = hn::Add(AxialSigma(sensor, z), hn::Div(Times(Square(z), sensor.amplitude_z2), amplitude));
  return hn::Add(z, hn::Mul(sigma, error));
}

/// Returns the largest loss noise at which there still is a reading: the surface must reflect enough light and not be
/// too slanted.
HWY_INLINE Vec Kept(const Sensor& sensor, Vec z, Vec angle, Vec signal) {
  // How fast readings vanish, in sigma of the deciding noise: per doubling of the signal and per radian.
  constexpr float kKeptPerDoubling = 1.2F, kKeptPerRad = 1.F / 0.052F;  // 3 degrees
  constexpr float kReference_m = 2.F;  // distance for which Sensor::min_infrared is stated
  constexpr float kLeast = 1e-30F;
  const Vec arriving = hn::Mul(signal, Square(hn::Div(Number(kReference_m), z)));
  const Vec doublings = Log2(hn::Max(Times(arriving, 1.F / sensor.min_infrared), Number(kLeast)));
  return hn::Min(Times(doublings, kKeptPerDoubling), Times(hn::Sub(Number(sensor.max_angle_rad), angle), kKeptPerRad));
}

/// Returns the measured depth in metres.
template <SensorKind kKind>
HWY_INLINE Vec Measured(const Sensor& sensor, Vec z, Vec angle, Vec signal, Vec error) {
  if constexpr (kKind == SensorKind::structured_light) return StructuredLight(sensor, z, angle, error);
  if constexpr (kKind == SensorKind::stereo) return Stereo(sensor, z, error);
  return TimeOfFlight(sensor, z, signal, error);
}

template <SensorKind kKind>
HWY_INLINE void ReadRowOf(const Sensor& sensor, const NoisyRow& row, std::size_t count, std::uint16_t* depth_mm) {
  const Floats d;
  const hn::Rebind<std::uint16_t, Floats> narrow;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec z = hn::LoadU(d, row.z + i);
    const Vec cosine = hn::LoadU(d, row.cosine + i);
    const Vec error = hn::LoadU(d, row.error + i);
    const Vec angle = AngleOf(cosine);
    const Vec signal = hn::Mul(hn::Mul(hn::LoadU(d, row.infrared + i), cosine), hn::LoadU(d, row.fall_off + i));
    const Vec measured = Measured<kKind>(sensor, z, angle, signal, error);
    const auto kept = hn::Le(hn::LoadU(d, row.loss + i), Kept(sensor, z, angle, signal));
    const auto in_range = hn::And(hn::Ge(measured, Number(sensor.near_m)), hn::Le(measured, Number(sensor.far_m)));
    const auto read = hn::And(hn::And(hn::Gt(z, Number(0.F)), kept), in_range);
    const Vec mm = hn::IfThenElseZero(read, hn::Min(Plus(Times(measured, 1000.F), 0.5F), Number(65535.F)));
    hn::StoreU(hn::DemoteTo(narrow, hn::ConvertTo(Ints(), mm)), narrow, depth_mm + i);
  }
}

void ReadRow(const Sensor& sensor, const NoisyRow& row, std::size_t count, std::uint16_t* depth_mm) {
  switch (sensor.kind) {
    case SensorKind::structured_light:
      return ReadRowOf<SensorKind::structured_light>(sensor, row, count, depth_mm);
    case SensorKind::stereo:
      return ReadRowOf<SensorKind::stereo>(sensor, row, count, depth_mm);
    default:
      return ReadRowOf<SensorKind::time_of_flight>(sensor, row, count, depth_mm);
  }
}

HWY_INLINE void Face(const float* normals, const float* ray_x, float ray_y, float* cosine, float* fall_off) {
  const Floats d;
  const Vec y = Number(ray_y);
  const Vec x = hn::LoadU(d, ray_x);
  Vec nx, ny, nz;
  hn::LoadInterleaved3(d, normals, nx, ny, nz);
  const Vec square = Plus(hn::Add(Square(x), Square(y)), 1.F);
  const Vec along = hn::Add(hn::Add(hn::Mul(nx, x), hn::Mul(ny, y)), nz);
  const Vec facing = hn::Div(hn::Neg(along), hn::Sqrt(square));
  hn::StoreU(hn::Min(hn::Max(facing, Number(kSmallestCosine)), Number(1.F)), d, cosine);
  hn::StoreU(hn::Div(Number(1.F), Square(square)), d, fall_off);
}

void FaceRow(const float* normals, const float* ray_x, float ray_y, std::size_t count, float* cosine, float* fall_off) {
  const std::size_t lanes = hn::Lanes(Floats());
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) Face(normals + 3 * i, ray_x + i, ray_y, cosine + i, fall_off + i);
  if (i == count) return;
  std::array<float, 3 * kNoiseLanes> last_normals{};
  std::array<float, kNoiseLanes> last_x{};
  std::copy(normals + 3 * i, normals + 3 * count, last_normals.begin());
  std::copy(ray_x + i, ray_x + count, last_x.begin());
  Face(last_normals.data(), last_x.data(), ray_y, cosine + i, fall_off + i);
}

}  // namespace vesalius::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius::synth {

HWY_EXPORT(ReadRow);
HWY_EXPORT(FaceRow);

void face_row(const Eigen::Vector3f* normals, const float* ray_x, float ray_y, int width, float* cosine,
              float* fall_off) {
  HWY_DYNAMIC_DISPATCH(FaceRow)
  (normals->data(), ray_x, ray_y, width, cosine, fall_off);
}

void read_row(const Sensor& sensor, const NoisyRow& row, int width, std::uint16_t* depth_mm) {
  HWY_DYNAMIC_DISPATCH(ReadRow)(sensor, row, width, depth_mm);
}

}  // namespace vesalius::synth
#endif
