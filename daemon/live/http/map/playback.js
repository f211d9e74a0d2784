// The controls of the recordings that raylocd plays, if it does: they act for all viewers.
import {ask} from './ask.js';
import {byId, html, number, setText} from './draw.js';

const STEP = 5;  // [s], of the arrow keys

export function minutes(time) {
  const tenths = Math.round(10 * time);
  const rest = (tenths % 600) / 10;
  return `${Math.floor(tenths / 600)}:${rest < 10 ? '0' : ''}${number(rest, 1)}`;
}

export class Playback {
  constructor(model) {
    this.model = model;
    this.group = byId('playback');
    this.slider = byId('playback-position');
    this.speed = byId('playback-speed');
    this.dragging = false;
    this.busy = false;
    this.asked = null;  // the next request
    this.shownSpeed = null;
    byId('playback-play').addEventListener('click', () => this.toggle());
    this.speed.addEventListener('change', () => {
      this.shownSpeed = null;  // a chosen value may be refused
      this.ask({speed: this.speed.value});
    });
    this.slider.addEventListener('input', () => { this.dragging = true; });
    // A drag that ends where it began fires no change event; a real change is handled first.
    for (const end of ['pointerup', 'pointercancel', 'blur']) {
      this.slider.addEventListener(end, () => setTimeout(() => { this.dragging = false; }));
    }
    this.slider.addEventListener('change', () => this.seek(Number(this.slider.value)));
    this.slider.addEventListener('keydown', (event) => this.press(event));
  }

  toggle() {
    this.ask({state: this.model.playback.playing ? 'paused' : 'playing'});
  }

  seek(position) {
    this.dragging = false;
    this.ask({position: this.model.recorded(Math.min(this.model.playback.length, Math.max(0, position)))});
  }

  press(event) {
    const {length} = this.model.playback;
    const from = this.position();
    const to = {
      ArrowLeft: from - STEP,
      ArrowDown: from - STEP,
      ArrowRight: from + STEP,
      ArrowUp: from + STEP,
      PageDown: from - length / 10,
      PageUp: from + length / 10,
      Home: 0,
      End: length,
    }[event.key];
    if (to === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    this.seek(to);
    event.preventDefault();
  }

  // One request at a time; of the changes made meanwhile the last is sent.
  async ask(change) {
    this.asked = {...this.asked, ...change};
    if (this.busy) return;
    this.busy = true;
    while (this.asked) {
      const question = new URLSearchParams(this.asked);
      this.sent = this.asked;
      this.asked = null;
      try {
        const state = await ask(`api/v1/playback?${question}`, {method: 'POST', headers: {'X-RayLoc-Control': '1'}});
        this.model.play(state, this.model.now());
        setText(byId('playback-error'), '');
      } catch (error) {
        setText(byId('playback-error'), `The recording was not controlled: ${error.message}.`);
      }
    }
    this.sent = null;
    this.busy = false;
  }

  // [s] of played time: the current position, or that after the pending request.
  position() {
    const wanted = this.asked?.position ?? this.sent?.position;
    if (wanted !== undefined) return this.model.played(wanted);
    const {playing, position, speed, at, length} = this.model.playback;
    // It may have been paused since the last message.
    const until = this.model.now() - (this.model.quiet ? this.model.silence : 0);
    const since = playing && speed ? (speed * (until - at)) / 1000 : 0;
    return Math.min(length, Math.max(0, position + since));
  }

  show() {
    const {playback} = this.model;
    this.group.hidden = !playback;
    byId('playback-keys').hidden = !playback;
    byId('review').hidden = Boolean(playback);  // with a recording, the past is reached by seeking
    if (!playback) return;
    this.slider.max = playback.length;
    const position = this.dragging ? Number(this.slider.value) : this.position();
    if (!this.dragging) this.slider.value = position;
    const state = playback.ended ? ', at the end' : playback.playing ? '' : ', paused';
    const known = this.model.quiet ? ', last known' : '';
    const text = `${minutes(position)} of ${minutes(playback.length)}${state}${known}`;
    setText(byId('playback-text'), text);
    this.slider.setAttribute('aria-valuetext', text);
    setText(byId('playback-play'), playback.playing ? 'Pause' : 'Play');
    this.showSpeed(playback.speed === undefined ? 'max' : String(playback.speed));
  }

  // Only when it has changed: a person may be about to choose another one.
  showSpeed(value) {
    if (this.busy || value === this.shownSpeed) return;
    this.shownSpeed = value;
    if (![...this.speed.options].some((one) => one.value === value)) {
      this.speed.append(html('option', {value}, [`${value}×`]));
    }
    this.speed.value = value;
  }
}
