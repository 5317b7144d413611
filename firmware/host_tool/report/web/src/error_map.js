// SPDX-License-Identifier: MIT
// The tool error over the work volume: classes of size, places relative to the first axis.
import { mapChart } from './charts.js';
import { element, fixed, length, phrase } from './text.js';
import { valueTable } from './values.js';

// From small to large; each is seen on a light and on a dark ground.
const kColours = ['#5a6fe0', '#4a9bd8', '#4fb3a0', '#e0a93f', '#d9553f'];

function classesOf(values) {
  const sorted = values.slice().sort((a, b) => a - b);
  const share = (part) => sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))];
  const bounds = kColours.map((_, k) => share((k + 1) / kColours.length));
  return kColours.map((colour, k) => ({ colour, from: k === 0 ? sorted[0] : bounds[k - 1], to: k + 1 === kColours.length ? sorted.at(-1) : bounds[k] }));
}

// Cylindrical coordinates about the first axis.
function placesAboutAxis(report) {
  const [base, joint, along] = report.arm.frames[0].nominal;
  const axis = along.map((value, k) => value - joint[k]);
  const norm = Math.hypot(...axis);
  return report.map.points.map((point) => {
    const from = [0, 1, 2].map((k) => point[k] - base[k]);
    const z = from.reduce((sum, value, k) => sum + (value * axis[k]) / norm, 0);
    return { place: point.slice(0, 3), measured: point[5] === 1, z, r: Math.sqrt(Math.max(0, from.reduce((sum, value) => sum + value * value, 0) - z * z)) };
  });
}

export function showErrorMap(report, view) {
  const section = document.getElementById('map-section');
  const { map } = report;
  if (map === null) {
    section.remove();
    document.getElementById('map-toggle').remove();
    return () => {};
  }
  const host = document.getElementById('map');
  const places = placesAboutAxis(report);
  const predicted = map.predicted_rms_m !== null;
  const choices = [
    ...(predicted ? [{ name: 'with the signature', index: 4, words: `Predicted 1σ of the tool’s position, at ${map.points.length} configurations spread over ${map.over}: ${length(map.predicted_rms_m)} root mean square. Each dot is where the tool is then.` }] : []),
    { name: 'with the nominal model', index: 3, words: `Distance of the nominal model’s tool from the signature’s, its base and tool fitted: ${length(map.nominal_rms_m)} root mean square over ${map.over}.` },
  ];
  let redraw = () => {};
  const choose = (choice) => {
    const values = map.points.map((point) => point[choice.index]);
    const classes = classesOf(values);
    const classed = places.map((place, k) => {
      const found = classes.findIndex(({ to }) => values[k] <= to);
      return { ...place, error_m: values[k], class: found < 0 ? classes.length - 1 : found };
    });
    host.replaceChildren();
    host.parentNode.querySelector('#map + .under-pointer')?.remove();
    host.setAttribute('aria-label', `${choice.words} From ${length(Math.min(...values))} to ${length(Math.max(...values))}.`);
    redraw = mapChart(host, classed, classes);
    section.querySelector('.values')?.remove();
    valueTable(section, `Values of the map, ${choice.name}`, ['from the first axis, m', 'along it, m', 'error, mm', 'readings'],
      () => classed.map(({ r, z, error_m: error, measured }) => [fixed(r, 3), fixed(z, 3), fixed(1e3 * error, 3), measured ? 'measured' : 'beyond']));
    document.getElementById('map-lead').replaceChildren(...phrase(choice.words));
    document.getElementById('map-classes').replaceChildren(...classes.map(({ colour, from, to }) =>
      element('span', {}, element('i', { style: `background:${colour}` }), `${length(from)} to ${length(to)}`)));
    if (classed.some(({ measured }) => !measured)) {
      document.getElementById('map-classes').append(element('span', { class: 'beyond' }, element('i', {}), 'ring: a reading beyond those measured'));
    }
    view?.showMap(classed.map(({ place }) => place), classed.map((at) => classes[at.class].colour));
    for (const button of document.querySelectorAll('#map-choice button')) {
      button.setAttribute('aria-pressed', String(button.textContent === choice.name));
    }
  };
  for (const choice of choices) {
    const button = element('button', { type: 'button' }, choice.name);
    button.addEventListener('click', () => choose(choice));
    document.getElementById('map-choice').append(button);
  }
  choose(choices[0]);
  if (map.joint_share.length > 0) {
    document.getElementById('shares').append(
      element('p', { class: 'notes' }, 'Where the remaining uncertainty comes from: the share of each joint’s axis.'),
      element('div', { class: 'shares' }, ...map.joint_share.map((share, i) => element('div', {},
        `joint ${i + 1}: ${Math.round(100 * share)} %`, element('div', { class: 'fill', style: `width:${100 * share}%` })))));
  }
  return () => redraw();
}
