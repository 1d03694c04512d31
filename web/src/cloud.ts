import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { FleshSurface } from './flesh';
import { AXIS_COLOURS, Marks } from './marks';
import { Measure } from './measure';
import { Rgb, css, depthRange, personColour } from './palette';
import { Body, CameraFacts, Found, Frame, Person, Xyz } from './protocol';
import { Skeletons, isSeen } from './skeleton';
import { TrackMemory, coloursByIndex, isHidden, numberOf, shownPeople } from './track';

export type Colouring = 'picture' | 'depth' | 'person' | 'part';
THREE.ColorManagement.enabled = false;  // colours are those of the picture as they are

const COLOURINGS: Colouring[] = ['picture', 'depth', 'person', 'part'];

const MOST_POINTS = 350_000;   // larger pictures are drawn by every second or third pixel
const MOST_RODS = 4096;
const MOST_BALLS = 2048;
const DASH_M = 0.03;           // of a predicted limb, and the gap after it
const ROD_M = 0.011;           // radius of a limb
const TRAIL_M = 0.02;          // radius of a trail where it is newest
const FLESH_OPACITY = 0.55;
const AXIS_ROD_M = 0.004;      // radius of an axis of a bone
const REACH_PX = 8;            // from a click to the points that are meant
const FLOOR_STEPS = 12;        // of half a metre

/** From the optical frame (x right, y down, z forward) to that of the view (x right, y up, z back). */
function toView([x, y, z]: Xyz): THREE.Vector3 {
  return new THREE.Vector3(x, -y, -z);
}

const POINT_SHADER = /* glsl */ `
precision highp float;
precision highp int;
precision highp usampler2D;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform usampler2D depthMap, peopleMap, partsMap;
uniform sampler2D colourMap, peopleColours, partColours, depthColours;
uniform ivec2 size;
uniform int stride, colouring;
uniform bool hasColour;
uniform vec4 intrinsics;  // fx, fy, cx, cy
uniform vec2 depthRange;  // mm
uniform float viewHeight; // device pixels
flat out vec3 tint;

float depthAt(ivec2 pixel) { return float(texelFetch(depthMap, clamp(pixel, ivec2(0), size - 1), 0).r); }
vec3 pointAt(ivec2 pixel, float mm) {
  float z = mm * 1e-3;
  return vec3((vec2(pixel) - intrinsics.zw) / intrinsics.xy * z, z) * vec3(1, -1, -1);
}
vec3 seenAt(ivec2 pixel) { return pointAt(pixel, depthAt(pixel)); }
// How much the surface is turned to the camera, from neighbours on both sides, so far apart that the sensor's noise does
// not show: one colour shows shape too.
float shade(ivec2 pixel, vec3 point) {
  int reach = 5;
  vec3 a = seenAt(pixel + ivec2(reach, 0)) - seenAt(pixel - ivec2(reach, 0));
  vec3 b = seenAt(pixel + ivec2(0, reach)) - seenAt(pixel - ivec2(0, reach));
  if (max(length(a), length(b)) > 0.06 * -point.z + 0.05) return 0.7;
  return 0.4 + 0.6 * abs(normalize(cross(a, b)).z);
}

void main() {
  int columns = (size.x + stride - 1) / stride;
  ivec2 pixel = ivec2(gl_VertexID % columns, gl_VertexID / columns) * stride;
  float mm = depthAt(pixel);
  if (mm == 0.0) {
    gl_Position = vec4(2, 2, 2, 1);
    gl_PointSize = 0.0;
    tint = vec3(0);
    return;
  }
  vec3 point = pointAt(pixel, mm);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(point, 1);
  float extent = 1.3 * float(stride) * mm * 1e-3 / intrinsics.x;
  gl_PointSize = clamp(extent * projectionMatrix[1][1] * 0.5 * viewHeight / gl_Position.w, 1.0, 24.0);

  float far = clamp((mm - depthRange.x) / (depthRange.y - depthRange.x), 0.0, 1.0);
  uint person = texelFetch(peopleMap, pixel, 0).r;
  uint part = texelFetch(partsMap, pixel, 0).r;
  vec3 picture = hasColour ? texelFetch(colourMap, pixel, 0).rgb : vec3(0.85 - 0.5 * far);
  float light = shade(pixel, point);
  if (colouring == 0) tint = hasColour ? picture : picture * light;
  else if (colouring == 1) tint = texelFetch(depthColours, ivec2(int(far * 255.0), 0), 0).rgb * light;
  else if (person == 255u) tint = mix(vec3(dot(picture, vec3(0.3, 0.6, 0.1))), vec3(0.65), 0.6) * (0.4 + 0.6 * light);
  else if (colouring == 2) tint = mix(texelFetch(peopleColours, ivec2(int(person), 0), 0).rgb * light, picture, 0.25);
  else tint = part == 255u ? vec3(0.3) : texelFetch(partColours, ivec2(int(part), 0), 0).rgb * (0.3 + 0.7 * light);
}`;

