// The calibration of the current survey: a button, its progress, and its result.
import {ask} from './ask.js';
import {byId, setText} from './draw.js';

const AGAIN_MS = 1000;

// `told`: the answer of api/v1/calibrate.
export function calibrationText(told) {
  if (!told.running) return told.verdict ?? 'After the last point of the survey: from it chains, antennas and walls are found.';
  const share = told.share > 0 ? `${Math.round(100 * told.share)} %, ` : '';
  return `Calibrating for ${Math.round(told.seconds)} s: ${share}${told.text}`;
}

export class Calibration {
  // isChanged(): returns true if the drawing has unsaved changes.
  constructor(say, isChanged) {
    this.say = say;
    this.running = false;
    byId('calibrate-start').addEventListener('click', () => {
      if (isChanged()) say('Save first: the calibration reads the files of the site', 'bad');
      else this.control(new URLSearchParams({do: 'start', what: byId('calibrate-what').value}));
    });
    byId('calibrate-stop').addEventListener('click', () => this.control('do=stop'));
  }

  async look() {
    try {
      this.show(await ask('api/v1/calibrate'));
    } catch (error) {
      this.say(`The calibration cannot be read: ${error.message}`, 'bad');
      if (this.running) this.wait();
    }
  }

  async control(what) {
    try {
      this.show(await ask(`api/v1/calibrate?${what}`, {method: 'POST', headers: {'X-RayLoc-Control': '1'}}));
    } catch (error) {
      this.say(`Not calibrated: ${error.message}`, 'bad');
    }
  }

  show(told) {
    byId('calibrate').hidden = !told.offered;
    if (!told.offered) return;
    if (this.running && !told.running) this.say(told.verdict ?? 'The calibration was ended.', told.success ? 'good' : 'bad');
    this.running = told.running;
    setText(byId('calibrate-text'), calibrationText(told));
    setText(byId('calibrate-next'), told.success
      ? `It is in ${told.folder}. Write that as the directory of the site in raylocd.toml, and reload raylocd.` : '');
    byId('calibrate-share').hidden = !told.running;
    byId('calibrate-share').value = told.share ?? 0;
    byId('calibrate-start').disabled = told.running;
    byId('calibrate-stop').disabled = !told.running;
    byId('calibrate-report').hidden = !told.report;
    if (told.running) this.wait();
  }

  wait() {
    clearTimeout(this.again);
    this.again = setTimeout(() => this.look(), AGAIN_MS);
  }
}
