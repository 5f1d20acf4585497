// Draws surfaces with three.js: one renderer for the large view and for the small multiples.
import {
  AmbientLight, Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Group,
  LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera,
  Raycaster, Scene, SphereGeometry, Vector2, Vector3, WebGLRenderer, WireframeGeometry, type Object3D,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import type {Rgb} from '../colours';
import type {Act} from '../document';
import {units} from '../state';
import {marksOf, type Marks} from './marks';
import {drawOverlay} from './overlay';
import {norms, type Surface} from './surface';

export interface Look {
  /** 0: rest, 1: deformed, more: exaggerated. */
  amount: number;
  colour: (node: number) => Rgb;
  ghost: boolean;
  /** Vectors at the nodes, of which arrows show some; the longest is a fifth of the body's size. */
  arrows?: Float32Array;
  /** Supports and loads to be drawn on it. */
  acts?: Act[];
}

/** Arrows at nodes that lie apart, outside the body: those that point into it end at their node. */
function arrows(body: BufferGeometry, vectors: Float32Array): LineSegments {
  const [at, normal] = [body.getAttribute('position'), body.getAttribute('normal')];
  body.computeBoundingSphere();
  const radius = body.boundingSphere!.radius;
  const most = Math.max(1e-300, ...norms(vectors));
  const [from, along, out, aside, kept] = [new Vector3(), new Vector3(), new Vector3(), new Vector3(), [] as Vector3[]];
  const lines: number[] = [];
  for (let i = 0; i < at.count; ++i) {
    from.fromBufferAttribute(at, i);
    along.fromArray(vectors, 3 * i).multiplyScalar((0.4 * radius) / most);
    if (along.length() < 0.02 * radius || kept.some((other) => other.distanceTo(from) < 0.14 * radius)) continue;
    kept.push(from.clone());
    out.fromBufferAttribute(normal, i);
    from.addScaledVector(out, 0.01 * radius);
    if (along.dot(out) < 0) from.sub(along);
    const tip = from.clone().add(along);
    aside.crossVectors(along, Math.abs(along.z) < 0.9 * along.length() ? new Vector3(0, 0, 1) : new Vector3(1, 0, 0)).setLength(0.12 * along.length());
    lines.push(...from, ...tip);
    for (const side of [1, -1])
      lines.push(...tip, ...tip.clone().addScaledVector(along, -0.3).addScaledVector(aside, side));
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(lines), 3));
  return new LineSegments(geometry, new LineBasicMaterial({color: 0xc2410c}));
}

/** Points of the body and of the boxes of all that is drawn on it. */
function cloudOf(body: BufferGeometry, drawn: Object3D[]): Float32Array {
  const all = [...(body.getAttribute('position').array as Float32Array)];
  for (const one of drawn) {
    const {min, max} = new Box3().setFromObject(one);
    if (min.x > max.x) continue;
    for (const x of [min.x, max.x]) for (const y of [min.y, max.y]) for (const z of [min.z, max.z]) all.push(x, y, z);
  }
  return new Float32Array(all);
}

export class BodyScene {
  readonly camera = new PerspectiveCamera(35, 1, 0.1, 1e5);
  private renderer: WebGLRenderer;
  private scene = new Scene();
  private group = new Group();
  private mesh: Mesh | null = null;
  private marker = new Mesh(new SphereGeometry(1, 16, 12), new MeshBasicMaterial({color: 0xffd400, depthTest: false}));
  private controls: OrbitControls;
  private shown: Surface | null = null;
  private marks: Marks = {group: new Group(), labels: []};
  /** All that is drawn of it: points, three numbers each. */
  private cloud = new Float32Array();
  private middle = new Vector3();
  private radius = 1;
  private waiting = false;
  /** Until somebody moves it the camera sees the whole body, whatever the canvas's size. */
  private fitting = true;
  onMove: () => void = () => undefined;

  /** `overlay`: a canvas above this one, for letters. */
  constructor(readonly canvas: HTMLCanvasElement, private overlay?: HTMLCanvasElement | null) {
    this.renderer = new WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    const sun = new DirectionalLight(0xffffff, 0.3);
    sun.position.set(-1, -2, 3);
    this.camera.add(new DirectionalLight(0xffffff, 0.3));
    // Colours are read off a scale: light may change them by a tenth, enough to see the form by.
    this.scene.add(new AmbientLight(0xffffff, 2.75), sun, this.group, this.camera, this.marker);
    this.marker.visible = false;
    this.marker.renderOrder = 2;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('start', () => (this.fitting = false));
    this.controls.addEventListener('change', () => {
      this.draw();
      this.onMove();
    });
  }

