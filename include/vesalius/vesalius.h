#ifndef VESALIUS_H
#define VESALIUS_H

// The C interface of vesalius: people in pictures of depth cameras. Plain C99, also for C++; docs/c.md begins with a
// program. Link libvesalius.so (pkg-config vesalius, or find_package(vesalius COMPONENTS c) and vesalius::c).
//
// Units. Depth is in millimetres or metres along the optical axis. Places are metres in the optical frame: x right, y
// down, z away from the camera. Left and right are the person's own. Pixels count from the left and from the top, from
// 0; the centre of a pixel is a whole number. Texts are UTF-8 that ends with a zero.
//
// Errors. A function that can fail returns a vesalius_status, or NULL or -1 where it says so; vesalius_last_error()
// then has one line about it. What a failed function should have written is left as it was, but handles, which become
// NULL. No C++ exception leaves the library. NULL where a pointer is needed, numbers that are none, sizes that do not
// fit and the like are VESALIUS_ERROR_ARGUMENT; only pointers to memory that is not there, too short or freed cannot be
// told.
//
// Memory. What has a _destroy function belongs to the caller, who calls it once; NULL is fine. Handles may be destroyed
// in any order: a tracker, or people, keep what they need of their detector. The library copies what it is given before
// it returns. Texts that it gives belong to the handle that they are asked of.
//
// Threads. A detector and people may be used from several threads at once. A tracker may be too, and works at one frame
// at a time; the order of the frames is the caller's matter. Options are used by one thread at a time. A handle is
// destroyed when no other thread uses it any more.
//
// Stability. VESALIUS_ABI_VERSION is also in the library's name, libvesalius.so.0. Within one ABI version functions and
// constants are only added, and structures that begin with struct_size only grow at their end: a program goes on
// working with a later library without being compiled again. Structures without struct_size never change. Before a
// call, set struct_size to sizeof the structure and everything that is not used to 0. A library refuses what it does
// not know yet.

// NOLINTBEGIN(modernize-*): what is C is no old C++.

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define VESALIUS_API __attribute__((visibility("default")))
#else
#define VESALIUS_API
#endif

// ---------------------------------------------------------------------------------------------------------------------
// Versions and errors

/// The version of this header. Before 1.0 a minor version may change what is found, not how this interface is called.
#define VESALIUS_VERSION_MAJOR 0
#define VESALIUS_VERSION_MINOR 1
#define VESALIUS_VERSION_PATCH 0

/// The version of the binary interface that this header describes.
#define VESALIUS_ABI_VERSION 0

/// Returns the version of the library, e.g. "0.1.0".
VESALIUS_API const char* vesalius_version(void);

/// Returns the version of the library's binary interface. Programs that load the library by themselves compare it with
/// VESALIUS_ABI_VERSION.
VESALIUS_API int32_t vesalius_abi_version(void);

/// How a call ended: one of VESALIUS_OK and VESALIUS_ERROR_*. Later versions may know more errors.
typedef int32_t vesalius_status;
enum {
  VESALIUS_OK = 0,
  VESALIUS_ERROR_ARGUMENT = 1,  ///< an argument, option or structure is wrong; the caller's mistake
  VESALIUS_ERROR_CAPACITY = 2,  ///< the buffer is too small; the count says what is needed
  VESALIUS_ERROR_INPUT = 3,     ///< a file or its content cannot be used
  VESALIUS_ERROR_DEVICE = 4,    ///< the card is not there, ran out of memory or was lost
  VESALIUS_ERROR_MEMORY = 5,    ///< out of memory
  VESALIUS_ERROR_INTERNAL = 6   ///< a defect of the library
};

/// Returns one line about the last call of this thread that failed; "" if none has. It is valid until the next call of
/// this thread that fails.
VESALIUS_API const char* vesalius_last_error(void);

// ---------------------------------------------------------------------------------------------------------------------
// Options

/// The options of the detector, of tracking and of fitted bodies: those that `vesalius options` lists, under the same
/// names, e.g. "refine.min-score".
typedef struct vesalius_options vesalius_options;

