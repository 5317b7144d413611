// SPDX-License-Identifier: MIT
// The arm in three dimensions: drawing and actual, differences magnified, the sweeps on it.
import {
  AmbientLight, BufferGeometry, Color, CylinderGeometry, DirectionalLight, Float32BufferAttribute, GridHelper, Group,
  Line, LineBasicMaterial, LineLoop, Mesh, MeshStandardMaterial, PerspectiveCamera, Points, PointsMaterial, Quaternion, Scene,
  SphereGeometry, Spherical, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { PoseArrows } from './pose_arrows.js';
import { colour } from './text.js';

const up = new Vector3(0, 1, 0);

export function hasWebGl() {
  try {
    return document.createElement('canvas').getContext('webgl2') !== null;
  } catch {
    return false;
  }
}

// A round dot, for points of any size.
export function dotMaterial(colourName, size, hollow = false) {
  const material = new PointsMaterial({ color: new Color(colour(colourName)), size, sizeAttenuation: false, transparent: true });
  material.onBeforeCompile = (shader) => {
    const test = hollow
      ? 'float away = length(gl_PointCoord - 0.5); if (away > 0.5 || away < 0.3) discard;'
      : 'if (length(gl_PointCoord - 0.5) > 0.5) discard;';
    shader.fragmentShader = shader.fragmentShader.replace('void main() {', `void main() { ${test}`);
  };
  material.customProgramCacheKey = () => (hollow ? 'ring' : 'dot');
  return material;
}

export const pointCloud = (places, material) => {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(places.flat(), 3));
  return new Points(geometry, material);
};

// Links and joints along the bent line of arm_drawing.hpp.
class Body {
  constructor(joints, hasTool, size, ghost) {
    this.joints = joints;
    this.hasTool = hasTool;
    this.size = size;
    this.group = new Group();
    this.material = new MeshStandardMaterial({ roughness: 0.55, metalness: 0.05, transparent: ghost, opacity: ghost ? 0.42 : 1, depthWrite: !ghost });
    this.dark = new MeshStandardMaterial({ roughness: 0.5, metalness: 0.1, transparent: ghost, opacity: ghost ? 0.5 : 1, depthWrite: !ghost });
    const tube = new CylinderGeometry(1, 1, 1, 28);
    const ball = new SphereGeometry(1, 24, 16);
    this.tubes = [];
    this.balls = [];
    for (let k = 0; k < 2 * joints + 1; ++k) {
      this.tubes.push(new Mesh(tube, this.material));
      this.balls.push(new Mesh(ball, this.material));
    }
    this.drums = Array.from({ length: joints }, () => new Mesh(tube, this.dark));
    this.group.add(...this.tubes, ...this.balls, ...this.drums);
  }

  paint(name) {
    this.material.color.set(colour(name));
    this.dark.color.set(colour(name)).multiplyScalar(0.62);
  }

  // `line`: base, (joint, along its axis, bend) for each joint, tool.
  place(line) {
    const path = [line[0]];
    for (let i = 0; i < this.joints; ++i) path.push(line[1 + 3 * i], line[3 + 3 * i]);
    if (this.hasTool) path.push(line[line.length - 1]);
    this.tubes.forEach((tube, k) => {
      const thickness = this.size * (0.03 - (0.019 * k) / this.tubes.length);
      const present = k + 1 < path.length && path[k].distanceTo(path[k + 1]) > 1e-4;
      tube.visible = this.balls[k].visible = present;
      if (!present) return;
      span(tube, path[k], path[k + 1], thickness);
      this.balls[k].position.copy(path[k + 1]);
      this.balls[k].scale.setScalar(thickness);
    });
    this.drums.forEach((drum, i) => {
      const centre = line[1 + 3 * i];
      const along = line[2 + 3 * i].clone().sub(centre).setLength(this.size * 0.05);
      span(drum, centre.clone().sub(along), centre.clone().add(along), this.size * (0.042 - (0.022 * i) / this.joints));
    });
  }
}

function span(mesh, from, to, radius) {
  const between = to.clone().sub(from);
  mesh.position.copy(from).addScaledVector(between, 0.5);
  mesh.scale.set(radius, between.length(), radius);
  mesh.quaternion.setFromUnitVectors(up, between.normalize());
}