  setBackground(colour: string): void {
    this.scene.background = new Color(colour);
  }

  private positions(surface: Surface, amount: number): Float32Array {
    return surface.rest.map((v, i) => v + amount * surface.displacement[i]);
  }

  private build(surface: Surface, look: Look): Mesh {
    const geometry = new BufferGeometry();
    const nodes = surface.rest.length / 3;
    const colours = new Float32Array(3 * nodes);
    const colour = new Color();
    for (let i = 0; i < nodes; ++i) {
      const [r, g, b] = look.colour(i);
      colour.setRGB(r / 255, g / 255, b / 255, 'srgb');
      colours.set([colour.r, colour.g, colour.b], 3 * i);
    }
    geometry.setAttribute('position', new BufferAttribute(this.positions(surface, look.amount), 3));
    geometry.setAttribute('color', new BufferAttribute(colours, 3));
    geometry.setIndex(new BufferAttribute(surface.triangles, 1));
    geometry.computeVertexNormals();
    return new Mesh(geometry, new MeshLambertMaterial({vertexColors: true, side: DoubleSide}));
  }

  private fill(surface: Surface, look: Look): void {
    this.group.traverse((child) => (child as Mesh).geometry?.dispose());
    this.group.clear();
    this.mesh = this.build(surface, look);
    this.group.add(this.mesh);
    if (!look.ghost) return;
    const rest = new BufferGeometry();
    rest.setAttribute('position', new BufferAttribute(surface.rest, 3));
    rest.setIndex(new BufferAttribute(surface.triangles, 1));
    const lines = new LineSegments(new WireframeGeometry(rest),
      new LineBasicMaterial({color: 0x888888, transparent: true, opacity: 0.16}));
    this.group.add(lines);
    rest.dispose();
  }

  show(surface: Surface, look: Look): void {
    const first = !this.shown;
    this.shown = surface;
    this.fill(surface, look);
    const body = this.mesh!.geometry;
    this.measure(surface, body);
    const drawn: Object3D[] = [];
    if (look.arrows) drawn.push(arrows(body, look.arrows));
    this.marks = marksOf(body, surface.regions, look.acts ?? [], this.radius);
    drawn.push(this.marks.group);
    this.group.add(...drawn);
    this.cloud = cloudOf(body, drawn);
    if (first) this.frame();
    this.draw();
  }

  /** Its middle and half its size, at rest. */
  private measure(surface: Surface, body: BufferGeometry): void {
    const rest = new Box3().setFromArray(surface.rest);
    rest.getCenter(this.middle);
    this.radius = 0.5 * rest.min.distanceTo(rest.max);
    body.computeBoundingBox();
    body.boundingBox!.getCenter(this.middle);
  }

  /** Looks at the whole body, from where it is seen first. */
  frame(): void {
    if (!this.shown) return;
    this.fitting = true;
    this.camera.position.copy(this.middle).add(new Vector3(1.6, -2.6, 1.3).multiplyScalar(this.radius));
    this.draw();
  }

  /** Moves the camera along its line of sight to where all that is drawn fits in, with a margin. */
  private fit(aspect: number): void {
    const inside = 0.86;
    const back = this.camera.position.clone().sub(this.fitting ? this.middle : this.controls.target).normalize();
    const right = new Vector3().crossVectors(this.camera.up, back).normalize();
    const above = new Vector3().crossVectors(back, right);
    const tangent = inside * Math.tan((0.5 * this.camera.fov * Math.PI) / 180);
    const x = new Vector3();
    let distance = 0;
    for (let i = 0; i < this.cloud.length; i += 3) {
      x.fromArray(this.cloud, i).sub(this.middle);
      const across = Math.max(Math.abs(x.dot(right)) / (tangent * aspect), Math.abs(x.dot(above)) / tangent);
      distance = Math.max(distance, x.dot(back) + across);
    }
    this.controls.target.copy(this.middle);
    this.camera.position.copy(this.middle).addScaledVector(back, distance || 4 * this.radius);
    this.camera.near = 0.01 * this.radius;
    this.camera.far = 100 * this.radius;
    this.camera.lookAt(this.middle);
  }