/// What values an option takes.
enum {
  VESALIUS_OPTION_NUMBER = 0,
  VESALIUS_OPTION_WHOLE_NUMBER = 1,
  VESALIUS_OPTION_TRUTH = 2,  ///< "true" or "false"
  VESALIUS_OPTION_WORD = 3
};

/// The description of an option. The texts are valid until its vesalius_options changes or is destroyed.
typedef struct vesalius_option {
  uint32_t struct_size;
  int32_t kind;       ///< VESALIUS_OPTION_*
  const char* name;   ///< e.g. "refine.min-score"
  const char* value;  ///< as vesalius_options_set takes it
  const char* unit;   ///< e.g. "m"; "" for counts and ratios
  const char* help;   ///< one sentence
  double low;         ///< smallest and largest value of numbers and whole numbers
  double high;
} vesalius_option;

/// Gives `options` the defaults.
VESALIUS_API vesalius_status vesalius_options_create(vesalius_options** options);

/// Sets the option `name` to what a text states, in the C locale whatever the program's is: "0.9", "12", "true", a
/// word. VESALIUS_ERROR_ARGUMENT for an option that does not exist, a value of another kind or one out of range.
VESALIUS_API vesalius_status vesalius_options_set(vesalius_options* options, const char* name, const char* value);

/// Sets the options that a file states, as `vesalius detect --options` does (TOML, docs/options.md).
/// VESALIUS_ERROR_INPUT with the file and the line if one does not fit; then no option is changed.
VESALIUS_API vesalius_status vesalius_options_load(vesalius_options* options, const char* path);

/// Returns how many options there are; -1 for NULL.
VESALIUS_API int32_t vesalius_options_count(const vesalius_options* options);

/// Describes option `index`, 0 to count - 1, with its value now.
VESALIUS_API vesalius_status vesalius_options_get(const vesalius_options* options, int32_t index,
                                                  vesalius_option* option);

VESALIUS_API void vesalius_options_destroy(vesalius_options* options);

// ---------------------------------------------------------------------------------------------------------------------
// Frames

/// How a lens bends the rays that a pinhole camera sees; the coefficients of vesalius_camera in this order.
enum {
  VESALIUS_LENS_PINHOLE = 0,        ///< not at all: all coefficients are 0
  VESALIUS_LENS_BROWN_CONRADY = 1,  ///< k1 k2 p1 p2 k3 k4 k5 k6, as OpenCV (ROS: plumb_bob, rational_polynomial)
  VESALIUS_LENS_MODIFIED_BROWN_CONRADY = 2,  ///< k1 k2 p1 p2 k3, as librealsense
  VESALIUS_LENS_KANNALA_BRANDT = 3           ///< k1 k2 k3 k4, a fisheye (ROS: equidistant)
};

/// The camera of the depth picture. With a lens, pictures are turned into those of the pinhole camera of the same size,
/// focal length and principal point first, and boxes, masks and labels are in that picture.
typedef struct vesalius_camera {
  uint32_t struct_size;
  int32_t lens;          ///< VESALIUS_LENS_*
  int32_t width;         ///< pixels, 1 to 16000
  int32_t height;        ///< pixels, 1 to 16000
  float fx;              ///< focal length, pixels, above 0
  float fy;              ///< focal length, pixels, above 0
  float cx;              ///< principal point, pixels
  float cy;              ///< principal point, pixels
  double distortion[8];  ///< coefficients of the lens; 0 beyond those that it has
} vesalius_camera;

/// How depth is stored.
enum {
  VESALIUS_DEPTH_MILLIMETRES = 0,  ///< uint16_t; 0 = no reading
  VESALIUS_DEPTH_METRES = 1        ///< float; 0, NaN, infinite, negative or above 65.5 = no reading
};

/// How a pixel of colour is stored, 8 bits each, sRGB.
enum {
  VESALIUS_COLOUR_RGB = 0,   ///< 3 bytes
  VESALIUS_COLOUR_BGR = 1,   ///< 3 bytes
  VESALIUS_COLOUR_RGBA = 2,  ///< 4 bytes, the last of which does not matter
  VESALIUS_COLOUR_BGRA = 3   ///< 4 bytes, the last of which does not matter
};

