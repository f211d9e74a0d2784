// Light or dark, by the system's setting or by the person's choice.
import {byId, setText} from './draw.js';

const THEMES = {auto: 'as the system', light: 'light', dark: 'dark'};
const systemDark = matchMedia('(prefers-color-scheme: dark)');
let theme = remembered('theme') || 'auto';

// A browser that stores no data of a site throws here.
function remembered(name) {
  try {
    return localStorage.getItem(`rayloc-${name}`);
  } catch {
    return null;
  }
}

function remember(name, value) {
  try {
    localStorage.setItem(`rayloc-${name}`, value);
  } catch {
    // The choice is then valid while the page is open.
  }
}

function showTheme() {
  const dark = theme === 'dark' || (theme === 'auto' && systemDark.matches);
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  setText(byId('theme'), `Theme: ${THEMES[theme]}`);
}

export function offerThemes() {
  byId('theme').addEventListener('click', () => {
    const names = Object.keys(THEMES);
    theme = names[(names.indexOf(theme) + 1) % names.length];
    remember('theme', theme);
    showTheme();
  });
  systemDark.addEventListener('change', showTheme);
  showTheme();
}