  /** Turns about the body by the keyboard. */
  turn(azimuth: number, polar: number, distance = 1): void {
    this.fitting = false;
    const from = this.camera.position.clone().sub(this.controls.target);
    from.applyAxisAngle(new Vector3(0, 0, 1), azimuth);
    const side = new Vector3().crossVectors(new Vector3(0, 0, 1), from).normalize();
    const tilted = from.clone().applyAxisAngle(side, polar);
    if (Math.hypot(tilted.x, tilted.y) > 0.05 * tilted.length()) from.copy(tilted);
    this.camera.position.copy(this.controls.target).add(from.multiplyScalar(distance));
    this.controls.update();
    this.draw();
    this.onMove();
  }

  /** Turns and zooms by keys; whether the key was one of them. */
  key(event: KeyboardEvent): boolean {
    const turns: Record<string, [number, number, number?]> = {
      ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15],
      '+': [0, 0, 0.85], '-': [0, 0, 1.18],
    };
    const by = turns[event.key];
    if (by) this.turn(...by);
    else if (event.key === '0') this.frame();
    else return false;
    event.preventDefault();
    return true;
  }

  draw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.drawNow();
    });
  }

  private drawNow(): void {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    if (this.fitting) this.fit(this.camera.aspect);
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
    if (!this.overlay || !this.shown) return;
    const away = this.camera.position.distanceTo(this.controls.target);
    drawOverlay(this.overlay, this.camera, height / (2 * away * Math.tan((0.5 * this.camera.fov * Math.PI) / 180)),
      units.value.length, this.marks.labels);
  }

  /** What is seen, with its letters. */
  picture(): HTMLCanvasElement {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [this.canvas.width, this.canvas.height];
    const context = canvas.getContext('2d')!;
    context.drawImage(this.canvas, 0, 0);
    if (this.overlay) context.drawImage(this.overlay, 0, 0, canvas.width, canvas.height);
    return canvas;
  }

  /** The same view of another surface, copied into a small canvas. */
  thumbnail(surface: Surface, look: Look, into: HTMLCanvasElement): void {
    const [kept, keptMarker, keptCloud] = [this.group.children.slice(), this.marker.visible, this.cloud];
    const [place, target, middle] = [this.camera.position.clone(), this.controls.target.clone(), this.middle.clone()];
    this.group.clear();
    this.marker.visible = false;
    const small = this.build(surface, look);
    this.group.add(small);
    this.cloud = cloudOf(small.geometry, []);
    small.geometry.computeBoundingBox();
    small.geometry.boundingBox!.getCenter(this.middle);
    const ratio = this.renderer.getPixelRatio();
    into.width = into.clientWidth * ratio;
    into.height = into.clientHeight * ratio;
    if (into.width && into.height) {
      this.renderer.setSize(into.clientWidth, into.clientHeight, false);
      this.camera.aspect = into.width / into.height;
      this.fit(this.camera.aspect);
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.scene, this.camera);
      into.getContext('2d')!.drawImage(this.canvas, 0, 0, into.width, into.height);
    }
    (this.group.children[0] as Mesh).geometry.dispose();
    this.group.clear();
    this.group.add(...kept);
    [this.marker.visible, this.cloud] = [keptMarker, keptCloud];
    this.camera.position.copy(place);
    this.controls.target.copy(target);
    this.middle.copy(middle);
    this.camera.lookAt(target);
    this.drawNow();
  }

  /** Node under a point of the canvas; -1: none. */
  pick(left: number, top: number): number {
    if (!this.mesh || !this.shown) return -1;
    const ray = new Raycaster();
    ray.setFromCamera(
      new Vector2((2 * left) / this.canvas.clientWidth - 1, 1 - (2 * top) / this.canvas.clientHeight),
      this.camera);
    const hit = ray.intersectObject(this.mesh)[0];
    if (!hit?.face) return -1;
    const position = this.mesh.geometry.getAttribute('position');
    let best = -1, nearest = Infinity;
    for (const node of [hit.face.a, hit.face.b, hit.face.c]) {
      const distance = new Vector3().fromBufferAttribute(position, node).distanceTo(hit.point);
      if (distance < nearest) [best, nearest] = [node, distance];
    }
    return best;
  }

  mark(node: number): void {
    this.marker.visible = node >= 0 && !!this.mesh;
    if (this.marker.visible) {
      const position = this.mesh!.geometry.getAttribute('position');
      this.marker.position.fromBufferAttribute(position, node);
      this.marker.scale.setScalar(0.02 * this.radius);
    }
    this.draw();
  }

  dispose(): void {
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();  // browsers allow few contexts at a time
  }
}