/// One picture of the size of its camera. Strides are bytes from a row to the one below it; 0 for rows without gaps,
/// negative for pictures that are stored bottom up, whose pointer is that of the top row.
typedef struct vesalius_frame {
  uint32_t struct_size;
  int32_t depth_format;  ///< VESALIUS_DEPTH_*
  const void* depth;     ///< height rows of width values
  int64_t depth_stride;
  const uint8_t* colour;  ///< registered to depth: the same pixel shows the same place; NULL without colour
  int64_t colour_stride;
  int32_t colour_format;  ///< VESALIUS_COLOUR_*
  int32_t has_time;       ///< not 0: time_s is the time of the frame
  double time_s;          ///< seconds since any moment; without times a tracker takes frames as 1/track.rate s apart
  float up[3];     ///< away from the ground, optical frame, any length above 0, as a sensor of acceleration has it
  int32_t has_up;  ///< not 0: up is known
} vesalius_frame;

// ---------------------------------------------------------------------------------------------------------------------
// Detector and tracker

/// Finds the people in one frame at a time.
typedef struct vesalius_detector vesalius_detector;
/// Follows people over the frames of one source: ids that hold, fitted bodies (docs/tracking.md).
typedef struct vesalius_tracker vesalius_tracker;
/// The people of one frame.
typedef struct vesalius_people vesalius_people;

/// Loads a trained model, a file of several megabytes, and makes a detector: once, not for every frame.
///   model    path of a model file; NULL: default.model in $VESALIUS_MODELS, in "models" beside the library, or where
///            `cmake --install` put it
///   options  copied; NULL: the defaults
///   threads  most threads at work on one call, 0 (as many as the machine has) to 1024. While a call runs, the limit is
///            that of the whole process for work on oneTBB; if several limits are there at once, the smallest counts
///   device   what labels pixels: "cpu", "cuda", "cuda:N" (a card), or "auto", a card where one works and otherwise the
///            processor; NULL: "cpu". Results are the same
/// VESALIUS_ERROR_INPUT for a file that cannot be used, VESALIUS_ERROR_DEVICE for a card that is not there.
VESALIUS_API vesalius_status vesalius_detector_create(const char* model, const vesalius_options* options,
                                                      int32_t threads, const char* device,
                                                      vesalius_detector** detector);

/// Finds the people in a frame, the most certain first; none is no error. The same frame gives the same bytes for any
/// number of threads.
VESALIUS_API vesalius_status vesalius_detector_detect(const vesalius_detector* detector, const vesalius_frame* frame,
                                                      const vesalius_camera* camera, vesalius_people** people);

VESALIUS_API void vesalius_detector_destroy(vesalius_detector* detector);

/// Returns how many parts the body has; -1 for NULL.
VESALIUS_API int32_t vesalius_detector_part_count(const vesalius_detector* detector);
/// Returns the name of a part, 0 to count - 1, e.g. "l_knee"; NULL for an index that is not there.
VESALIUS_API const char* vesalius_detector_part_name(const vesalius_detector* detector, int32_t part);
/// Returns how many joint sets there are; -1 for NULL.
VESALIUS_API int32_t vesalius_detector_joint_set_count(const vesalius_detector* detector);
/// Returns the name of a joint set, 0 to count - 1, e.g. "k4abt32"; NULL for an index that is not there.
VESALIUS_API const char* vesalius_detector_joint_set_name(const vesalius_detector* detector, int32_t set);
/// Returns how many joints a joint set has; -1 for a set that is not there. NULL is the set "k4abt32".
VESALIUS_API int32_t vesalius_detector_joint_count(const vesalius_detector* detector, const char* joint_set);
/// Returns the name of a joint of a set, 0 to count - 1, e.g. "PELVIS"; NULL for one that is not there.
VESALIUS_API const char* vesalius_detector_joint_name(const vesalius_detector* detector, const char* joint_set,
                                                      int32_t joint);

/// Returns how many bones the bodies have that a tracker fits to people; -1 for NULL.
VESALIUS_API int32_t vesalius_detector_bone_count(const vesalius_detector* detector);
/// Returns the name of a bone, 0 to count - 1, e.g. "l_thigh"; NULL for an index that is not there.
VESALIUS_API const char* vesalius_detector_bone_name(const vesalius_detector* detector, int32_t bone);
/// Returns the bone of which a bone is the child, which comes before it; -1 for the first, which has none, and for an
/// index that is not there.
VESALIUS_API int32_t vesalius_detector_bone_parent(const vesalius_detector* detector, int32_t bone);

