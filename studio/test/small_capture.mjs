// A small capture whose photos hide gravity: rendered with it by the program itself, noise added
// here, and handed over without it.
import {execFileSync} from 'node:child_process';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {decode, encode} from 'fast-png';

/** Repeatable uniform numbers in [0, 1): mulberry32. */
function generator(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}
const random = generator(7);
const normal = () => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());

function speckle(file, size) {
  const data = new Uint8Array(size * size).fill(200);
  for (let k = 0; k < 900; ++k) {
    const [cx, cy, r] = [random() * size, random() * size, (0.008 + 0.012 * random()) * size];
    const grey = random() < 0.5 ? 50 : 120;
    for (let y = Math.max(0, Math.floor(cy - r)); y < Math.min(size, cy + r); ++y)
      for (let x = Math.max(0, Math.floor(cx - r)); x < Math.min(size, cx + r); ++x)
        if ((x - cx) ** 2 + (y - cy) ** 2 < r * r) data[y * size + x] = grey;
  }
  writeFileSync(file, encode({width: size, height: size, data, channels: 1, depth: 8}));
}

/** A block of 20 x 20 x 40 mm; each face has its own part of the texture. */
function block(file) {
  const corners = [[-10, -10, 0], [10, -10, 0], [10, 10, 0], [-10, 10, 0],
    [-10, -10, 40], [10, -10, 40], [10, 10, 40], [-10, 10, 40]];
  const faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
  const lines = corners.map((c) => 'v ' + c.join(' '));
  faces.forEach((_, f) => {
    const [u, v] = [(f % 3) / 3, f < 3 ? 0 : 0.5];
    lines.push(`vt ${u} ${v}`, `vt ${u + 0.3} ${v}`, `vt ${u + 0.3} ${v + 0.48}`, `vt ${u} ${v + 0.48}`);
  });
  faces.forEach((face, f) => {
    const c = (k) => `${face[k] + 1}/${4 * f + k + 1}`;
    lines.push(`f ${c(0)} ${c(1)} ${c(2)}`, `f ${c(0)} ${c(2)} ${c(3)}`);
  });
  writeFileSync(file, lines.join('\n') + '\n');
}

/** Rows of the rotation of a camera at `from` that looks at (0, 0, 20) with z up. */
function camera(name, from) {
  const unit = (v) => v.map((c) => c / Math.hypot(...v));
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const forward = unit([-from[0], -from[1], 20 - from[2]]);
  const right = unit(cross(forward, [0, 0, 1]));
  const down = cross(forward, right);
  const R = [right, down, forward];
  const t = R.map((row) => -(row[0] * from[0] + row[1] * from[1] + row[2] * from[2]));
  return `  ${name}:
    size: [200, 200]
    intrinsics: {fx: 480, fy: 480, cx: 99.5, cy: 99.5}
    pose: {rotation: ${JSON.stringify(R)}, translation: ${JSON.stringify(t)}}
`;
}

function yaml(gravity, photos) {
  const shots = (example) => photos
    ? `    photos: {front: photos/${example}_front.png, left: photos/${example}_left.png}\n` : '';
  const example = (name, use, force) => `  ${name}:
${use}    supports: [{region: base, fix: [x, y, z]}]
${force ? `    loads: [{region: top, force: ${force}}]\n` : ''}${shots(name)}`;
  return `hookeye: 1
title: small block
units: {length: mm, force: N}
body:
  surface: block.obj
  mesh: {edge: 8, order: 1}
  density: 1.0e-9
  texture: {image: speckle.png, encoding: linear}
model:
  material: {law: neo-hookean, mu: 0.02, kappa: 0.2}
  fit: [mu]
${gravity ? '  gravity: [6500, 0, -7300]\n' : ''}cameras:
${camera('front', [20, -150, 50])}${camera('left', [-140, -60, 60])}light: {ambient: 0.5, sun: {toward: [-0.4, -0.6, 0.7], strength: 0.5}}
photos: {encoding: linear, background: black, noise: 0.008}
regions:
  base: {box: [[-11, -11, -0.1], [11, 11, 0.1]]}
  top: {box: [[-11, -11, 39.9], [11, 11, 40.1]]}
examples:
${example('rest', '', '')}${example('push', '', '[1.0, 0.3, 0]')}${example('pull', '    use: validate\n', '[0, 0.5, 2.5]')}`;
}

/** Writes FOLDER/capture; returns its path. */
export function smallCapture(hookeye, folder) {
  const capture = join(folder, 'capture');
  const truth = join(folder, 'truth');
  for (const where of [truth, join(capture, 'photos')]) mkdirSync(where, {recursive: true});
  for (const where of [truth, capture]) {
    block(join(where, 'block.obj'));
    if (where === truth) speckle(join(where, 'speckle.png'), 512);
  }
  writeFileSync(join(capture, 'speckle.png'), readFileSync(join(truth, 'speckle.png')));
  writeFileSync(join(truth, 'capture.yaml'), yaml(true, false));
  writeFileSync(join(capture, 'capture.yaml'), yaml(false, true));
  execFileSync(hookeye, ['render', truth, '-o', join(folder, 'rendered'), '--format', 'png', '--json']);
  for (const example of ['rest', 'push', 'pull'])
    for (const view of ['front', 'left']) {
      const file = `${example}_${view}.png`;
      const png = decode(readFileSync(join(folder, 'rendered', 'photos', file)));
      const data = new Uint8Array(png.width * png.height);
      for (let i = 0; i < data.length; ++i) {
        const stored = png.data[i * png.channels] / 255;  // sRGB
        const linear = stored <= 0.04045 ? stored / 12.92 : ((stored + 0.055) / 1.055) ** 2.4;
        data[i] = Math.max(0, Math.min(254, Math.round(255 * (linear + 0.008 * normal()))));
      }
      writeFileSync(join(capture, 'photos', file), encode({width: png.width, height: png.height, data, channels: 1, depth: 8}));
    }
  return capture;
}

// By hand: node small_capture.mjs HOOKEYE FOLDER
if (process.argv[1]?.endsWith('small_capture.mjs')) smallCapture(process.argv[2], process.argv[3]);
