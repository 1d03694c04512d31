// Messages of the program (docs/formats.md).
import { unpackRuns, unpackRvl } from './codecs';

export const BACKGROUND = 255;

export type Xyz = [number, number, number];
export type Px = [number, number];
export type State = 'none' | 'predicted' | 'observed';

/** Why a point is not observed. */
export type Unseen = 'out_of_picture' | 'behind_person' | 'behind_something' | 'no_depth' | 'not_sure';

export interface FoundPoint {
  xyz_m: Xyz | null;
  px: Px | null;
  confidence: number;
  state: State;
  unseen?: Unseen;
  /** Index of the person who hides it, with behind_person. */
  behind?: number;
}

/** How somebody is known who is followed over frames (docs/tracking.md). */
export type TrackState = 'new' | 'tracked' | 'hidden' | 'lost';

export interface FittedBone {
  head_m: Xyz;
  tail_m: Xyz;
  /** Unit quaternion: optical frame from the bone's. */
  global_xyzw: [number, number, number, number];
  confidence: number;
  state: State;
}

/** Those with a `?` are there where people are followed. */
export interface Person {
  id?: number;
  state?: TrackState;
  position_m?: Xyz;
  velocity_m_s?: Xyz;
  stance?: string;
  seen_s?: number;
  body?: { stature_m: number; bones: Record<string, FittedBone> };
  smoothed?: Record<string, Record<string, FoundPoint>>;
  index: number;
  score: number;
  yaw: { degrees: number; confidence: number } | null;
  box_px: [number, number, number, number];
  parts: Record<string, FoundPoint>;
  joints: Record<string, Record<string, FoundPoint>>;
}

export interface CameraFacts {
  width: number;
  height: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
}

export interface StanceEvent {
  id: number;
  time_s: number;
  stance: string;
}

export interface Found {
  frame: string;
  time_s: number | null;
  track_time_s?: number;
  events?: StanceEvent[];
  /** The floor over time; null while none is known. */
  floor?: { up: Xyz; height_m: number } | null;
  camera: CameraFacts;
  people: Person[];
}

export interface RoughSkeleton {
  score: number;
  found: number;
  parts: (Xyz | null)[];
}

export interface Stages {
  proposals: { label: number; xyz_m: Xyz; pixels: number }[];
  rough: RoughSkeleton[];
  candidates: { score: number; accepted: boolean; rough: RoughSkeleton; refined: RoughSkeleton }[];
}

interface PictureEntry {
  name: string;
  codec: 'rvl' | 'jpeg' | 'runs';
  width: number;
  height: number;
  at: number;
  bytes: number;
}

interface FrameHead {
  number: number;
  at_s: number;
  times_ms: Record<string, number>;
  detect_ms: number;
  track_ms: number;
  floor: { normal: Xyz; offset_m: number; lasting: boolean } | null;
  /** Of each person the bones, of each bone three ellipses: centre, and both half axes (x, y, z in m each). */
  flesh?: (number[][][] | null)[];
  stages?: Stages;
  pictures: PictureEntry[];
  found: Found;
}

/** A frame with its pictures unpacked: depth in millimetres, labels a byte a pixel. */
export interface Frame extends Omit<FrameHead, 'pictures'> {
  depth: Uint16Array;
  colour: ImageBitmap | null;
  labels: Record<string, Uint8Array>;
}

export interface BodyPart {
  name: string;
  colour: [number, number, number];
  mirror: number;
}

export interface Body {
  name: string;
  parts: BodyPart[];
  links: [number, number][];
}

export interface BoneFacts {
  name: string;
  parent: number;
}

export interface Hello {
  type: 'hello';
  source: string;
  model: string;
  folder: string;
  track: boolean;
  /** Folder below which other sources may be opened; null where none may. */
  choice: string | null;
  /** Number of the last frame of the source before this one; it may come later than this message. */
  after: number;
  bones: BoneFacts[];
  body: Body;
}

export interface ViewState {
  type: 'state';
  live: boolean;
  playing: boolean;
  at_end: boolean;
  repeat: boolean;
  speed: number;
  at_s: number;
  span_s: [number, number] | null;
  loop_s: [number, number] | null;
  frames_per_s: number;
  frames: number;
  dropped: number;
  result_ms: number | null;
  page_ms: number | null;
  pages: number;
  recording: string;
  recorded: number;
  saved: { path: string; frames: number; bytes: number } | null;
}

/** What happened to somebody: `what` is came, went, or the stance that followed that of `before`. */
export interface Happening {
  at_s: number;
  id: number;
  what: string;
  before: string;
}

/** All that is known so far: also in which stretches somebody is in view, and which were shown. */
export interface Happened {
  type: 'happened';
  events: Happening[];
  seen_s: [number, number][];
  known_s: [number, number][];
}

export interface OptionFacts {
  name: string;
  type: 'number' | 'integer' | 'boolean' | 'text';
  value: number | boolean | string;
  default: number | boolean | string;
  low: number;
  high: number;
  unit: string;
  help: string;
}

export interface SourceEntry {
  name: string;
  folder: boolean;
  opens: boolean;
  bytes?: number;
}

/** What may be opened in a folder, or why that cannot be told. */
export interface SourceList {
  type: 'sources';
  folder: string;
  error?: string;
  entries?: SourceEntry[];
  left_out?: number;
  cameras?: { source: string; name: string }[];
}

export type TextMessage =
  | Hello
  | SourceList
  | ViewState
  | Happened
  | { type: 'options'; options: OptionFacts[] }
  | { type: 'notice'; text: string };

export type Command =
  | { do: 'play' | 'pause' | 'reset' }
  | { do: 'step'; by: number }
  | { do: 'seek'; to_s: number }
  | { do: 'speed'; times: number }
  | { do: 'loop'; between_s: [number, number] | null }
  | { do: 'repeat' | 'stages' | 'record'; on: boolean }
  | { do: 'list'; folder: string }
  | { do: 'open'; source: string }
  | { do: 'set'; option: string; value: number | boolean | string };

/** Unpacks the binary message of a frame. */
export async function unpackFrame(message: ArrayBuffer): Promise<Frame> {
  const headBytes = new DataView(message).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(message, 4, headBytes))) as FrameHead;
  const { pictures, ...rest } = head;
  const frame: Frame = { ...rest, depth: new Uint16Array(), colour: null, labels: {} };
  for (const picture of pictures) {
    const bytes = new Uint8Array(message, 4 + headBytes + picture.at, picture.bytes);
    const pixels = picture.width * picture.height;
    if (picture.codec === 'rvl') {
      frame.depth = unpackRvl(new DataView(message, bytes.byteOffset, bytes.byteLength), pixels);
    } else if (picture.codec === 'runs') {
      frame.labels[picture.name] = unpackRuns(bytes, pixels);
    } else {
      frame.colour = await createImageBitmap(new Blob([bytes], { type: 'image/jpeg' }));
    }
  }
  return frame;
}
