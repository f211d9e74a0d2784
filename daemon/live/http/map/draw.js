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

// Written only when it differs: a screen reader may read rewritten text again.
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export const number = (value, digits = 2) => value.toFixed(digits);
export const clock = (ms) => new Date(ms).toLocaleTimeString([], {hour12: false});
