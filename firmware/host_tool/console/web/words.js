// SPDX-License-Identifier: MIT
// Numbers in words, and elements.

export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

export function shape(tag, attributes = {}, text = '') {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
}

export const degrees = (radians) => (radians * 180) / Math.PI;
export const radians = (degrees) => (degrees * Math.PI) / 180;
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// A minus sign as long as a plus.
export const fixed = (value, decimals) => {
  const text = Number(value).toFixed(decimals);
  return (/^-0\.?0*$/.test(text) ? text.slice(1) : text).replace('-', '\u2212');
};

// Two digits that count, in as many decimals as that takes.
export const rough = (value) => fixed(value, value > 0 ? Math.min(5, Math.max(0, 1 - Math.floor(Math.log10(value)))) : 0);

// Of a factor no more than two digits count.
export const twoDigits = (value) => String(Number(value.toPrecision(2)));

export function duration(seconds) {
  if (!(seconds >= 0)) return '';
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${fixed(seconds / 3600, 1)} h`;
}

// Sets text only where it differs, so that a screen reader hears news alone.
export function tell(id, text) {
  const place = document.getElementById(id);
  if (place.textContent !== text) place.textContent = text;
  return place;
}

// The joint's reading in a row or a status, radians or metres; NaN where it is not told.
export const reading = (values, joint, revolute) =>
  revolute ? radians(parseFloat(values[`q${joint}_deg`])) : parseFloat(values[`q${joint}_mm`]) / 1e3;

export function readingWords(values, joint, revolute) {
  const q = reading(values, joint, revolute);
  if (!Number.isFinite(q)) return 'not known';
  return revolute ? `${fixed(degrees(q), 2)}\u00b0` : `${fixed(1e3 * q, 2)} mm`;
}
