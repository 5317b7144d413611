// SPDX-License-Identifier: MIT
// Free poses in the view of the arm: an arrow each, from where the signature puts the target towards where it was
// measured, magnified.
import {
  BufferGeometry, Color, ConeGeometry, Float32BufferAttribute, Group, InstancedMesh, LineBasicMaterial, LineSegments, Matrix4,
  MeshBasicMaterial, Quaternion, Vector3,
} from 'three';
import { colour } from './text.js';

const kHead = 0.3;          // of an arrow's length
const kShare = 0.05;        // of the arm's size: the arrow of the root mean square, to begin with
const up = new Vector3(0, 1, 0);

export class PoseArrows {
  constructor(poses, size) {
    this.group = new Group();
    this.size = size;
    this.rms_m = poses?.signature.rms_m ?? 0;
    this.arrows = (poses?.poses ?? []).map(({ p, e, outlier }) => {
      const error = new Vector3(...e);
      return { from: new Vector3(...p).sub(error), error, outlier: outlier === 1 };
    });
    // Outliers would be longer than the picture.
    this.longest = 6 * this.rms_m;
  }

  places() {
    return this.arrows.map(({ from }) => from);
  }

  // Magnification at which the arrows are seen, of one or two digits.
  wanted() {
    return this.rms_m > 0 ? Math.max(1, (kShare * this.size) / this.rms_m) : 1;
  }

  draw(magnification) {
    for (const child of this.group.children) child.geometry.dispose();
    this.group.clear();
    for (const outlier of [false, true]) {
      const chosen = this.arrows.filter((arrow) => arrow.outlier === outlier);
      if (chosen.length > 0) this.#drawAll(chosen, magnification, outlier ? 'rejected' : 'normal');
    }
  }

  #drawAll(arrows, magnification, name) {
    const ends = [];
    const heads = new InstancedMesh(new ConeGeometry(1, 1, 6), new MeshBasicMaterial({ color: new Color(colour(name)) }), arrows.length);
    const place = new Matrix4();
    arrows.forEach(({ from, error }, k) => {
      const length = error.length();
      const drawn = magnification * Math.min(length, this.longest);
      const direction = length > 0 ? error.clone().divideScalar(length) : up;
      const tip = from.clone().addScaledVector(direction, drawn);
      ends.push(...from.toArray(), ...tip.toArray());
      const head = Math.min(kHead * drawn, 0.022 * this.size);
      place.compose(tip.clone().addScaledVector(direction, -head / 2), new Quaternion().setFromUnitVectors(up, direction),
        new Vector3(0.28 * head, Math.max(head, 1e-9), 0.28 * head));
      heads.setMatrixAt(k, place);
    });
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new Float32BufferAttribute(ends, 3));
    this.group.add(new LineSegments(geometry, new LineBasicMaterial({ color: new Color(colour(name)), transparent: true, opacity: 0.75 })), heads);
  }
}