/// Makes a tracker of what `detector` finds, with the options track.* and fit.* of that detector.
VESALIUS_API vesalius_status vesalius_tracker_create(const vesalius_detector* detector, vesalius_tracker** tracker);

/// Takes the next frame. Gives the people by their ids; hidden ones, and those that were lost in this frame, are among
/// them.
VESALIUS_API vesalius_status vesalius_tracker_update(vesalius_tracker* tracker, const vesalius_frame* frame,
                                                     const vesalius_camera* camera, vesalius_people** people);

VESALIUS_API void vesalius_tracker_destroy(vesalius_tracker* tracker);

// ---------------------------------------------------------------------------------------------------------------------
// People

/// What is known about somebody over the frames.
enum {
  VESALIUS_PERSON_SEEN = 0,     ///< found by a detector, which does not follow people
  VESALIUS_PERSON_NEW = 1,      ///< found, but not yet for long enough to be sure of
  VESALIUS_PERSON_TRACKED = 2,  ///< found in this frame
  VESALIUS_PERSON_HIDDEN = 3,   ///< not found in this frame; the place is a prediction
  VESALIUS_PERSON_LOST = 4      ///< given up in this frame; the id is kept for somebody who comes back
};

/// How somebody holds the body over the floor.
enum {
  VESALIUS_STANCE_UNKNOWN = 0,  ///< no floor is seen, or not for long enough; always from a detector
  VESALIUS_STANCE_STANDING = 1,
  VESALIUS_STANCE_SITTING = 2,
  VESALIUS_STANCE_LYING = 3,
  VESALIUS_STANCE_FALLEN = 4  ///< lying after a fall
};

typedef struct vesalius_person {
  uint32_t struct_size;
  int32_t id;     ///< from 1, the same over the frames of a tracker, never used for two people; 0 from a detector
  int32_t state;  ///< VESALIUS_PERSON_*
  float score;    ///< how certain it is by this frame alone, 0 to 1
  int32_t box_u;  ///< smallest box around the mask, pixels: its left column ...
  int32_t box_v;  ///< ... and top row; width and height are 0 where the person is not found in the frame
  int32_t box_width;
  int32_t box_height;
  float yaw_rad;          ///< which way the person faces: 0 the camera, positive turned to the own left; NaN if unknown
  float velocity_m_s[3];  ///< velocity of the trunk, metres a second, optical frame; NaN from a detector
  int32_t stance;         ///< VESALIUS_STANCE_*
  float stature_m;        ///< height standing upright, metres, by the fitted body; NaN without one
} vesalius_person;

/// Whether a joint or part was seen.
enum {
  VESALIUS_STATE_NONE = 0,       ///< nothing is known of it: places are NaN
  VESALIUS_STATE_PREDICTED = 1,  ///< inferred from others
  VESALIUS_STATE_OBSERVED = 2
};

typedef struct vesalius_joint {
  float x_m, y_m, z_m;  ///< metres, optical frame
  float confidence;     ///< 0 to 1
  int32_t state;        ///< VESALIUS_STATE_*
} vesalius_joint;

typedef struct vesalius_part {
  float x_m, y_m, z_m;  ///< centre of what is visible of it, metres, optical frame
  float extent_m[3];    ///< standard deviations along its own axes, metres, largest first; 0 unless observed
  float confidence;     ///< 0 to 1
  int32_t state;        ///< VESALIUS_STATE_*
} vesalius_part;

/// Why a joint or part is not observed.
enum {
  VESALIUS_UNSEEN_NONE = 0,              ///< it is observed
  VESALIUS_UNSEEN_OUT_OF_PICTURE = 1,    ///< it would be beyond the picture, or in a border of it without readings
  VESALIUS_UNSEEN_BEHIND_PERSON = 2,     ///< somebody's pixels are nearer, also the person's own
  VESALIUS_UNSEEN_BEHIND_SOMETHING = 3,  ///< something else is nearer
  VESALIUS_UNSEEN_NO_DEPTH = 4,          ///< the camera has no readings where it would be
  VESALIUS_UNSEEN_NOT_SURE = 5           ///< nothing covers its place, or nobody knows the place
};

