// Elements of the page.
const SVG = 'http://www.w3.org/2000/svg';

export function svg(name, attributes = {}, children = []) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

export function html(name, attributes = {}, children = []) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

export const byId = (id) => document.getElementById(id);

// Only when it differs: a screen reader may read what is written again.
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// The half axes [m] and the direction [rad] of the ellipse in which a normal distribution with that
// covariance (row-major, 3 x 3) lies with that probability.
export function ellipse(covariance, probability) {
  const [a, b, , , d] = covariance;
  const mean = (a + d) / 2;
  const apart = Math.hypot((a - d) / 2, b);
  const factor = Math.sqrt(-2 * Math.log(1 - probability));
  return {
    major: factor * Math.sqrt(Math.max(0, mean + apart)),
    minor: factor * Math.sqrt(Math.max(0, mean - apart)),
    angle: Math.atan2(2 * b, a - d) / 2,
  };
}

export const number = (value, digits = 2) => value.toFixed(digits);
export const clock = (ms) => new Date(ms).toLocaleTimeString([], {hour12: false});
