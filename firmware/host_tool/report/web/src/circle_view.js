// SPDX-License-Identifier: MIT
// Small pictures of the circles seen along their axes, residuals magnified.
import { BufferGeometry, Color, LineBasicMaterial, LineLoop, OrthographicCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { dotMaterial, pointCloud, sweepPlaces } from './arm_view.js';
import { colour } from './text.js';

const kSide = 360;

let renderer;

// Residuals are magnified so that the largest accepted one takes this share of the radius.
const kShare = 0.25;

export function circleMagnification(sweep) {
  let largest = 0;
  for (const point of sweep.points) if (!point[5]) largest = Math.max(largest, Math.hypot(point[2], point[4]));
  const wanted = largest > 0 ? (kShare * sweep.radius_m) / largest : 1;
  const digit = 10 ** Math.floor(Math.log10(wanted));
  return Math.max(1, Math.floor(wanted / digit) * digit);
}

export function drawCircle(canvas, sweep) {
  renderer ??= new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(kSide, kSide, false);
  const { x, y, centre, at } = sweepPlaces(sweep);
  const flat = (p) => {
    const from = p.clone().sub(centre);
    return new Vector3(from.dot(x), from.dot(y), 0).divideScalar(sweep.radius_m);
  };
  const scene = new Scene();
  const circle = Array.from({ length: 180 }, (_, k) => flat(at(sweep.reference + (k * Math.PI) / 90)));
  scene.add(new LineLoop(new BufferGeometry().setFromPoints(circle), new LineBasicMaterial({ color: new Color(colour('floor')) })));
  const by = circleMagnification(sweep);
  const good = [];
  const bad = [];
  for (const point of sweep.points) {
    const on = flat(at(point[0]));
    const around = new Vector3(-on.y, on.x, 0);
    const off = (metres) => Math.max(-0.34, Math.min(0.34, (by * metres) / sweep.radius_m));
    const place = on.clone().addScaledVector(on, off(point[2])).addScaledVector(around, off(point[4]));
    (point[5] ? bad : good).push(place.toArray());
  }
  if (good.length > 0) scene.add(pointCloud(good, dotMaterial('actual', 7)));
  if (bad.length > 0) scene.add(pointCloud(bad, dotMaterial('rejected', 20, true)));
  const camera = new OrthographicCamera(-1.42, 1.42, 1.42, -1.42, -1, 1);
  renderer.render(scene, camera);
  canvas.width = canvas.height = kSide;
  canvas.getContext('2d').drawImage(renderer.domElement, 0, 0);
}
