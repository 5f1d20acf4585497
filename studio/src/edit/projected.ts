// The body as a camera sees it: where its triangles lie in the photo, and drawn over it.
import {
  BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, OrthographicCamera, Scene,
  WebGLRenderer,
} from 'three';
import {fromBase64} from '../parts';
import {ask} from './capture';
import {plainColour, type Body} from './body';

export interface Sight {
  /** u, v [px] and depth of each corner of each triangle, nine numbers; NaN where it is not seen. */
  corners: Float32Array;
  /** Which triangles turn their outside to the camera. */
  faces: Uint8Array;
  near: number;
  far: number;
}

export async function sightOf(body: Body, camera: string): Promise<Sight> {
  const told = await (await ask('sight?camera=' + encodeURIComponent(camera))).json();
  const seen = new Float32Array(fromBase64(told.seen).buffer as ArrayBuffer);
  const corners = new Float32Array(9 * body.count), faces = new Uint8Array(body.count);
  let near = Infinity, far = -Infinity;
  for (let k = 0; k < 3 * body.count; ++k) {
    const from = 3 * body.triangles[k];
    for (let c = 0; c < 3; ++c) corners[3 * k + c] = seen[from + c];
    if (seen[from + 2] > 0) {
      near = Math.min(near, seen[from + 2]);
      far = Math.max(far, seen[from + 2]);
    }
  }
  // v goes down: what is counter-clockwise from outside is clockwise in the photo.
  for (let t = 0; t < body.count; ++t) faces[t] = twiceArea(corners, 9 * t) < 0 ? 1 : 0;
  return {corners, faces, near, far};
}

const twiceArea = (p: Float32Array, i: number): number =>
  (p[i + 3] - p[i]) * (p[i + 7] - p[i + 1]) - (p[i + 6] - p[i]) * (p[i + 4] - p[i + 1]);

/** All its corners are seen. */
function whole(sight: Sight, t: number): boolean {
  for (let i = 9 * t; i < 9 * t + 9; ++i) if (!Number.isFinite(sight.corners[i])) return false;
  return true;
}

/** The triangle that the camera sees at a pixel; -1: none. */
export function triangleAt(sight: Sight, x: number, y: number): number {
  let best = -1, nearest = Infinity;
  const p = sight.corners;
  for (let t = 0; t < sight.faces.length; ++t) {
    const i = 9 * t, area = twiceArea(p, i);
    const b = ((x - p[i]) * (p[i + 7] - p[i + 1]) - (p[i + 6] - p[i]) * (y - p[i + 1])) / area;
    const c = ((p[i + 3] - p[i]) * (y - p[i + 1]) - (x - p[i]) * (p[i + 4] - p[i + 1])) / area;
    if (!(b >= 0 && c >= 0 && b + c <= 1)) continue;
    const depth = p[i + 2] + b * (p[i + 5] - p[i + 2]) + c * (p[i + 8] - p[i + 2]);
    if (depth >= nearest) continue;
    best = t;
    nearest = depth;
  }
  return best;
}

/** Lines of the photo: ends of edges, three numbers each. */
function edges(body: Body, sight: Sight, wanted: (t: number, other: number) => boolean): Float32Array {
  const out: number[] = [];
  for (let t = 0; t < body.count; ++t)
    for (let k = 0; k < 3; ++k) {
      const other = body.beside[3 * t + k];
      if ((other >= 0 && other < t) || !wanted(t, other) || !whole(sight, t)) continue;
      const next = (k + 1) % 3;
      for (const from of [9 * t + 3 * k, 9 * t + 3 * next])
        out.push(sight.corners[from], sight.corners[from + 1], sight.corners[from + 2]);
    }
  return new Float32Array(out);
}

export const outlineColour = 0xff7f0e, wireColour = 0x1e90ff;

export interface OverlayLook {
  outline: boolean;
  wire: boolean;
  /** All of them; else those alone that have a colour. */
  faces: boolean;
  colours: [number, number, number][];
}

/** Draws a seen body with WebGL into a canvas of its own, transparent where the body is not. */
export class Overlay {
  readonly canvas = document.createElement('canvas');
  private renderer: WebGLRenderer;
  constructor() {
    this.renderer = new WebGLRenderer({canvas: this.canvas, alpha: true, antialias: true, preserveDrawingBuffer: true});
    this.renderer.setClearColor(0, 0);
  }

