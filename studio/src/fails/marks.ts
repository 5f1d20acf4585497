// What holds the body and what pulls at it, drawn where it does: cones where it stands, arrows where
// it is moved, pulled or pressed.
import {ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion, Vector3, type BufferGeometry} from 'three';
import type {Act} from '../document';

export const supportColour = 0x0f766e;
export const loadColour = 0xc2410c;

export interface Marks {
  group: Group;
  labels: {at: Vector3; text: string; colour: number}[];
}

const up = new Vector3(0, 1, 0);

/** An arrow with a body, so that it is seen beside the surface. */
function arrow(from: Vector3, along: Vector3, colour: number, radius: number): Group {
  const length = along.length();
  const head = Math.min(0.4 * length, 0.12 * radius);
  const material = new MeshBasicMaterial({color: colour});
  const shaft = new Mesh(new CylinderGeometry(0.012 * radius, 0.012 * radius, length - head, 12), material);
  shaft.position.y = 0.5 * (length - head);
  const tip = new Mesh(new ConeGeometry(0.04 * radius, head, 16), material);
  tip.position.y = length - 0.5 * head;
  const group = new Group().add(shaft, tip);
  group.quaternion.copy(new Quaternion().setFromUnitVectors(up, along.clone().normalize()));
  group.position.copy(from);
  return group;
}

/** Nodes of a region that lie apart. */
function apart(body: BufferGeometry, nodes: number[], distance: number): number[] {
  const position = body.getAttribute('position');
  const kept: {node: number; at: Vector3}[] = [];
  for (const node of nodes) {
    const at = new Vector3().fromBufferAttribute(position, node);
    if (kept.every((other) => other.at.distanceTo(at) >= distance)) kept.push({node, at});
  }
  return kept.map((one) => one.node);
}

/** Middle of a region and its mean direction outwards. */
function middle(body: BufferGeometry, nodes: number[]): {at: Vector3; out: Vector3} {
  const [position, normal] = [body.getAttribute('position'), body.getAttribute('normal')];
  const [at, out, one] = [new Vector3(), new Vector3(), new Vector3()];
  for (const node of nodes) {
    at.add(one.fromBufferAttribute(position, node));
    out.add(one.fromBufferAttribute(normal, node));
  }
  return {at: at.divideScalar(nodes.length), out: out.normalize()};
}

/** "base: fixed" of "base: x fixed, y fixed, z fixed"; the region stands beside the mark. */
const short = (act: Act): string => act.text.replace('x fixed, y fixed, z fixed', 'fixed').replace(` on ${act.region}`, '');

export function marksOf(body: BufferGeometry, regions: Record<string, number[]>, acts: Act[], radius: number): Marks {
  const marks: Marks = {group: new Group(), labels: []};
  const [position, normal] = [body.getAttribute('position'), body.getAttribute('normal')];
  const [at, out] = [new Vector3(), new Vector3()];
  for (const act of acts) {
    const nodes = regions[act.region] ?? [];
    if (!nodes.length) continue;
    const load = act.force !== undefined || act.pressure !== undefined;
    const colour = load ? loadColour : supportColour;
    const centre = middle(body, nodes);
    let label = centre.at.clone().addScaledVector(centre.out, 0.1 * radius);
    if (!load)
      for (const node of apart(body, nodes, 0.17 * radius)) {
        at.fromBufferAttribute(position, node);
        out.fromBufferAttribute(normal, node);
        const cone = new Mesh(new ConeGeometry(0.028 * radius, 0.07 * radius, 10), new MeshBasicMaterial({color: colour}));
        cone.quaternion.setFromUnitVectors(up, out.clone().negate());
        cone.position.copy(at).addScaledVector(out, 0.036 * radius);
        marks.group.add(cone);
      }
    const along = act.force ?? act.move;
    if (along && Math.hypot(...along) > 0) {
      const way = new Vector3(...along).setLength(0.45 * radius);
      // Pulled from its surface, or pushed onto it.
      const from = way.dot(centre.out) >= 0 ? centre.at : centre.at.clone().sub(way);
      marks.group.add(arrow(from, way, colour, radius));
      label = way.dot(centre.out) >= 0 ? centre.at.clone().add(way) : from.clone();
    }
    if (act.pressure)
      for (const node of apart(body, nodes, 0.3 * radius)) {
        at.fromBufferAttribute(position, node);
        out.fromBufferAttribute(normal, node).setLength(0.18 * radius);
        marks.group.add(act.pressure > 0 ? arrow(at.clone().add(out), out.clone().negate(), colour, radius)
          : arrow(at.clone(), out.clone(), colour, radius));
      }
    marks.labels.push({at: label, text: short(act), colour});
  }
  return marks;
}