export class ArmView {
  constructor(canvas, report) {
    this.report = report;
    this.frames = report.arm.frames.map((frame) => ({
      nominal: frame.nominal.map((p) => new Vector3(...p)),
      actual: frame.actual.map((p) => new Vector3(...p)),
    }));
    this.joints = report.parameters.rows.length;
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.scene = new Scene();
    this.world = new Group(); // turned so that the first axis points up
    this.scene.add(this.world);
    const [base, joint, along] = this.frames[0].nominal;
    const axis = along.clone().sub(joint).normalize();
    if (this.#middle().sub(base).dot(axis) < 0) axis.negate();
    this.world.quaternion.copy(new Quaternion().setFromUnitVectors(axis, up));
    this.world.position.copy(base).applyQuaternion(this.world.quaternion).negate();
    this.size = this.#size();
    this.poses = new PoseArrows(report.poses, this.size);
    this.poseMagnification = this.poses.wanted();

    this.nominal = new Body(this.joints, report.arm.has_tool, this.size, true);
    this.actual = new Body(this.joints, report.arm.has_tool, this.size, false);
    this.world.add(this.actual.group, this.nominal.group);
    this.sweeps = new Group();
    this.map = new Group();
    this.map.visible = false;
    this.world.add(this.sweeps, this.map, this.poses.group);
    this.floor = new Group();
    this.scene.add(this.floor, new AmbientLight(0xffffff, 1.5));
    const sun = new DirectionalLight(0xffffff, 2.4);
    sun.position.set(2, 4, 3);
    const fill = new DirectionalLight(0xffffff, 0.7);
    fill.position.set(-3, 1, -2);
    this.scene.add(sun, fill);

    this.camera = new PerspectiveCamera(32, 1, this.size / 100, this.size * 40);
    // A wheel or a finger that passes over the arm scrolls the page: turning is sideways, zooming by pinch, Ctrl or keys.
    canvas.addEventListener('wheel', (event) => { if (!event.ctrlKey && !event.metaKey) event.stopImmediatePropagation(); }, { capture: true, passive: true });
    this.controls = new OrbitControls(this.camera, canvas);
    canvas.style.touchAction = 'pan-y';
    this.controls.enablePan = false;
    this.controls.minDistance = this.size * 0.4;
    this.controls.maxDistance = this.size * 8;
    canvas.addEventListener('keydown', (event) => this.#turnByKey(event));
    this.controls.addEventListener('change', () => this.render());
    const target = this.world.localToWorld(this.#middle());
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(new Vector3(1.5, 0.85, 1.9).setLength(this.size * 3.3));
    this.magnification = 1;
    this.frame = 0;
    this.repaint();
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    this.controls.update();
  }

  #turnByKey(event) {
    const turns = { ArrowLeft: [-0.12, 0, 1], ArrowRight: [0.12, 0, 1], ArrowUp: [0, -0.1, 1], ArrowDown: [0, 0.1, 1], '+': [0, 0, 1 / 1.15], '-': [0, 0, 1.15] };
    if (!(event.key in turns)) return;
    event.preventDefault();
    const [around, down, away] = turns[event.key];
    const { target } = this.controls;
    const from = new Spherical().setFromVector3(this.camera.position.clone().sub(target));
    from.theta += around;
    from.phi = Math.max(0.05, Math.min(Math.PI - 0.05, from.phi + down));
    from.radius = Math.max(this.controls.minDistance, Math.min(this.controls.maxDistance, from.radius * away));
    this.camera.position.copy(target).add(new Vector3().setFromSpherical(from));
    this.controls.update();
    this.render();
  }

  #places() {
    const places = this.frames[0].actual.slice();
    for (const sweep of this.report.sweeps) for (const point of sweep.points) places.push(new Vector3(...point[1]));
    for (const pose of this.report.poses?.poses ?? []) places.push(new Vector3(...pose.p));
    return places;
  }
  // Of the box about them: where most of them are does not matter.
  #middle() {
    const places = this.#places();
    const least = places.reduce((low, p) => low.min(p), places[0].clone());
    return places.reduce((high, p) => high.max(p), places[0].clone()).add(least).divideScalar(2);
  }
  #size() {
    const middle = this.#middle();
    return Math.max(...this.#places().map((p) => p.distanceTo(middle)), 0.05) * 1.25;
  }

