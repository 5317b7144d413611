// SPDX-License-Identifier: MIT
// Two buttons a joint, which move it by a step. They are marked as disabled only: one that is disabled loses the keyboard's focus at each step.
import { element, fixed, readingWords, tell } from './words.js';

export class Jog {
  // `move(values)`: what a press asks for.
  constructor(section, host, move) {
    this.section = section;
    this.host = host;
    this.move = move;
    this.joints = [];
    this.can = false;
    section.addEventListener('change', () => this.#name());
  }

  setArm(joints) {
    this.joints = joints;
    this.rows = joints.map((joint, i) => {
      const buttons = [-1, 1].map((sign) => {
        const button = element('button', { type: 'button', 'aria-disabled': 'true' }, sign < 0 ? '\u2212' : '+');
        button.addEventListener('click', () => { if (this.can) this.move({ joint: i + 1, [joint.revolute ? 'step_deg' : 'step_mm']: sign * this.#step() }); });
        return { sign, button };
      });
      const words = element('b');
      const row = element('div', { class: 'jog', role: 'group', 'aria-label': `Joint ${i + 1}`, 'data-jog': i + 1 },
        buttons[0].button, element('span', {}, `Joint ${i + 1}`, words), buttons[1].button);
      return { row, buttons, words };
    });
    const units = [...new Set(joints.map((joint) => (joint.revolute ? '\u00b0' : 'mm')))].sort().reverse();
    tell('jog-unit', `Step, ${units.join(' or ')}`);
    this.host.replaceChildren(...this.rows.map(({ row }) => row));
    this.#name();
  }

  // `can`: a press would be taken now.
  show(status, can) {
    this.can = can;
    this.rows?.forEach(({ buttons, words }, i) => {
      words.textContent = readingWords(status, i + 1, this.joints[i].revolute);
      for (const { button } of buttons) button.setAttribute('aria-disabled', String(!can));
    });
  }

  #step() {
    return Number(this.section.querySelector('[name=step]:checked').value);
  }

  #name() {
    this.rows?.forEach(({ buttons }, i) => {
      const unit = this.joints[i].revolute ? ' degrees' : ' mm';
      for (const { sign, button } of buttons) button.setAttribute('aria-label', `Joint ${i + 1} by ${fixed(sign * this.#step(), this.#step() < 1 ? 1 : 0)}${unit}`);
    });
  }
}