typedef struct vesalius_unseen {
  int32_t why;     ///< VESALIUS_UNSEEN_*; later versions may know more
  int32_t behind;  ///< index of the person who hides it, the person's own behind the own body; otherwise -1
} vesalius_unseen;

/// A bone of the body that a tracker fits to a person.
typedef struct vesalius_bone {
  float head_m[3];         ///< the joint about which it turns: metres, optical frame
  float tail_m[3];         ///< its other end
  float rotation_xyzw[4];  ///< unit quaternion: optical frame from the bone's
  float length_m;          ///< metres from head to tail
  float confidence;        ///< probability that the head lies within 10 cm of the truth, 0 to 1
  int32_t state;           ///< VESALIUS_STATE_* of the head
} vesalius_bone;

/// A rotation as a unit quaternion; NaN where it is unknown.
typedef struct vesalius_rotation {
  float x, y, z, w;
} vesalius_rotation;

/// Returns how many people there are; -1 for NULL.
VESALIUS_API int32_t vesalius_people_count(const vesalius_people* people);

/// Describes person `index`, 0 to count - 1.
VESALIUS_API vesalius_status vesalius_people_get(const vesalius_people* people, int32_t index, vesalius_person* person);

// The following copy an array of person `index` into the caller's buffer of `capacity` elements, and its length to
// `count`, which may be NULL. With a NULL buffer and capacity 0 they only tell the length. If the buffer is too small
// they write the length and nothing else: VESALIUS_ERROR_CAPACITY.

/// Joints of a joint set; NULL is the set "k4abt32". Their names and number are those of the detector.
VESALIUS_API vesalius_status vesalius_people_joints(const vesalius_people* people, int32_t index, const char* joint_set,
                                                    vesalius_joint* joints, int32_t capacity, int32_t* count);

/// Parts; their names and number are those of the detector.
VESALIUS_API vesalius_status vesalius_people_parts(const vesalius_people* people, int32_t index, vesalius_part* parts,
                                                   int32_t capacity, int32_t* count);

/// Why joints of a joint set are not observed, in the order of vesalius_people_joints; NULL is the set "k4abt32".
VESALIUS_API vesalius_status vesalius_people_joints_unseen(const vesalius_people* people, int32_t index,
                                                           const char* joint_set, vesalius_unseen* unseen,
                                                           int32_t capacity, int32_t* count);

/// Why parts are not observed, in the order of vesalius_people_parts.
VESALIUS_API vesalius_status vesalius_people_parts_unseen(const vesalius_people* people, int32_t index,
                                                          vesalius_unseen* unseen, int32_t capacity, int32_t* count);

/// Bones of the fitted body; their names and parents are those of the detector. None, which is no error, for people of
/// a detector and where no body could be fitted.
VESALIUS_API vesalius_status vesalius_people_bones(const vesalius_people* people, int32_t index, vesalius_bone* bones,
                                                   int32_t capacity, int32_t* count);

/// Rotations of the joints of a joint set, by the fitted body, in the convention of the tracker that names them:
/// optical frame from the joint's. NULL is the set "k4abt32", the one that has some.
VESALIUS_API vesalius_status vesalius_people_rotations(const vesalius_people* people, int32_t index,
                                                       const char* joint_set, vesalius_rotation* rotations,
                                                       int32_t capacity, int32_t* count);

/// The mask, width * height bytes, row by row without gaps: 1 on the person's pixels, 0 elsewhere.
VESALIUS_API vesalius_status vesalius_people_mask(const vesalius_people* people, int32_t index, uint8_t* mask,
                                                  int32_t capacity, int32_t* count);

/// The labels, width * height bytes, row by row without gaps: the part that each of the person's pixels shows, 255
/// elsewhere.
VESALIUS_API vesalius_status vesalius_people_labels(const vesalius_people* people, int32_t index, uint8_t* labels,
                                                    int32_t capacity, int32_t* count);

VESALIUS_API void vesalius_people_destroy(vesalius_people* people);

#ifdef __cplusplus
}
#endif

// NOLINTEND(modernize-*)

#endif
