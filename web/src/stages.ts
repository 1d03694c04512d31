import { Pixels, drawLinks, drawOver } from './flat';
import { Rgb, depthRange, personColour } from './palette';
import { BACKGROUND, Body, Frame, RoughSkeleton, Stages } from './protocol';
import { project } from './skeleton';
import { coloursByIndex, shownPeople } from './track';

interface Stage {
  title: string;
  help: string;
  draw(painter: Painter): void;
}

/** What all pictures of stages are made with. */
class Painter {
  constructor(
    readonly context: CanvasRenderingContext2D,
    readonly frame: Frame,
    readonly stages: Stages,
    readonly body: Body,
    readonly partColours: Rgb[],
    readonly depth: ImageData,
  ) {}

  /** Depth in the background, darker than what is drawn on it. */
  base(): void {
    this.context.putImageData(this.depth, 0, 0);
    this.context.fillStyle = 'rgb(0 0 0 / 0.55)';
    this.context.fillRect(0, 0, this.depth.width, this.depth.height);
  }
  labels(name: string, colours: Rgb[]): void {
    const { width, height } = this.frame.found.camera;
    const labels = this.frame.labels[name];
    if (labels) drawOver(this.context, new Pixels(width, height).labels(labels, colours, 230));
  }
  skeleton(skeleton: RoughSkeleton, colour: Rgb): void {
    const place = (part: number): [number, number] | null => {
      const xyz = skeleton.parts[part];
      return xyz && project(xyz, this.frame.found.camera);
    };
    drawLinks(this.context, this.body.links, place, colour, () => false, 3);
  }
}

const CANDIDATES: Rgb[] = Array.from({ length: 255 }, (_, i) => personColour(i));

const STAGES: Stage[] = [
  {
    title: 'Depth and flat surfaces',
    help: 'What the camera measured; large flat surfaces, which are nobody, in white.',
    draw(p) {
      const { width, height } = p.frame.found.camera;
      p.context.putImageData(p.depth, 0, 0);
      const flat = p.frame.labels.flat?.map((is) => (is ? 0 : BACKGROUND));
      if (flat) drawOver(p.context, new Pixels(width, height).labels(flat, [[255, 255, 255]], 110));
    },
  },
  {
    title: 'Labels of single pixels',
    help: 'The likeliest part of each pixel by the forest, before smoothing.',
    draw(p) {
      p.base();
      p.labels('raw_labels', p.partColours);
    },
  },
  {
    title: 'Smoothed labels',
    help: 'After smoothing, and after asking what is around each pixel.',
    draw(p) {
      p.base();
      p.labels('labels', p.partColours);
    },
  },
  {
    title: 'Proposals',
    help: 'Connected pixels of one label whose size fits the part.',
    draw(p) {
      p.base();
      p.labels('proposals', p.partColours);
    },
  },
  {
    title: 'Rough skeletons',
    help: 'Proposals that the kinematic tree joins to people.',
    draw(p) {
      p.base();
      p.stages.rough.forEach((skeleton, i) => p.skeleton(skeleton, personColour(i)));
    },
  },
  {
    title: 'Grown masks',
    help: 'From each rough skeleton to all pixels of the person, by place and appearance.',
    draw(p) {
      p.base();
      p.labels('grown', CANDIDATES);
    },
  },
  {
    title: 'Second pass',
    help: 'Labels once more, as the mask is known, and the skeleton found in them.',
    draw(p) {
      p.base();
      p.labels('second_pass', p.partColours);
      p.stages.candidates.forEach((candidate, i) => p.skeleton(candidate.refined, personColour(i)));
    },
  },
  {
    title: 'People',
    help: 'Candidates with a sufficient score, in the colours that people have over time.',
    draw(p) {
      const colours = coloursByIndex(p.frame.found);
      p.base();
      p.labels('people', colours);
      for (const person of shownPeople(p.frame.found)) {
        const parts = p.body.parts.map(({ name }) => (person.parts[name].state === 'observed' ? person.parts[name].xyz_m : null));
        p.skeleton({ score: person.score, found: 0, parts }, colours[person.index]);
      }
    },
  },
];

/** The stages of the method, one picture each (the paper's Fig. 2). */
export class StagePictures {
  private readonly canvases: HTMLCanvasElement[] = [];
  private readonly captions: HTMLElement[] = [];

  constructor(panel: HTMLElement) {
    for (const stage of STAGES) {
      const canvas = document.createElement('canvas');
      canvas.setAttribute('role', 'img');
      canvas.setAttribute('aria-label', stage.title);
      const numbers = document.createElement('small');
      const button = document.createElement('button');
      button.title = 'Larger or smaller';
      button.append(canvas);
      const caption = document.createElement('figcaption');
      const title = document.createElement('strong');
      title.textContent = stage.title;
      const help = document.createElement('span');
      help.textContent = ` ${stage.help} `;
      caption.append(title, help, numbers);
      const figure = document.createElement('figure');
      figure.append(button, caption);
      button.addEventListener('click', () => figure.classList.toggle('large'));
      panel.append(figure);
      this.canvases.push(canvas);
      this.captions.push(numbers);
    }
  }

  show(frame: Frame, body: Body, partColours: Rgb[]): void {
    const { stages } = frame;
    if (!stages) return;
    const { width, height } = frame.found.camera;
    const depth = new Pixels(width, height).depth(frame.depth, depthRange(frame.depth)).image;
    STAGES.forEach((stage, i) => {
      const canvas = this.canvases[i];
      if (canvas.width !== width || canvas.height !== height) {
        canvas.width = width;
        canvas.height = height;
      }
      const context = canvas.getContext('2d');
      if (context) stage.draw(new Painter(context, frame, stages, body, partColours, depth));
      this.captions[i].textContent = StagePictures.numbers(stage.title, stages);
    });
  }

  private static numbers(title: string, stages: Stages): string {
    const scores = (accepted: boolean): string =>
      stages.candidates
        .filter((candidate) => candidate.accepted || !accepted)
        .map((candidate) => candidate.score.toFixed(2))
        .join(', ');
    switch (title) {
      case 'Proposals':
        return `${stages.proposals.length} proposals`;
      case 'Rough skeletons':
        return `parts: ${stages.rough.map((skeleton) => skeleton.found).join(', ') || 'none'}`;
      case 'Grown masks':
        return `${stages.candidates.length} candidates`;
      case 'Second pass':
        return `scores: ${scores(false) || 'none'}`;
      case 'People':
        return `scores: ${scores(true) || 'none'}`;
      default:
        return '';
    }
  }
}
