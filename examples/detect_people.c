// People in a picture of depth: detect_people MODEL|- DEPTH WIDTH HEIGHT FX FY CX CY
//
// DEPTH holds HEIGHT rows of WIDTH values, uint16 as this machine stores them, millimetres, 0 where there is no
// reading;
// "-" is the model that comes with vesalius. docs/c.md explains the program.

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vesalius/vesalius.h>

// Ends the program unless a call went well.
static void expect(vesalius_status status) {
  if (status == VESALIUS_OK) return;
  fprintf(stderr, "detect_people: %s\n", vesalius_last_error());
  exit(1);
}

static uint16_t* read_depth(const char* path, const vesalius_camera* camera) {
  const size_t pixels = (size_t)camera->width * (size_t)camera->height;
  uint16_t* depth = malloc(pixels * sizeof *depth);
  FILE* file = fopen(path, "rb");
  if (depth == NULL || file == NULL || fread(depth, sizeof *depth, pixels, file) != pixels || fgetc(file) != EOF) {
    fprintf(stderr, "detect_people: %s: expected a file of %d x %d x 2 bytes\n", path, (int)camera->width,
            (int)camera->height);
    exit(1);
  }
  fclose(file);
  return depth;
}

static long millimetres(float metres) { return lround((double)metres * 1000.0); }

static void print_person(const vesalius_detector* detector, const vesalius_people* people, int32_t index) {
  vesalius_person person = {.struct_size = sizeof person};
  expect(vesalius_people_get(people, index, &person));
  printf("person %d: score %ld/1000, box %d %d %d %d\n", (int)index, millimetres(person.score), (int)person.box_u,
         (int)person.box_v, (int)person.box_width, (int)person.box_height);
  int32_t count = 0;
  expect(vesalius_people_joints(people, index, NULL, NULL, 0, &count));
  vesalius_joint* joints = malloc((size_t)count * sizeof *joints);
  if (joints == NULL) exit(1);
  expect(vesalius_people_joints(people, index, NULL, joints, count, &count));
  for (int32_t j = 0; j < count; ++j) {
    if (joints[j].state == VESALIUS_STATE_NONE) continue;
    printf("  %s: %ld %ld %ld mm\n", vesalius_detector_joint_name(detector, NULL, j), millimetres(joints[j].x_m),
           millimetres(joints[j].y_m), millimetres(joints[j].z_m));
  }
  free(joints);
}

int main(int argc, char** argv) {
  if (argc != 9) {
    fprintf(stderr, "usage: detect_people MODEL|- DEPTH WIDTH HEIGHT FX FY CX CY\n");
    return 2;
  }
  const vesalius_camera camera = {.struct_size = sizeof camera,
                                  .width = atoi(argv[3]),
                                  .height = atoi(argv[4]),
                                  .fx = strtof(argv[5], NULL),
                                  .fy = strtof(argv[6], NULL),
                                  .cx = strtof(argv[7], NULL),
                                  .cy = strtof(argv[8], NULL)};
  if (camera.width < 1 || camera.width > 16000 || camera.height < 1 || camera.height > 16000) {
    fprintf(stderr, "detect_people: expected a width and height of 1 to 16000\n");
    return 2;
  }
  vesalius_detector* detector = NULL;
  expect(vesalius_detector_create(strcmp(argv[1], "-") == 0 ? NULL : argv[1], NULL, 0, NULL, &detector));
  uint16_t* depth = read_depth(argv[2], &camera);
  const vesalius_frame frame = {.struct_size = sizeof frame, .depth = depth};
  vesalius_people* people = NULL;
  expect(vesalius_detector_detect(detector, &frame, &camera, &people));
  for (int32_t i = 0; i < vesalius_people_count(people); ++i) print_person(detector, people, i);
  vesalius_people_destroy(people);
  vesalius_detector_destroy(detector);
  free(depth);
  return 0;
}
