// SPDX-License-Identifier: MIT
// Numbers in words, and elements.

export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === 'style') made.style.cssText = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

// A text in which no line ends between a number and its unit, and what is to be typed looks like it.
export function phrase(text) {
  const parts = text.split(/(\d[\d.]* (?:mm|µm|m|%)(?!\w)|\barmsig [a-z]+ --[a-z -]+|\barmsig (?:check|suggest)|--[a-z]+ refined)/);
  return parts.map((part, k) => (k % 2 === 0 ? part : element(/^\d/.test(part) ? 'span' : 'code', /^\d/.test(part) ? { class: 'whole' } : {}, part)));
}

export const degrees = (radians) => (radians * 180) / Math.PI;

// A minus sign as long as a plus.
export const signed = (text) => String(text).replace('-', '\u2212');
export const fixed = (value, decimals) => {
  const text = value.toFixed(decimals);
  return signed(/^-0\.?0*$/.test(text) ? text.slice(1) : text);
};

// A value that these decimals would show as nothing is told by what it is below.
export const bounded = (value, decimals) =>
  value !== 0 && Number(value.toFixed(decimals)) === 0 ? `< ${(0.5 * 10 ** -decimals).toFixed(decimals + 1)}` : fixed(value, decimals);

// A length in millimetres, a tiny one in micrometres.
export function length(metres) {
  const size = Math.abs(metres);
  if (size < 1e-5 && size > 0) return `${fixed(1e6 * metres, 1)} \u00b5m`;
  return `${fixed(1e3 * metres, size < 1e-3 ? 3 : 2)} mm`;
}

// Decimals that show two digits of a standard deviation, at least `least` and at most `most`.
export function decimalsFor(sigma, least, most) {
  if (!(sigma > 0)) return most;
  return Math.min(most, Math.max(least, 1 - Math.floor(Math.log10(sigma))));
}

export const colour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// The measurements that a signature was found from, as it says itself.
export const foundFrom = (origin) => (origin === null ? 'the signature does not say which measurements'
  : `${origin.measurements.split('/').at(-1)}: ${origin.rows} rows, CRC-32 of the rows ${origin.rows_crc32}`);
