// What is drawn over the picture besides people's skeletons.
import { AXIS_COLOURS, Mark, Marks } from './marks';
import { Rgb, css } from './palette';
import { CameraFacts, Person, Px, Xyz } from './protocol';
import { project } from './skeleton';

/** Draws with a dark rim, so that it shows on every ground. `scale`: pixels of the picture to one of the screen. */
export class Over {
  constructor(
    private readonly context: CanvasRenderingContext2D,
    private readonly camera: CameraFacts,
    private readonly scale: number,
  ) {}

  private line(from: Px, to: Px, colour: string, width: number): void {
    const { context } = this;
    for (const [stroke, extra] of [['rgb(0 0 0 / 0.7)', 2], [colour, 0]] as const) {
      context.strokeStyle = stroke;
      context.lineWidth = (width + extra) * this.scale;
      context.beginPath();
      context.moveTo(...from);
      context.lineTo(...to);
      context.stroke();
    }
  }

  private between(from: Xyz, to: Xyz, colour: Rgb, width: number): void {
    const [a, b] = [project(from, this.camera), project(to, this.camera)];
    if (a && b) this.line(a, b, css(colour), width);
  }

  private text({ text, isLeft }: Mark, [u, v]: Px): void {
    const { context, scale } = this;
    const size = 11 * scale;
    context.font = `${size}px system-ui, sans-serif`;
    context.lineWidth = 3 * scale;
    context.lineJoin = 'round';
    context.strokeStyle = 'rgb(0 0 0 / 0.8)';
    context.textAlign = isLeft ? 'right' : 'left';
    const from = u + (isLeft ? -5 : 5) * scale;
    context.strokeText(text, from, v + 0.35 * size);
    context.fillStyle = '#fff';
    context.fillText(text, from, v + 0.35 * size);
    context.textAlign = 'left';
  }

  marks(person: Person, marks: Marks): void {
    for (const { at, ends } of marks.axesOf(person)) ends.forEach((end, i) => this.between(at, end, AXIS_COLOURS[i], 1.4));
    for (const mark of marks.textsOf(person)) {
      const at = project(mark.xyz, this.camera);
      if (at) this.text(mark, at);
    }
  }

  measured(points: Xyz[]): void {
    if (points.length === 2) this.between(points[0], points[1], [255, 255, 255], 1.6);
    for (const point of points) {
      const at = project(point, this.camera);
      if (at) this.cross(at);
    }
  }

  cross([u, v]: Px): void {
    const reach = 7 * this.scale;
    this.line([u - reach, v], [u + reach, v], '#fff', 1.2);
    this.line([u, v - reach], [u, v + reach], '#fff', 1.2);
  }
}