  private lines(points: Float32Array, colour: number, opacity: number, thick: number): Group {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(points, 3));
    const material = new LineBasicMaterial({color: colour, transparent: opacity < 1, opacity});
    const out = new Group();
    // WebGL's lines are a pixel wide.
    const places = thick > 0 ? [[0, 0], [thick, 0], [-thick, 0], [0, thick], [0, -thick]] : [[0, 0]];
    for (const [dx, dy] of places) {
      const one = new LineSegments(geometry, material);
      one.position.set(dx, dy, 0);
      out.add(one);
    }
    return out;
  }

  /** `drawn`: it is seen; else it hides alone what lies behind it. */
  private surface(body: Body, sight: Sight, look: OverlayLook, drawn: boolean): Mesh {
    const kept: number[] = [];
    for (let t = 0; t < body.count; ++t)
      if (whole(sight, t) && (!drawn || look.faces || look.colours[t] !== plainColour)) kept.push(t);
    const positions = new Float32Array(9 * kept.length), colours = new Float32Array(9 * kept.length);
    kept.forEach((t, i) => {
      for (let k = 0; k < 9; ++k) positions[9 * i + k] = sight.corners[9 * t + k];
      if (!drawn) return;
      // A form is seen by its shade: as if it were lit from the right above.
      const n = body.normals;
      const shade = 0.72 + 0.28 * (0.48 * n[3 * t] - 0.36 * n[3 * t + 1] + 0.8 * n[3 * t + 2]);
      for (let k = 0; k < 9; ++k) colours[9 * i + k] = ((look.colours[t][k % 3] / 255) ** 2.2) * shade;
    });
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setAttribute('color', new BufferAttribute(colours, 3));
    return new Mesh(geometry, new MeshBasicMaterial({vertexColors: true, side: 2, colorWrite: drawn,
      polygonOffset: true, polygonOffsetFactor: drawn ? 1 : 2, polygonOffsetUnits: drawn ? 2 : 4}));
  }

  /** `factor`: pixels of the canvas for one of the photo. */
  draw(body: Body, sight: Sight, look: OverlayLook, size: [number, number], factor: number): HTMLCanvasElement {
    const [width, height] = size;
    this.renderer.setSize(Math.round(width * factor), Math.round(height * factor), false);
    const scene = new Scene(), group = new Group();
    // Depth counts towards us; v counts down, and so does the camera.
    group.scale.z = -1;
    scene.add(group);
    group.add(this.surface(body, sight, look, false), this.surface(body, sight, look, true));
    const wide = 1 / factor;
    if (look.wire)
      group.add(this.lines(edges(body, sight, (t, other) => sight.faces[t] === 1 || (other >= 0 && sight.faces[other] === 1)), wireColour, 0.55, 0));
    if (look.outline) {
      const rim = this.lines(edges(body, sight, (t, other) => other < 0 || sight.faces[t] !== sight.faces[other]), outlineColour, 1, wide);
      rim.position.z = -0.01 * (sight.far - sight.near) || -1e-3 * sight.far;
      group.add(rim);
    }
    const slack = 0.1 * (sight.far - sight.near) || 0.1 * sight.far;
    const camera = new OrthographicCamera(-0.5, width - 0.5, -0.5, height - 0.5, sight.near - 3 * slack, sight.far + 3 * slack);
    this.renderer.render(scene, camera);
    scene.traverse((child) => {
      (child as Mesh).geometry?.dispose();
      ((child as Mesh).material as MeshBasicMaterial | undefined)?.dispose();
    });
    return this.canvas;
  }

  dispose(): void {
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

/** Where a point beside the body's surface is in the photo: straight on from the corners around it. */
export function pixelNear(body: Body, sight: Sight, at: ArrayLike<number>): (x: ArrayLike<number>) => [number, number] {
  // Weighted least squares of (u, v) over (1, x - at).
  const A = Array.from({length: 4}, () => new Float64Array(6));
  const width = 0.3 * body.diagonal;
  const step = Math.max(1, Math.floor(body.count / 4000));
  for (let k = 0; k < 3 * body.count; k += step) {
    const d = [0, 1, 2].map((c) => (body.corners[3 * k + c] - at[c]) / width);
    const [u, v] = [sight.corners[3 * k], sight.corners[3 * k + 1]];
    if (!Number.isFinite(u)) continue;
    const weight = Math.exp(-2 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2])) + 1e-6;
    const row = [1, ...d];
    for (let i = 0; i < 4; ++i) {
      for (let j = 0; j < 4; ++j) A[i][j] += weight * row[i] * row[j];
      A[i][4] += weight * row[i] * u;
      A[i][5] += weight * row[i] * v;
    }
  }
  for (let i = 0; i < 4; ++i) A[i][i] *= 1 + 1e-9;
  for (let i = 0; i < 4; ++i)
    for (let j = 0; j < 4; ++j) {
      if (j === i || !A[i][i]) continue;
      const by = A[j][i] / A[i][i];
      for (let k = i; k < 6; ++k) A[j][k] -= by * A[i][k];
    }
  const solved = [4, 5].map((column) => A.map((row, i) => (row[i] ? row[column] / row[i] : 0)));
  return (x) => {
    const d = [0, 1, 2].map((c) => (x[c] - at[c]) / width);
    const of = (s: number[]): number => s[0] + s[1] * d[0] + s[2] * d[1] + s[3] * d[2];
    return [of(solved[0]), of(solved[1])];
  };
}
