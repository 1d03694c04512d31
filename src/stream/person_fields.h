#pragma once

#include <string>
#include <tuple>

#include "vesalius/person.h"

namespace vesalius {

/// A field of somebody, as others are told of it: JSON and who reads it back have it under key_of, Python under its
/// name.
template <class Struct, class Value>
struct Field {
  Value Struct::*member;
  const char* name;
  const char* unit;  ///< as in JSON; "" without one
  const char* help;
};
template <class Struct, class Value>
Field(Value Struct::*, const char*, const char*, const char*) -> Field<Struct, Value>;

/// The fields of a struct in the order in which JSON has them. What is listed by the names of a body model, as parts
/// and joints, is not among them.
template <class Struct>
inline constexpr auto kFields = std::tuple{};

template <>
inline constexpr auto kFields<TrackedPerson> = std::tuple{
    Field{&TrackedPerson::id, "id", "", "The id that a Tracker gives and keeps."},
    Field{&TrackedPerson::state, "state", "", "new, tracked, hidden or lost; seen from a Detector."},
    Field{&TrackedPerson::position, "position", "m", "Of the middle of the trunk, metres, optical frame."},
    Field{&TrackedPerson::velocity, "velocity", "m_s", "Of the trunk, metres a second, optical frame."},
    Field{&TrackedPerson::stance, "stance", "",
          "standing, sitting, lying, fallen; unknown without a floor or Tracker."},
    Field{&TrackedPerson::leaving, "leaving", "", "Whether seen last at the border of the view."},
    Field{&TrackedPerson::since_s, "since", "s", "Time of the first frame in which the person was found, seconds."},
    Field{&TrackedPerson::seen_s, "seen", "s", "Time of the last frame in which the person was found, seconds."}};

template <>
inline constexpr auto kFields<Person> = std::tuple{
    Field{&Person::score, "score", "", "How certain it is, 0 to 1."},
    Field{&Person::yaw, "yaw", "", "Radians: 0 faces the camera, positive is turned to the own left; None if unknown."},
    Field{&Person::box, "box", "px", "Column, row, width and height of the smallest box around the mask, pixels."}};

template <>
inline constexpr auto kFields<FittedBody> = std::tuple{
    Field{&FittedBody::stature_m, "stature", "m", "Height of the person standing upright, metres, by the fitted body."},
    Field{&FittedBody::misfit, "misfit", "", "Mean cost of a point of the fitted body, lower is better."},
    Field{&FittedBody::shape, "shape", "", "How the fitted body differs from the population, standard deviations."}};

template <>
inline constexpr auto kFields<FittedBone> = std::tuple{
    Field{&FittedBone::head, "head", "m", "(x, y, z) of the joint about which it turns: metres, optical frame."},
    Field{&FittedBone::tail, "tail", "m", "(x, y, z) of its other end."},
    Field{&FittedBone::length_m, "length", "m", "Metres from head to tail."},
    Field{&FittedBone::global, "global", "xyzw", "Unit quaternion (x, y, z, w): optical frame from the bone's."},
    Field{&FittedBone::local, "local", "xyzw", "Unit quaternion (x, y, z, w): parent's frame from the bone's."},
    Field{&FittedBone::covariance, "covariance", "mm2", "Of the head, square metres: xx, xy, xz, yy, yz, zz."},
    Field{&FittedBone::confidence, "confidence", "", "Probability that the head is within 10 cm of the truth, 0 to 1."},
    Field{&FittedBone::state, "state", "",
          "observed where the camera sees flesh about its head, otherwise predicted."}};

/// Calls `see` with every Field of a struct.
template <class Struct, class See>
void visit_fields(const See& see) {
  std::apply([&](const auto&... fields) { (see(fields), ...); }, kFields<Struct>);
}

/// Returns a field's key in JSON: name and unit, such as "velocity_m_s".
template <class Struct, class Value>
std::string key_of(const Field<Struct, Value>& field) {
  const std::string name = field.name, unit = field.unit;
  return unit.empty() ? name : name + "_" + unit;
}

}  // namespace vesalius
