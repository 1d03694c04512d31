// Prints sizes and offsets of the structures of vesalius.h, an offset for each number in them; the coefficients of the
// lens, which C# has as one array, once.

#include <stddef.h>
#include <stdio.h>
#include <vesalius/vesalius.h>

#define AT(type, member) printf(" %zu", offsetof(type, member))
#define BEGIN(name, type) printf("%s %zu:", name, sizeof(type))
#define END() printf("\n")

static void print_given(void) {
  BEGIN("option", vesalius_option);
  AT(vesalius_option, struct_size), AT(vesalius_option, kind), AT(vesalius_option, name), AT(vesalius_option, value);
  AT(vesalius_option, unit), AT(vesalius_option, help), AT(vesalius_option, low), AT(vesalius_option, high);
  END();
  BEGIN("camera", vesalius_camera);
  AT(vesalius_camera, struct_size), AT(vesalius_camera, lens), AT(vesalius_camera, width), AT(vesalius_camera, height);
  AT(vesalius_camera, fx), AT(vesalius_camera, fy), AT(vesalius_camera, cx), AT(vesalius_camera, cy);
  AT(vesalius_camera, distortion);
  END();
  BEGIN("frame", vesalius_frame);
  AT(vesalius_frame, struct_size), AT(vesalius_frame, depth_format), AT(vesalius_frame, depth);
  AT(vesalius_frame, depth_stride), AT(vesalius_frame, colour), AT(vesalius_frame, colour_stride);
  AT(vesalius_frame, colour_format), AT(vesalius_frame, has_time), AT(vesalius_frame, time_s);
  AT(vesalius_frame, up[0]), AT(vesalius_frame, up[1]), AT(vesalius_frame, up[2]), AT(vesalius_frame, has_up);
  END();
}

static void print_found(void) {
  BEGIN("person", vesalius_person);
  AT(vesalius_person, struct_size), AT(vesalius_person, id), AT(vesalius_person, state), AT(vesalius_person, score);
  AT(vesalius_person, box_u), AT(vesalius_person, box_v), AT(vesalius_person, box_width);
  AT(vesalius_person, box_height), AT(vesalius_person, yaw_rad), AT(vesalius_person, velocity_m_s[0]);
  AT(vesalius_person, velocity_m_s[1]), AT(vesalius_person, velocity_m_s[2]), AT(vesalius_person, stance);
  AT(vesalius_person, stature_m);
  END();
  BEGIN("joint", vesalius_joint);
  AT(vesalius_joint, x_m), AT(vesalius_joint, y_m), AT(vesalius_joint, z_m), AT(vesalius_joint, confidence);
  AT(vesalius_joint, state);
  END();
  BEGIN("part", vesalius_part);
  AT(vesalius_part, x_m), AT(vesalius_part, y_m), AT(vesalius_part, z_m), AT(vesalius_part, extent_m[0]);
  AT(vesalius_part, extent_m[1]), AT(vesalius_part, extent_m[2]), AT(vesalius_part, confidence);
  AT(vesalius_part, state);
  END();
}

static void print_bodies(void) {
  BEGIN("unseen", vesalius_unseen);
  AT(vesalius_unseen, why), AT(vesalius_unseen, behind);
  END();
  BEGIN("bone", vesalius_bone);
  AT(vesalius_bone, head_m[0]), AT(vesalius_bone, head_m[1]), AT(vesalius_bone, head_m[2]);
  AT(vesalius_bone, tail_m[0]), AT(vesalius_bone, tail_m[1]), AT(vesalius_bone, tail_m[2]);
  AT(vesalius_bone, rotation_xyzw[0]), AT(vesalius_bone, rotation_xyzw[1]), AT(vesalius_bone, rotation_xyzw[2]);
  AT(vesalius_bone, rotation_xyzw[3]), AT(vesalius_bone, length_m), AT(vesalius_bone, confidence);
  AT(vesalius_bone, state);
  END();
  BEGIN("rotation", vesalius_rotation);
  AT(vesalius_rotation, x), AT(vesalius_rotation, y), AT(vesalius_rotation, z), AT(vesalius_rotation, w);
  END();
}

int main(void) {
  print_given();
  print_found();
  print_bodies();
  return 0;
}
