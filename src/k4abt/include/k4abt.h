/* Functions of the interface of Azure Kinect Body Tracking, as vesalius's libk4abt.so answers them (docs/k4abt.md).
   All may be called from any thread. What was destroyed or released, NULL and what is no handle are told: functions
   fail as they say, with one line on the error output. */
#ifndef K4ABT_H
#define K4ABT_H

#include <k4abttypes.h>

#ifndef K4ABT_EXPORT
#define K4ABT_EXPORT __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Makes a tracker for captures of the camera that `sensor_calibration` describes. There may be several at a time.
   K4A_RESULT_FAILED for a calibration without depth or of another lens than Brown and Conrady's, for a model that
   cannot be read, and where no libk4a is found: that which the program has loaded, or else libk4a.so.1.4; $VESALIUS_K4A
   names another. */
K4ABT_EXPORT k4a_result_t k4abt_tracker_create(const k4a_calibration_t* sensor_calibration,
                                               k4abt_tracker_configuration_t config, k4abt_tracker_t* tracker_handle);

/* Ends a tracker with all captures that wait; frames that were fetched stay. Whoever waits for it is told it failed. */
K4ABT_EXPORT void k4abt_tracker_destroy(k4abt_tracker_t tracker_handle);

/* How much joints are smoothed over time from the next frame on: 0 (as at first) not at all, 1 most. */
K4ABT_EXPORT void k4abt_tracker_set_temporal_smoothing(k4abt_tracker_t tracker_handle, float smoothing_factor);

/* Gives a capture to the tracker, which takes a reference. While three wait already, waits itself for at most
   `timeout_in_ms` (0: not at all, K4A_WAIT_INFINITE: as long as it takes), then returns K4A_WAIT_RESULT_TIMEOUT.
   K4A_WAIT_RESULT_FAILED for a capture without depth, or of another size than the calibration's, and after a shutdown.
 */
K4ABT_EXPORT k4a_wait_result_t k4abt_tracker_enqueue_capture(k4abt_tracker_t tracker_handle,
                                                             k4a_capture_t sensor_capture_handle,
                                                             int32_t timeout_in_ms);

/* Fetches the bodies of the next capture, in the order in which they were given; no capture is left out. Waits for them
   as above, then returns K4A_WAIT_RESULT_TIMEOUT. K4A_WAIT_RESULT_FAILED after a shutdown, as soon as all are fetched.
   Up to three frames wait to be fetched; then no more captures are looked at. */
K4ABT_EXPORT k4a_wait_result_t k4abt_tracker_pop_result(k4abt_tracker_t tracker_handle,
                                                        k4abt_frame_t* body_frame_handle, int32_t timeout_in_ms);

/* Takes no more captures. Those that wait are still looked at and can be fetched. */
K4ABT_EXPORT void k4abt_tracker_shutdown(k4abt_tracker_t tracker_handle);

/* A frame has one reference when it is fetched, and is gone with the last. */
K4ABT_EXPORT void k4abt_frame_release(k4abt_frame_t body_frame_handle);
K4ABT_EXPORT void k4abt_frame_reference(k4abt_frame_t body_frame_handle);

/* The number of people who were found in the capture; 0 if it fails. */
K4ABT_EXPORT uint32_t k4abt_frame_get_num_bodies(k4abt_frame_t body_frame_handle);
/* The joints of the body of an index, from 0; K4A_RESULT_FAILED if there is none. */
K4ABT_EXPORT k4a_result_t k4abt_frame_get_body_skeleton(k4abt_frame_t body_frame_handle, uint32_t index,
                                                        k4abt_skeleton_t* skeleton);
/* Its id; K4ABT_INVALID_BODY_ID if there is none. */
K4ABT_EXPORT uint32_t k4abt_frame_get_body_id(k4abt_frame_t body_frame_handle, uint32_t index);

/* Times of the capture's depth, by the device's clock and by that of its host; 0 if it fails. */
K4ABT_EXPORT uint64_t k4abt_frame_get_device_timestamp_usec(k4abt_frame_t body_frame_handle);
K4ABT_EXPORT uint64_t k4abt_frame_get_system_timestamp_nsec(k4abt_frame_t body_frame_handle);
/* The former name of the first. */
K4ABT_EXPORT uint64_t k4abt_frame_get_timestamp_usec(k4abt_frame_t body_frame_handle);

/* A picture of K4A_IMAGE_FORMAT_CUSTOM8 in which each pixel of depth has the index of its body, or
   K4ABT_BODY_INDEX_MAP_BACKGROUND. The caller releases it; NULL if it fails. */
K4ABT_EXPORT k4a_image_t k4abt_frame_get_body_index_map(k4abt_frame_t body_frame_handle);

/* The capture that was given. The caller releases it; NULL if it fails. */
K4ABT_EXPORT k4a_capture_t k4abt_frame_get_capture(k4abt_frame_t body_frame_handle);

#ifdef __cplusplus
}
#endif

#endif