const FRAGMENT_SHADER = /* glsl */ `
precision highp float;
flat in vec3 tint;
out vec4 colour;
void main() { colour = vec4(tint, 1); }`;

function bytesTexture(bytes: Uint8Array, width: number, height: number): THREE.DataTexture {
  const texture = new THREE.DataTexture(bytes, width, height, THREE.RedIntegerFormat, THREE.UnsignedByteType);
  texture.internalFormat = 'R8UI';
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

function colourTable(colours: Rgb[]): THREE.DataTexture {
  const bytes = new Uint8Array(4 * 256);
  colours.slice(0, 256).forEach((colour, i) => bytes.set([...colour, 255], 4 * i));  // gaps stay black
  const texture = new THREE.DataTexture(bytes, 256, 1, THREE.RGBAFormat, THREE.UnsignedByteType);
  texture.needsUpdate = true;
  return texture;
}

/**
 * Many copies of one shape, each with a dark rim, over all else: a skeleton lies within its person's points. `begin`,
 * `add` and `end` make a frame's.
 */
class Copies {
  readonly group = new THREE.Group();
  private readonly fill: THREE.InstancedMesh;
  private readonly rim: THREE.InstancedMesh;
  count = 0;
  private readonly colour = new THREE.Color();
  private readonly larger = new THREE.Matrix4();

  /** Copies of a lower order are drawn first. */
  constructor(
    shape: THREE.BufferGeometry,
    private readonly most: number,
    private readonly rimScale: THREE.Vector3,
    order = 1,
  ) {
    const mesh = (at: number): THREE.InstancedMesh => {
      const made = new THREE.InstancedMesh(shape, new THREE.MeshBasicMaterial({ depthTest: false, transparent: true }), most);
      made.renderOrder = at;
      made.frustumCulled = false;
      made.count = 0;
      this.group.add(made);
      return made;
    };
    this.rim = mesh(order);
    this.fill = mesh(order + 0.1);
  }
  begin(): void {
    this.count = 0;
  }
  add(place: THREE.Matrix4, colour: Rgb): void {
    if (this.count === this.most) return;
    this.fill.setMatrixAt(this.count, place);
    this.rim.setMatrixAt(this.count, this.larger.copy(place).scale(this.rimScale));
    this.fill.setColorAt(this.count, this.colour.setRGB(colour[0] / 255, colour[1] / 255, colour[2] / 255));
    this.rim.setColorAt(this.count, this.colour.setRGB(0.05, 0.07, 0.1));
    ++this.count;
  }
  end(): void {
    for (const mesh of [this.fill, this.rim]) {
      mesh.count = this.count;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
  }
}

/** Lighter, for what is predicted. */
function pale(colour: Rgb): Rgb {
  return colour.map((value) => Math.round(value + 0.45 * (255 - value))) as Rgb;
}

/** A name that stands beside a person, or at a joint. */
interface Tag {
  element: HTMLElement;
  at: THREE.Vector3;
}

/** The point cloud of a frame with the people in it. Throws an error where the browser has no WebGL 2. */
export class Cloud {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(50, 1, 0.05, 60);
  private readonly controls: OrbitControls;
  private readonly material: THREE.RawShaderMaterial;
  private points: THREE.Points | null = null;
  private readonly rods: Copies;
  private readonly balls: Copies;
  private readonly trails: Copies;
  private readonly flesh = new THREE.Group();
  private readonly fleshMeshes: THREE.Mesh[];
  private readonly boxes = new THREE.LineSegments(
    new THREE.BufferGeometry(),
    new THREE.LineBasicMaterial({ vertexColors: true }),
  );
  private readonly floor: THREE.LineSegments;
  private body: Body | null = null;
  private frame: Frame | null = null;
  private tags: Tag[] = [];
  private wantsDraw = false;
  private followsCamera = false;
  private distance_m = 2.5;
  private isPlaced = false;
  selected = -1;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly names: HTMLElement,
    private readonly skeletons: Skeletons,
    private readonly memory: TrackMemory,
    private readonly marks: Marks,
    private readonly measure: Measure,
    choose: (xyz: Xyz | null) => void,
  ) {
    const context = canvas.getContext('webgl2', { antialias: true });
    if (!context) throw new Error('no WebGL 2');
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: POINT_SHADER,
      fragmentShader: FRAGMENT_SHADER,
      uniforms: {
        depthMap: { value: null },
        peopleMap: { value: null },
        partsMap: { value: null },
        colourMap: { value: colourTable([]) },
        peopleColours: { value: colourTable([]) },
        partColours: { value: colourTable([]) },
        depthColours: { value: null },
        size: { value: new THREE.Vector2() },
        stride: { value: 1 },
        colouring: { value: 2 },
        hasColour: { value: false },
        intrinsics: { value: new THREE.Vector4(1, 1, 0, 0) },
        depthRange: { value: new THREE.Vector2(500, 5000) },
        viewHeight: { value: 1 },
      },
    });
    const rod = new THREE.CylinderGeometry(1, 1, 1, 8, 1);
    rod.rotateX(Math.PI / 2);  // along z, as Object3D.lookAt turns it
    this.rods = new Copies(rod, MOST_RODS, new THREE.Vector3(1.6, 1.6, 1));
    this.balls = new Copies(new THREE.SphereGeometry(1, 12, 8), MOST_BALLS, new THREE.Vector3(1.3, 1.3, 1.3));
    this.trails = new Copies(rod, MOST_RODS, new THREE.Vector3(1.4, 1.4, 1), 0.5);
    // Depth first and then colour, so that of each body only what is in front is seen.
    this.fleshMeshes = [
      new THREE.MeshBasicMaterial({ colorWrite: false }),
      new THREE.MeshLambertMaterial({ vertexColors: true, transparent: true }),
    ].map((material, i) => {
      const mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
      material.transparent = true;  // both after the points
      mesh.renderOrder = 0.1 * (i + 1);
      mesh.frustumCulled = false;
      return mesh;
    });
    this.flesh.add(...this.fleshMeshes);
    const light = new THREE.DirectionalLight(0xffffff, 2.2);
    light.position.set(0.3, 0.4, 1);
    this.camera.add(light, light.target, new THREE.AmbientLight(0xffffff, 1.1));
    light.target.position.set(0, 0, -1);
    this.floor = new THREE.LineSegments(
      Cloud.floorGrid(),
      new THREE.LineBasicMaterial({ color: 0x7a8aa0, transparent: true, opacity: 0.55 }),
    );
    for (const thing of [this.boxes, this.floor]) thing.frustumCulled = false;
    this.scene.add(this.camera, this.flesh, this.trails.group, this.rods.group, this.balls.group, this.boxes, this.floor);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('start', () => (this.followsCamera = false));
    this.controls.addEventListener('change', () => this.draw());
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener('keydown', (event) => this.turnByKey(event));
    this.listenForClicks(choose);
    this.resetView();
  }

  /** A click is what does not turn the view; Enter takes what is in its middle. */
  private listenForClicks(choose: (xyz: Xyz | null) => void): void {
    const { canvas } = this;
    let began = [0, 0];
    canvas.addEventListener('pointerdown', (event) => (began = [event.clientX, event.clientY]));
    canvas.addEventListener('click', (event) => {
      const { left, top } = canvas.getBoundingClientRect();
      if (Math.hypot(event.clientX - began[0], event.clientY - began[1]) > 4) return;
      choose(this.pointAt(event.clientX - left, event.clientY - top));
    });
    canvas.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') choose(this.pointAt(canvas.clientWidth / 2, canvas.clientHeight / 2));
    });
  }

  /** The reading that is in front at a place of the view; null where there is none. */
  private pointAt(x: number, y: number): Xyz | null {
    if (!this.frame) return null;
    const { depth, found } = this.frame;
    const { width, fx, fy, cx, cy } = found.camera;
    const { clientWidth, clientHeight } = this.canvas;
    this.camera.updateMatrixWorld();
    const matrix = new THREE.Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    const at = new THREE.Vector4();
    const near: { xyz: Xyz; w: number; off: number }[] = [];
    depth.forEach((mm, i) => {
      if (mm === 0) return;
      const z = mm * 1e-3;
      const xyz: Xyz = [(((i % width) - cx) / fx) * z, ((Math.floor(i / width) - cy) / fy) * z, z];
      at.set(xyz[0], -xyz[1], -xyz[2], 1).applyMatrix4(matrix);
      const off = Math.hypot((0.5 + at.x / at.w / 2) * clientWidth - x, (0.5 - at.y / at.w / 2) * clientHeight - y);
      if (at.w > 0 && off < REACH_PX) near.push({ xyz, w: at.w, off });
    });
    const front = Math.min(...near.map(({ w }) => w));
    const [best] = near.filter(({ w }) => w < 1.02 * front + 0.02).sort((a, b) => a.off - b.off);
    return best?.xyz ?? null;
  }

  private static floorGrid(): THREE.BufferGeometry {
    const half = FLOOR_STEPS / 4;
    const corners: number[] = [];
    for (let i = 0; i <= FLOOR_STEPS; ++i) {
      const at = i / 2 - half;
      corners.push(at, 0, -half, at, 0, half, -half, 0, at, half, 0, at);
    }
    return new THREE.BufferGeometry().setAttribute('position', new THREE.Float32BufferAttribute(corners, 3));
  }

  setBody(body: Body, colours: Rgb[]): void {
    this.body = body;
    this.material.uniforms.partColours.value = colourTable(colours);
    this.draw();
  }

  setDepthColours(colours: Rgb[]): void {
    this.material.uniforms.depthColours.value = colourTable(colours);
  }

  setColouring(colouring: Colouring): void {
    this.material.uniforms.colouring.value = COLOURINGS.indexOf(colouring);
    this.draw();
  }

  /** The next frame is of another source: the view goes to its people. */
  placeAnew(): void {
    this.isPlaced = false;
  }

  setBackground(colour: string): void {
    this.scene.background = new THREE.Color(colour);
    this.draw();
  }

  setShown(shown: { boxes: boolean; trails: boolean; bodies: boolean; floor: boolean }): void {
    this.boxes.visible = shown.boxes;
    this.trails.group.visible = shown.trails;
    this.flesh.visible = shown.bodies;
    this.floor.userData.wanted = shown.floor;
    this.showPeople();
    this.showFloor();
    this.draw();
  }

  /** Draws once more what marks and measure have now. */
  showMarks(): void {
    this.showPeople();
    this.draw();
  }

  /** Shows a frame; resolves when it is drawn. */
  show(frame: Frame): Promise<void> {
    this.frame = frame;
    const { camera } = frame.found;
    this.makePoints(camera);
    this.setTextures(frame);
    this.showPeople();
    this.showFloor();
    if (!this.isPlaced) this.resetView();
    if (this.followsCamera) this.viewOfCamera();
    return this.draw();
  }

  select(person: number): void {
    this.selected = person;
    this.showPeople();
    this.draw();
  }

  private makePoints(camera: CameraFacts): void {
    const { size, stride, intrinsics } = this.material.uniforms;
    intrinsics.value.set(camera.fx, camera.fy, camera.cx, camera.cy);
    if (this.points && size.value.x === camera.width && size.value.y === camera.height) return;
    size.value.set(camera.width, camera.height);
    let step = 1;
    while ((camera.width * camera.height) / (step * step) > MOST_POINTS) ++step;
    stride.value = step;
    const count = Math.ceil(camera.width / step) * Math.ceil(camera.height / step);
    if (this.points) {
      this.scene.remove(this.points);
      this.points.geometry.dispose();
    }
    // The shader makes the points of the depth picture; three.js only learns from this how many there are.
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Uint8Array(count), 1));
    geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), Infinity);
    this.points = new THREE.Points(geometry, this.material);
    this.points.frustumCulled = false;
    this.scene.add(this.points);
  }

  private setTextures(frame: Frame): void {
    const { uniforms } = this.material;
    const { width, height } = frame.found.camera;
    const depth = new THREE.DataTexture(frame.depth, width, height, THREE.RedIntegerFormat, THREE.UnsignedShortType);
    depth.internalFormat = 'R16UI';
    depth.unpackAlignment = 1;
    depth.needsUpdate = true;
    const replace = (name: string, texture: THREE.Texture): void => {
      (uniforms[name].value as THREE.Texture | null)?.dispose();
      uniforms[name].value = texture;
    };
    replace('depthMap', depth);
    replace('peopleColours', colourTable(coloursByIndex(frame.found)));
    replace('peopleMap', bytesTexture(frame.labels.people, width, height));
    replace('partsMap', bytesTexture(frame.labels.parts, width, height));
    uniforms.hasColour.value = frame.colour !== null;
    if (frame.colour) {
      const colour = new THREE.Texture(frame.colour);
      colour.flipY = false;
      colour.generateMipmaps = false;
      colour.minFilter = colour.magFilter = THREE.NearestFilter;
      colour.needsUpdate = true;
      replace('colourMap', colour);
    }
    uniforms.depthRange.value.set(...depthRange(frame.depth));
  }

  private showPeople(): void {
    const all = [this.rods, this.balls, this.trails];
    for (const copies of all) copies.begin();
    const surface = new FleshSurface();
    const corners: number[] = [];
    const tints: number[] = [];
    this.clearTags();
    if (this.frame && this.body) {
      for (const person of shownPeople(this.frame.found)) {
        this.addSkeleton(person);
        this.addMarks(person);
        if (this.trails.group.visible) this.addTrail(person);
        if (this.flesh.visible) Cloud.addFlesh(person, this.frame, surface);
        if (this.boxes.visible) this.addBox(person, this.frame, corners, tints);
      }
    }
    this.addMeasured();
    for (const copies of all) copies.end();
    this.showFlesh(surface);
    const box = new THREE.BufferGeometry();
    box.setAttribute('position', new THREE.Float32BufferAttribute(corners, 3));
    box.setAttribute('color', new THREE.Float32BufferAttribute(tints, 3));
    this.boxes.geometry.dispose();
    this.boxes.geometry = box;
  }

  private addSkeleton(person: Person): void {
    const strong = this.selected < 0 || this.selected === numberOf(person);
    const tint = personColour(numberOf(person));
    const { points, links } = this.skeletons.of(person);
    for (const [a, b] of links) {
      const from = points[a];
      const to = points[b];
      if (!from || !to) continue;
      const seen = isSeen(from, to);
      const radius = ROD_M * (strong ? 1 : 0.6) * (seen ? 0.4 + 0.6 * Math.min(from.confidence, to.confidence) : 0.5);
      Cloud.addLimb(this.rods, toView(from.xyz), toView(to.xyz), radius, seen ? tint : pale(tint), !seen);
    }
    const place = new THREE.Matrix4();
    let top = person.position_m ? toView(person.position_m) : null;
    for (const point of points) {
      if (!point) continue;
      const at = toView(point.xyz);
      const radius = point.state === 'observed' ? 0.012 + 0.016 * point.confidence : 0.012;
      place.makeScale(radius, radius, radius).setPosition(at);
      this.balls.add(place, point.state === 'observed' ? tint : pale(tint));
      if (!top || at.y > top.y) top = at;
    }
    if (top) this.addTag(person, top.clone().add(new THREE.Vector3(0, 0.15, 0)));
  }

  /** Of everybody, or of the one who is chosen. */
  private addMarks(person: Person): void {
    if (this.selected >= 0 && this.selected !== numberOf(person)) return;
    for (const { at, ends } of this.marks.axesOf(person)) {
      ends.forEach((end, i) => Cloud.addLimb(this.rods, toView(at), toView(end), AXIS_ROD_M, AXIS_COLOURS[i], false));
    }
    for (const { xyz, text, isLeft } of this.marks.textsOf(person)) {
      this.addText(text, isLeft ? 'mark left' : 'mark', toView(xyz));
    }
  }

  private addMeasured(): void {
    const points = this.measure.points.map(toView);
    const white: Rgb = [255, 255, 255];
    const place = new THREE.Matrix4();
    for (const at of points) this.balls.add(place.makeScale(0.015, 0.015, 0.015).setPosition(at), white);
    if (points.length === 2) Cloud.addLimb(this.rods, points[0], points[1], AXIS_ROD_M, white, false);
  }

  /** Where the trunk was, ever thinner; dashed where that is a guess. */
  private addTrail(person: Person): void {
    const tint = personColour(numberOf(person));
    this.memory.trail(person).forEach((piece, i) => {
      if (piece.hidden && i % 2 === 1) return;
      Cloud.addLimb(this.trails, toView(piece.from), toView(piece.to), TRAIL_M * (1 - 0.85 * piece.age), piece.hidden ? pale(tint) : tint, false);
    });
  }

  private static addFlesh(person: Person, frame: Frame, surface: FleshSurface): void {
    const tint = personColour(numberOf(person)).map((value) => value / 255);
    const opacity = isHidden(person) ? 0.5 * FLESH_OPACITY : FLESH_OPACITY;
    for (const bone of frame.flesh?.[person.index] ?? []) surface.add(bone, [...tint, opacity]);
  }

  private showFlesh(surface: FleshSurface): void {
    const shape = new THREE.BufferGeometry();
    shape.setAttribute('position', new THREE.Float32BufferAttribute(surface.places, 3));
    shape.setAttribute('color', new THREE.Float32BufferAttribute(surface.tints, 4));
    shape.setIndex(surface.triangles);
    shape.scale(1, -1, -1);  // half a turn about x, into the frame of the view
    shape.computeVertexNormals();
    this.fleshMeshes[0].geometry.dispose();
    for (const mesh of this.fleshMeshes) mesh.geometry = shape;
  }

  /** A rod from `a` to `b`, or dashes where the limb is predicted. */
  private static addLimb(to: Copies, a: THREE.Vector3, b: THREE.Vector3, radius: number, tint: Rgb, dashed: boolean): void {
    const length = a.distanceTo(b);
    if (length < 1e-4) return;
    const rod = new THREE.Object3D();
    const add = (from: number, until: number): void => {
      rod.position.lerpVectors(a, b, (from + until) / 2);
      rod.scale.set(radius, radius, (until - from) * length);
      rod.lookAt(b);
      rod.updateMatrix();
      to.add(rod.matrix, tint);
    };
    if (!dashed) return add(0, 1);
    const dashes = Math.max(1, Math.round((length / DASH_M + 1) / 2));
    for (let i = 0; i < dashes; ++i) add((2 * i) / (2 * dashes - 1), (2 * i + 1) / (2 * dashes - 1));
  }

  /** The box around the person's points, without the hundredth that is outermost: depth is ragged at borders. */
  private addBox(person: Person, frame: Frame, corners: number[], tints: number[]): void {
    const { camera } = frame.found;
    const [left, top, width, height] = person.box_px;
    const along: number[][] = [[], [], []];
    for (let v = top; v < top + height; v += 2) {
      for (let u = left; u < left + width; u += 2) {
        const pixel = v * camera.width + u;
        if (frame.labels.people[pixel] !== person.index || frame.depth[pixel] === 0) continue;
        const z = frame.depth[pixel] * 1e-3;
        along[0].push(((u - camera.cx) / camera.fx) * z);
        along[1].push(((v - camera.cy) / camera.fy) * z);
        along[2].push(z);
      }
    }
    if (along[0].length === 0) return;
    for (const values of along) values.sort((a, b) => a - b);
    const at = (axis: number, share: number): number => along[axis][Math.round(share * (along[axis].length - 1))];
    const corner = (i: number): number[] =>
      toView([at(0, i & 1 ? 0.99 : 0.01), at(1, i & 2 ? 0.995 : 0.005), at(2, i & 4 ? 0.99 : 0.01)]).toArray();
    const tint = personColour(numberOf(person)).map((value) => value / 255);
    for (let i = 0; i < 8; ++i) {
      for (const bit of [1, 2, 4]) {
        if (i & bit) continue;
        corners.push(...corner(i), ...corner(i | bit));
        tints.push(...tint, ...tint);
      }
    }
  }

  private showFloor(): void {
    const floor = this.frame?.floor;
    this.floor.visible = !!floor && this.floor.userData.wanted !== false;
    if (!floor) return;
    const normal = toView(floor.normal);
    // One that was seen for long is sure; another may be gone in the next frame.
    (this.floor.material as THREE.LineBasicMaterial).opacity = floor.lasting ? 0.7 : 0.35;
    const first = this.frame?.found.people[0];
    const near = first?.position_m ?? first?.parts[this.body?.parts[0]?.name ?? '']?.xyz_m ?? [0, 0, 3];
    const centre = toView(near);
    centre.addScaledVector(normal, floor.offset_m - normal.dot(centre));
    this.floor.position.copy(centre);
    this.floor.quaternion.setFromUnitVectors(new THREE.Vector3(0, -1, 0), normal);
  }

  private addTag(person: Person, at: THREE.Vector3): void {
    const word = person.state === 'tracked' ? person.stance : (person.state ?? person.score.toFixed(2));
    const text = word === 'unknown' ? String(numberOf(person)) : `${numberOf(person)} · ${word}`;
    const element = this.addText(text, 'tag', at);
    element.classList.toggle('hidden-person', isHidden(person));
    element.style.borderColor = css(personColour(numberOf(person)));
  }

  private addText(text: string, className: string, at: THREE.Vector3): HTMLElement {
    const element = document.createElement('span');
    element.className = className;
    element.textContent = text;
    this.names.append(element);
    this.tags.push({ element, at });
    return element;
  }

  private clearTags(): void {
    this.names.replaceChildren();
    this.tags = [];
  }

  /** The view from the side, towards the people, or the middle of what is seen. */
  resetView(): void {
    this.followsCamera = false;
    const target = new THREE.Vector3(0, 0, -this.distance_m);
    if (this.frame) {
      const [near, far] = depthRange(this.frame.depth);
      target.copy(Cloud.middle(this.frame.found) ?? new THREE.Vector3(0, 0, -(near + far) / 2000));
      this.distance_m = -target.z;
      this.isPlaced = true;
    }
    const d = this.distance_m;
    this.camera.fov = 50;
    this.camera.position.set(target.x + 0.35 * d, target.y + 0.22 * d, 0.05 * d);
    this.controls.target.copy(target);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /** The median of the people's parts along each axis. */
  private static middle(found: Found): THREE.Vector3 | null {
    const all = found.people.flatMap((person) => Object.values(person.parts).flatMap((part) => (part.xyz_m ? [part.xyz_m] : [])));
    if (all.length === 0) return null;
    const median = (axis: number): number => all.map((xyz) => xyz[axis]).sort((a, b) => a - b)[Math.floor(all.length / 2)];
    return toView([median(0), median(1), median(2)]);
  }

  /** What the camera sees: its place, direction and angle. */
  viewOfCamera(): void {
    if (!this.frame) return;
    this.followsCamera = true;
    const { width, height, fx, fy } = this.frame.found.camera;
    const tall = height / (2 * fy);
    const wide = width / (2 * fx) / this.camera.aspect;
    this.camera.fov = (360 / Math.PI) * Math.atan(Math.max(tall, wide));
    this.camera.position.set(0, 0, 0);
    this.controls.target.set(0, 0, -this.distance_m);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  private turnByKey(event: KeyboardEvent): void {
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const turn = turns[event.key];
    const zoom = { '+': 0.9, '=': 0.9, '-': 1 / 0.9 }[event.key];
    if (!turn && !zoom) return;
    event.preventDefault();
    event.stopPropagation();
    this.followsCamera = false;
    const { target } = this.controls;
    const offset = this.camera.position.clone().sub(target);
    if (zoom) offset.multiplyScalar(zoom);
    if (turn && event.shiftKey) {
      const move = new THREE.Vector3(-turn[0], -turn[1], 0).multiplyScalar(0.03 * offset.length());
      target.sub(move.applyQuaternion(this.camera.quaternion));
    } else if (turn) {
      const sphere = new THREE.Spherical().setFromVector3(offset);
      sphere.theta += 0.08 * turn[0];
      sphere.phi -= 0.08 * turn[1];
      offset.setFromSpherical(sphere.makeSafe());
    }
    this.camera.position.copy(target).add(offset);
    this.controls.update();
    this.draw();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (this.followsCamera) this.viewOfCamera();
    this.draw();
  }

  /** Draws with the screen's next picture; resolves when that was done. */
  private drawn: Promise<void> = Promise.resolve();
  draw(): Promise<void> {
    if (this.wantsDraw) return this.drawn;
    this.wantsDraw = true;
    this.drawn = new Promise((resolve) =>
      requestAnimationFrame(() => {
        this.wantsDraw = false;
        this.drawNow();
        resolve();
      }),
    );
    return this.drawn;
  }

  /** Draws at once, so that the canvas can be copied. */
  drawNow(): void {
    if (!this.points) return;
    this.material.uniforms.viewHeight.value = this.canvas.height;
    this.renderer.render(this.scene, this.camera);
    this.placeTags();
  }

  private placeTags(): void {
    const width = this.names.clientWidth;
    const height = this.names.clientHeight;
    const at = new THREE.Vector3();
    for (const tag of this.tags) {
      at.copy(tag.at).project(this.camera);
      tag.element.hidden = at.z > 1;
      tag.element.style.translate = `${(0.5 + at.x / 2) * width}px ${(0.5 - at.y / 2) * height}px`;
    }
  }

  /** Numbers of what is drawn. */
  counts(): { points: number; rods: number; balls: number; trails: number; flesh: number } {
    const stride = this.material.uniforms.stride.value as number;
    let points = 0;
    const width = this.frame?.found.camera.width ?? 0;
    this.frame?.depth.forEach((mm, i) => {
      if (mm !== 0 && (i % width) % stride === 0 && Math.floor(i / width) % stride === 0) ++points;
    });
    const flesh = this.fleshMeshes[0].geometry.index?.count ?? 0;
    return { points, rods: this.rods.count, balls: this.balls.count, trails: this.trails.count, flesh: flesh / 3 };
  }
}