  // The largest distance of a point of the actual arm from the drawing's, in any pose.
  largestDifference() {
    let largest = 0;
    for (const { nominal, actual } of this.frames) {
      nominal.forEach((p, k) => { largest = Math.max(largest, p.distanceTo(actual[k])); });
    }
    return largest;
  }

  set(frame, magnification) {
    this.frame = frame;
    this.magnification = magnification;
    const { nominal, actual } = this.frames[frame];
    this.nominal.place(nominal);
    this.actual.place(nominal.map((p, k) => p.clone().lerp(actual[k], magnification)));
    this.#drawSweeps();
    this.render();
  }

  magnifyPoses(magnification) {
    this.poseMagnification = magnification;
    this.poses.draw(magnification);
    this.render();
  }

  #drawSweeps() {
    this.sweeps.clear();
    const line = new LineBasicMaterial({ color: new Color(colour('soft')), transparent: true, opacity: 0.7 });
    const good = [];
    const bad = [];
    for (const sweep of this.report.sweeps) {
      const at = sweepPlaces(sweep);
      const geometry = new BufferGeometry().setFromPoints(at.curve);
      this.sweeps.add(sweep.revolute ? new LineLoop(geometry, line) : new Line(geometry, line));
      for (const point of sweep.points) {
        const place = at.displaced(point, this.magnification);
        (point[5] ? bad : good).push([place.x, place.y, place.z]);
      }
    }
    if (good.length > 0) this.sweeps.add(pointCloud(good, dotMaterial('ink', 5 * devicePixelRatio)));
    if (bad.length > 0) this.sweeps.add(pointCloud(bad, dotMaterial('rejected', 12 * devicePixelRatio, true)));
  }

  // Points with a colour each, as the map has them.
  showMap(places, colours) {
    this.map.clear();
    const material = dotMaterial('ink', 8 * devicePixelRatio);
    material.vertexColors = true;
    material.color.set(0xffffff);
    const cloud = pointCloud(places, material);
    cloud.geometry.setAttribute('color', new Float32BufferAttribute(colours.flatMap((name) => new Color(name).toArray()), 3));
    this.map.add(cloud);
    this.render();
  }

  repaint() {
    this.nominal.paint('nominal');
    this.actual.paint('actual');
    this.floor.clear();
    const grid = new GridHelper(4 * this.size, 20, new Color(colour('floor')), new Color(colour('floor')));
    const lowest = Math.min(...this.#places().map((p) => this.world.localToWorld(p.clone()).y));
    grid.position.y = Math.min(lowest, 0) - 0.05 * this.size;
    this.floor.add(grid);
    this.poses.draw(this.poseMagnification);
    this.set(this.frame, this.magnification);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  render() {
    this.renderer.render(this.scene, this.camera);
  }
}

// Where the curve of a sweep is, and its points with their residuals magnified.
export function sweepPlaces(sweep) {
  const axis = new Vector3(...sweep.axis);
  const centre = new Vector3(...sweep.centre);
  if (!sweep.revolute) {
    const at = (reading) => centre.clone().addScaledVector(axis, reading - sweep.reference);
    return {
      curve: [at(sweep.lowest), at(sweep.highest)],
      displaced: (point, by) => at(point[0]).lerp(new Vector3(...point[1]), by),
    };
  }
  const x = new Vector3(...sweep.radial);
  const y = axis.clone().cross(x);
  const at = (reading) => {
    const angle = reading - sweep.reference;
    return centre.clone().addScaledVector(x, sweep.radius_m * Math.cos(angle)).addScaledVector(y, sweep.radius_m * Math.sin(angle));
  };
  const curve = Array.from({ length: 180 }, (_, k) => at(sweep.reference + (k * Math.PI) / 90));
  return { curve, x, y, centre, at, displaced: (point, by) => at(point[0]).lerp(new Vector3(...point[1]), by) };
}
