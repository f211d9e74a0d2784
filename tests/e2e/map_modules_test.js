// The modules of the map, each by itself, in a page of a raylocd that publishes nothing (map_test.py).
// Evaluates to the names of the checks; the first that fails is thrown.
(async () => {
  const {Model} = await import('/map/model.js');

  const {Targets} = await import('/map/targets.js');
  const {showCalibration, showChannel} = await import('/map/panels.js');
  const {dotOf, pointsOf} = await import('/map/fits.js');
  const {Plan, furnitureOf} = await import('/map/plan.js');
  const {showSources} = await import('/map/sources.js');
  const {View} = await import('/map/view.js');
  const {wholeNames} = await import('/map/solid.js');
  const {shadeOf} = await import('/map/heat.js');
  const {Labels} = await import('/map/labels.js');
  const {drawnOpening} = await import('/map/openings.js');
  const {colouredZones} = await import('/map/zones.js');
  const {stayText, trackText, zoneText} = await import('/map/words.js');
  const {Draft, freeName} = await import('/map/draft.js');
  const {carried, fitted, resized, scaled} = await import('/map/underlay.js');
  const {calibrationText} = await import('/map/calibrate.js');

  const same = (found, wanted, what) => {
    if (JSON.stringify(found) !== JSON.stringify(wanted)) {
      throw new Error(`${what}: ${JSON.stringify(found)}, not ${JSON.stringify(wanted)}`);
    }
  };
  const NOW = Date.parse('2030-01-01T12:00:00Z');
  const HOUR = 3_600_000;

  // As raylocd writes them.
  const location = (sent, change = {}) => ({sent: new Date(sent).toISOString(), location: {
    event_id: `${sent}`, kind: 'LOCATION_KIND_FILTERED', track_state: 'TRACK_STATE_CONFIRMED',
    target: {mac: '02:00:00:00:00:01', track: '1'}, valid_for: '0.450s', quality: {},
    position: {x: 1, y: 2, z: 1}, position_covariance: [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0], ...change}});
  const person = (track, change = {}) => ({target: {track}, event_id: `p${track}`, ...change});
  const playing = (sent, speed) => ({sent: new Date(sent).toISOString(), heartbeat: {playback: {
    state: 'PLAYBACK_STATE_PLAYING', begin: '2020-01-01T00:00:00Z', end: '2020-01-01T00:01:00Z',
    position: '2020-01-01T00:00:10Z', speed}}});

  // A metre is a hundred pixels.
  const VIEW = {scale: 100, unit: 1, toPixel: (x, y) => [100 * x, 100 * y]};
  VIEW.mark = VIEW.flat = (x, y) => `translate(${100 * x} ${100 * y})`;

  const begin = (messages) => {
    const said = [];
    const model = new Model((text) => said.push(text), () => {});
    const tell = (now, list) => model.update({now: new Date(now).toISOString(), messages: list});
    model.snapshot({now: new Date(NOW).toISOString(), epoch: '1', messages});
    return {model, said, tell};
  };

  const checks = {
    'a picture begins within the room, and is scaled about the first of two places'() {
      const place = fitted([800, 300], {min: [1, 2, 0], max: [5, 5, 3]});
      same(place, {pixel: 0.005, corner: [1, 2.75]}, 'fitted');
      const now = scaled(place, [[2, 3.75], [2, 2.75]], 2);
      same(now, {pixel: 0.01, corner: [0, 1.75]}, 'scaled');
      // The place in the picture that the first is of stays there.
      const pixelOf = ({corner, pixel}, at) => at.map((one, i) => (one - corner[i]) / pixel);
      same(pixelOf(now, [2, 3.75]), pixelOf(place, [2, 3.75]), 'the first place');
      same(resized(place, [800, 300], 0.01), {pixel: 0.01, corner: [-1, 2]}, 'resized about its middle');
      same(carried(now, [[1, 1], [1.5, 0]]), {pixel: 0.01, corner: [0.5, 0.75]}, 'moved');
    },

    'a calibration says how far it is, or what came of it'() {
      same(calibrationText({running: true, seconds: 12.4, share: 0.42, text: 'joint: fit'}), 'Calibrating for 12 s: 42 %, joint: fit', 'running');
      same(calibrationText({running: true, seconds: 0.2, share: 0, text: 'reading'}), 'Calibrating for 0 s: reading', 'begun');
      same(calibrationText({running: false, verdict: 'Good: expect 4 cm.'}), 'Good: expect 4 cm.', 'ended');
    },

    'a device that was lost long ago is no news'() {
      const {model, said} = begin([location(NOW - 5 * HOUR), location(NOW - 1000, person('7'))]);
      same(said, ['person 7 appeared'], 'announced');
      same(model.at(NOW).map(({target}) => target.name), ['person 7'], 'shown');
      same(model.first, NOW - 1000, 'what can be reviewed begins');
    },

    'a reload that prepares the site anew is another start'() {
      const beat = (sent, started) => ({sent: new Date(sent).toISOString(), heartbeat: {started}});
      const {model, tell} = begin([beat(NOW, 'yesterday')]);
      const first = model.start;
      tell(NOW + 1000, [beat(NOW + 1000, 'yesterday')]);
      same(model.start, first, 'the start');
      same(model.events.length, 0, 'events');
      tell(NOW + 2000, [beat(NOW + 2000, 'today')]);
      same(model.start === first, false, 'it is the same');
      same(model.events.map(({text}) => text), ['the site was prepared anew'], 'events');
    },

    'what can be reviewed moves on'() {
      const {model, tell} = begin([location(NOW)]);
      for (let at = NOW + 60_000; at <= NOW + 2 * HOUR; at += 60_000) tell(at, [location(at)]);
      const [{past}] = model.targets.values();
      // And where it was at that time: one before.
      same(past.length <= 12, true, `${past.length} estimates in ten minutes of one a minute`);
      same(Math.round((NOW + 2 * HOUR - model.first) / 60_000), 10, 'minutes that can be reviewed');
      same(model.at(model.first).length, 1, 'targets at its beginning');
    },

    'what many targets did takes bounded memory'() {
      const {model, tell} = begin([]);
      for (let step = 0; step < 200; ++step) {
        const at = NOW + 100 * step;
        tell(at, Array.from({length: 300}, (_, i) => location(at, {
          target: {mac: `m${i}`}, hypotheses: Array.from({length: 40}, () => ({weight: 0.025}))})));
      }
      const kept = [...model.targets.values()].map(({past}) => past);
      same(kept.length, 300, 'targets');
      same(kept.reduce((sum, past) => sum + past.length, 0) <= 30_000, true, 'estimates are bounded');
      same(kept.every((past) => past.at(-1).sent === NOW + 19_900), true, 'the newest are kept');
      same(kept[0].at(-1).location.hypotheses.length, 8, 'hypotheses');
    },

    'a snapshot between two estimates of a track does not end its trail'() {
      const snapshot = {kind: 'LOCATION_KIND_SNAPSHOT', target: {mac: '02:00:00:00:00:01'}};
      const another = {target: {mac: '02:00:00:00:00:01', track: '2'}};
      // The tracker is late: a snapshot counts only from one second on.
      const {model, tell} = begin([location(NOW), location(NOW + 500, snapshot), location(NOW + 1200, snapshot),
        location(NOW + 1300)]);
      same(model.at(NOW + 1300).map(({trail}) => trail.length), [3], 'of the same track');
      tell(NOW + 1400, [location(NOW + 1400, another)]);
      same(model.at(NOW + 1400).map(({trail}) => trail.length), [1], 'of another one');
    },

    'where a recording is played slowly snapshots wait longer for the tracker'() {
      const snapshot = {kind: 'LOCATION_KIND_SNAPSHOT', target: {mac: '02:00:00:00:00:01'}};
      const {model} = begin([playing(NOW, 0.5), location(NOW), location(NOW + 1500, snapshot)]);
      same(model.at(NOW + 1500).map(({trail}) => trail.length), [1], 'at half the pace');
      const {model: usual} = begin([playing(NOW, 1), location(NOW), location(NOW + 1500, snapshot)]);
      same(usual.at(NOW + 1500).map(({trail}) => trail.length), [2], 'at its pace');
    },

    'a person whose track was lost goes before a device'() {
      const lost = {track_state: 'TRACK_STATE_LOST'};
      const {model, tell} = begin([location(NOW, lost), location(NOW, person('7', lost))]);
      tell(NOW + 59_000, []);
      same(model.at(NOW + 59_000).length, 2, 'targets before a minute');
      tell(NOW + 61_000, []);
      same(model.at(NOW + 61_000).map(({target}) => target.key), ['02:00:00:00:00:01'], 'targets after it');
    },

    'nobody in the room is nobody on the map'() {
      const empty = {kind: 'LOCATION_KIND_SNAPSHOT', track_state: undefined, position: undefined,
        quality: {no_fix_reason: 'no person detected'}};
      const {model, said, tell} = begin([location(NOW, person('7', empty))]);
      same([model.at(NOW).length, said], [0, []], 'shown and announced');
      same(model.absence(), 'No person is located: no person detected.', 'said');
      tell(NOW + 6000, []);
      same(model.absence(), 'No target has been located yet.', 'said when that is old');
    },

    'a recording played slowly does not make its devices stale'() {
      const stale = (speed) => {
        const {model} = begin([playing(NOW - 2000, speed), location(NOW - 1200)]);
        return model.at(NOW)[0].stale;
      };
      same(stale(0.25), null, 'at a quarter of the pace');
      same(stale(1), NOW - 1200 + 450, 'at its pace');
      same(stale(undefined), NOW - 1200 + 450, 'as fast as it goes');
    },

    'what is to be doubted is said in the list and at the mark'() {
      const key = '02:00:00:00:00:01';
      const targets = new Targets();
      const text = (selector) => document.querySelector(`${selector}[data-target="${key}"]`).textContent;
      const show = (change) => {
        const {model} = begin([location(NOW, change)]);
        targets.show(model.at(NOW), VIEW);
        return [text('.target'), text('tr').replace('located1.00, 2.00', '')];
      };
      const at = (x) => ({position: {x, y: 2}, weight: 0.5, position_covariance: [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0]});
      same(show({}), [key, key], 'of one that is sure');
      same(show({quality: {ambiguous: true}, hypotheses: [at(1), at(1.2)]}), [key, key], 'of one place in two pieces');
      same(show({quality: {warnings: ['beside the transmitter'], ambiguous: true}, hypotheses: [at(1), at(5)]}),
        [`beside the transmitter; another place is nearly as likely${key}, doubtful`,
          `${key}beside the transmitter; another place is nearly as likelyor 5.00, 2.00 (50 %)`], 'of one that is not');
      same(show({position: undefined, quality: {warnings: ['beside the transmitter'], no_fix_reason: 'moved'}}),
        [`${key}: no fix`, `${key}no fixmoved`], 'of one without a place');
      targets.show([], null);
    },

    'regions are of the place of the mark, and ghosts are places apart'() {
      const targets = new Targets();
      const middle = (text) => text.match(/-?[\d.]+/g).slice(0, 2).map((v) => Math.round(v));
      const size = (one) => ['rx', 'ry'].map((name) => Math.round(one.getAttribute(name)));
      const drawn = (hypotheses, change = {}) => {
        const {model} = begin([location(NOW, {accuracy_m: 1.5, accuracy_confidence: 0.9, hypotheses, ...change})]);
        targets.show(model.at(NOW), VIEW);
        const [outer] = document.querySelectorAll('#regions circle');
        const [inner] = document.querySelectorAll('#regions ellipse');
        return {
          outer: [...middle(outer.getAttribute('transform')), Number(outer.getAttribute('r')), outer.textContent],
          inner: [...middle(inner.getAttribute('transform')), ...size(inner), inner.textContent],
          ghosts: [...document.querySelectorAll('#ghosts title')].map((one) => one.textContent),
          listed: document.querySelector('tr[data-target] td p').textContent,
        };
      };
      const place = (x, weight, sigma, y = 2) => ({position: {x, y, z: 1}, weight,
        position_covariance: [sigma * sigma, 0, 0, 0, sigma * sigma, 0, 0, 0, 0.0025]});
      const piece = (x, y, weight, xx, yy) => ({...place(x, weight, 1, y), position_covariance: [xx, 0, 0, 0, yy, 0, 0, 0, 0.0025]});
      const outer = [100, 200, 150, 'within 1.50 m with 90 %'];
      const near = (found, wanted) => found.slice(0, 4).every((v, i) => Math.abs(v - wanted[i]) <= 2);

      // Half of a normal distribution lies within 1.18 sigma.
      for (const one of [[place(1, 1, 0.1)], undefined]) {
        const found = drawn(one);
        same([found.outer, found.ghosts, found.listed], [outer, [], ''], 'one place');
        same(near(found.inner, [100, 200, 12, 12]) && found.inner[4], 'region of 50 %', `one place: ${found.inner}`);
      }

      // The places that engine/posterior/posterior.cpp makes of one hill of 0.4 m about 1, 2 (a third is left over).
      const hill = [piece(1, 2, 0.249, 0.0223, 0.0223), piece(0.58, 2, 0.114, 0.0135, 0.0265), piece(1.01, 1.57, 0.106, 0.0251, 0.0125),
        piece(1.01, 2.43, 0.1, 0.0251, 0.0125), piece(1.44, 2, 0.094, 0.0113, 0.0237)];
      let found = drawn(hill);
      same([found.outer, found.ghosts, found.listed], [outer, [], ''], 'one hill in pieces');
      same(near(found.inner, [100, 200, 47, 47]) && found.inner[4], 'region of 50 %', `a hill of 0.4 m: ${found.inner}`);

      // A ridge of 0.8 x 0.06 m: pieces in a row.
      found = drawn([[1, 0.274], [1.51, 0.199], [0.5, 0.186], [1.97, 0.118], [0.03, 0.104]].map(([x, weight]) =>
        piece(x, 2, weight, 0.02, 0.0042)));
      same([found.ghosts, found.inner[2] > 5 * found.inner[3]], [[], true], `a ridge in pieces: ${found.inner}`);

      // The highest peak, at the mark, is not the heaviest place.
      found = drawn([place(3, 0.6, 0.25), place(1, 0.35, 0.06)]);
      same(near(found.inner, [100, 200, 7, 7]) && found.inner[4], 'region of 18 %, half of the 35 % of this place', `the mark's: ${found.inner}`);
      same([found.outer, found.ghosts, found.listed], [outer, ['60 % at 3.00, 2.00'], 'or 3.00, 2.00 (60 %)'], 'the heaviest');
      same(document.querySelectorAll('#ghosts .likely circle').length, 1, 'its ring');
      same(document.querySelector('#ghosts text').textContent, '60 %', 'its name');

      // A narrow core on its broad foot is one place, whichever is heavier; and one apart is a ghost of both.
      for (const core of [0.3, 0.6]) {
        found = drawn([place(1, core, 0.02), place(1.1, 0.9 - core, 0.3), place(2.2, 0.08, 0.1)]);
        same([found.ghosts, found.inner[4]], [['8 % at 2.20, 2.00'], 'region of 50 %'], `core of ${core}`);
        same(core > 0.5 ? found.inner[2] < 12 : found.inner[2] > 12, true, `core of ${core}: ${found.inner}`);
      }

      // Two narrow ones 0.45 m apart are two.
      same(drawn([place(1, 0.5, 0.05), place(1.45, 0.5, 0.05)]).ghosts, ['50 % at 1.45, 2.00'], 'two close places');
      targets.show([], null);
    },

    'why a source failed and what it lost is said'() {
      const source = (change, counters) => ({sent: new Date(NOW).toISOString(), source: {
        access_point: 'ap9', status: 'SOURCE_STATUS_RECEIVING', ...change, counters: {
          frames_complete: '0', frames_partial: '0', kernel_drops: '0', ring_dropped: '0', late: '0', frames_dropped: '0', ...counters}}});
      // The page itself removes the row again: it has no such source.
      const cells = (...of) => {
        showSources(begin([source(...of)]).model);
        return [...document.querySelectorAll('tr[data-source=ap9] td')].map((one) => one.textContent);
      };
      same(cells({status: 'SOURCE_STATUS_FAILED', detail: 'torn file'}), ['failed: torn file', '', '0', '0', '0'], 'of one that failed');
      same(cells({}, {frames_partial: '7', late: '2', kernel_drops: '3', ring_dropped: '4', frames_dropped: '1',
        rejected: {too_short: '5', unknown_format: '6'}}), ['receiving', '', '7', '11 (too short 5, unknown format 6)',
        '10 (dropped by the kernel 3, dropped here 4, late 2, frames dropped 1)'], 'of one that lost much');
    },

    'what the calibration moved and how it fits is all told'() {
      const moved = Array.from({length: 15}, (_, i) => ({name: `wall ${i}`, by: 0.01, unit: 'm', prior_sigmas: null}));
      const fit = (x, after) => ({position: [x, 1, 1.2], after});
      showCalibration({available: true, method: 'all', points: 2, heldout: {}, moved, fits: [fit(1, 0.9), fit(2, 0.3), fit(2, 0.1)]});
      const text = (selector) => [...document.querySelectorAll(selector)].map((one) => one.textContent);
      same([text('#moved-rows tr').length, text('#moved-more')], [12, ['And 3 more in report.html of the calibration.']], 'moved');
      same(text('#fit-rows tr'), ['2.00, 1.00, 1.2020 %', '1.00, 1.00, 1.2090 %'], 'points, the worst first');
      const dots = pointsOf([fit(1, 1), fit(2, 0), fit(3, 0.5)]).map(dotOf);
      same(dots.map((dot) => [dot.getAttribute('class'), dot.getAttribute('r')]),
        [['residual fit-0', '9'], ['residual fit-2', '7'], ['residual fit-4', '5']], 'dots');
      showCalibration({available: true, method: 'unsurveyed', expectation: 'Plan only.'});
      same(text('#calibration-text'), ['Plan only.'], 'without a survey');
      showCalibration({available: false, reason: 'none'});
      same([text('#fit-rows tr').length, text('#moved-more'), document.querySelector('#fits').hidden], [0, [''], true], 'of none');
    },

    'who is in a zone is what its last event said, at each time'() {
      const device = {mac: '02:00:00:00:00:01', track: '1'};
      const zone = (sent, kind, change) => ({sent: new Date(sent).toISOString(),
        zone: {event_id: `${kind}${sent}`, kind: `ZONE_EVENT_KIND_${kind}`, zone: 'desk', target: device, ...change}});
      const {model, tell} = begin([
        // Improbable, but no event of departure yet.
        location(NOW - 5000, {zones: [{zone: 'desk', probability: 0.4}]}),
        zone(NOW - 4000, 'ENTERED', {inside: [device, {track: '7'}]}),
        zone(NOW - 1000, 'DWELLED', {dwell: '3s', inside: [device]})]);
      same(model.at(NOW)[0].zones, ['desk'], 'inside');
      same(model.inside(NOW - 2000).get('desk').size, 2, 'inside, then');
      const left = zone(NOW + 100, 'LEFT', {dwell: '4.100s', reason: 'its probability was at most 0.3 for 1 s'});
      tell(NOW + 200, [left, location(NOW + 150, {zones: [{zone: 'desk', probability: 0.6}]}), left]);
      same(model.at(NOW + 200)[0].zones, [], 'inside, after it left');
      same(model.at(NOW)[0].zones, ['desk'], 'inside, in review');
      const name = device.mac;
      same(model.events.map(({text}) => text), [`${name} left desk after 4 s`, `${name} has been in desk for 3 s`,
        `${name} entered desk`], 'events');
    },

    'events are told in plain words'() {
      const phone = {mac: '02:00:00:00:00:01', name: 'phone'};
      const track = (state, target = phone) => trackText({state: `TRACK_STATE_${state}`, target, reason: 'not received for too long'});
      same(['TENTATIVE', 'CONFIRMED', 'COASTING', 'LOST'].map((state) => track(state)), ['phone is detected for the first time',
        'phone is located', 'phone is not detected at the moment', 'phone is gone: not received for too long'], 'a device');
      same(track('COASTING', {track: '3'}), 'person 3 is not detected at the moment', 'a person');
      const left = (dwell, reason) => zoneText({target: phone, zone: 'desk2', kind: 'ZONE_EVENT_KIND_LEFT', dwell, reason});
      same(left('4.1s'), 'phone left desk2 after 4 s', 'a zone');
      same(left('0.2s', 'its track was lost'), 'phone left desk2 after 0.2 s: its track was lost', 'with an unusual reason');
      same([0, 59, 100, 5340, 7500].map(stayText), ['0.1 s', '59 s', '2 min', '89 min', '2 h 5 min'], 'stays');
      const source = (sent, status, detail) => ({sent: new Date(sent).toISOString(), source: {access_point: 'ap9', detail,
        status: `SOURCE_STATUS_${status}`, counters: {}}});
      const {model} = begin([source(NOW - 40, 'WAITING'), source(NOW - 30, 'RECEIVING'), source(NOW - 20, 'STALLED'),
        source(NOW - 10, 'RECEIVING'), source(NOW, 'FAILED', 'torn file')]);
      same(model.events.map(({text}) => text), ['ap9 failed: torn file', 'ap9 sends again', 'ap9 has fallen silent',
        'ap9 sends'], 'an access point');
    },

    'a channel is shown with its age, its place and its name'() {
      const channel = (time, name = 'phone') => ({target: '02:00:00:00:00:01', name, time: new Date(time).toISOString(),
        position: [1, -0.5, 1.2], tones: [-1, 1], access_points: [
          {id: 'ap1', correlation: 0.8, antennas: [{measured: [1, 1], simulated: [1, 0.9]}]}]});
      const said = () => document.querySelector('#csi-text').textContent.split(':')[0];
      const laptop = {mac: '02:00:00:00:00:02', name: 'laptop', track: '2'};
      const {model} = begin([location(NOW, {target: laptop})]);
      showChannel([channel(NOW - 7000)], null, model);
      same(said(), 'phone at 1.00, -0.50, received 7 s ago', 'live');
      showChannel([channel(NOW - 7000, '')], '02:00:00:00:00:01', model, false);
      same(said(), 'Not of the moment that the map shows. 02', 'in review, of one without a name');
      showChannel([channel(NOW - HOUR)], laptop.mac, model);
      same(said(), 'laptop has no channel yet. phone at 1.00, -0.50, received 3600 s ago', 'when another one is selected');
      showChannel([channel(Date.parse('2020-01-01T00:01:07Z'))], null, begin([playing(NOW, 1)]).model);
      same(document.querySelector('#csi-text').textContent.startsWith('phone at 1.00, -0.50, 1:07.0 into the recording: '), true,
        'of a recording');
      same(document.querySelector('#csi-text').textContent.endsWith('Power explained: ap1 80 %.'), true, 'the power');
      same(document.querySelectorAll('#csi-charts svg').length, 1, 'charts');
      showChannel([], null, model);
      same(document.querySelectorAll('#csi-charts svg').length, 0, 'charts of nothing');
    },

    'what is said of the present is not mixed with a moment under review'() {
      const source = {sent: new Date(NOW).toISOString(), source: {access_point: 'ap9', status: 'SOURCE_STATUS_STALLED', counters: {}}};
      const lost = (sent) => ({sent: new Date(sent).toISOString(), track: {target: {mac: 'm'}, state: 'TRACK_STATE_LOST'}});
      const {model} = begin([source, lost(NOW - 9000), lost(NOW - 1000)]);
      same(model.events.length, 2, 'events by now');
      same(model.eventsAt(NOW - 5000).map(({sent}) => sent), [NOW - 9000], 'events by then');
      same(model.absence(false), 'No target had been located by then.', 'said then');
      const heading = () => document.querySelector('#sources').textContent;
      showSources(model, false);
      same(heading(), 'Access points, now', 'in review');
      showSources(model);
      same(heading(), 'Access points', 'live');
      const plan = new Plan({plan: [], zones: [], fixed_transmitters: [], access_points: [{id: 'ap9', facing: [1, 0], position: [0, 0]}]});
      const drawn = () => [...document.querySelectorAll('#ap-ap9')].map((one) => [one.getAttribute('class'), one.textContent,
        one.querySelector('.cross').getAttribute('visibility')])[0];
      plan.showSources(model);
      same(drawn(), ['access-point bad', 'ap9: stalled', 'visible'], 'on the map');
      plan.showSources(model, false);
      same(drawn(), ['access-point', 'ap9', 'hidden'], 'on the map of another moment');
      document.querySelector('#fixed').replaceChildren();
    },

    'a gap that is not waited for takes no place on the slider'() {
      const {model} = begin([{sent: new Date(NOW).toISOString(), heartbeat: {playback: {
        state: 'PLAYBACK_STATE_PLAYING', speed: 1, begin: '2020-01-01T00:00:00Z', end: '2020-01-02T00:00:04Z',
        position: '2020-01-02T00:00:01Z', skipped: [{begin: '2020-01-01T00:00:14Z', end: '2020-01-02T00:00:00Z'}]}}}]);
      same([model.playback.position, model.playback.length], [15, 18], 'played');
      same([0, 13, 14, 16].map((time) => model.recorded(time)), [0, 13, 86_400, 86_402], 'recorded');
      same([5, 14, 50_000, 86_401].map((time) => model.played(time)), [5, 14, 14, 15], 'and back');
    },

    'a view has places before its observer has told its size'() {
      const view = new View(document.querySelector('#map'), () => {});
      same(view.toPixel(1, 2).every(Number.isFinite), true, 'pixels');
      same(view.mark(1, 2).includes('NaN'), false, 'the place of a mark');
    },

    'a trail fades'() {
      const {model} = begin(Array.from({length: 20}, (_, i) => location(NOW - 1000 * (19 - i), {position: {x: i, y: 0}})));
      const targets = new Targets();
      targets.show(model.at(NOW), VIEW);
      const lines = [...document.querySelectorAll('#trails polyline')];
      same(lines.map((line) => line.getAttribute('class')), ['old-4', 'old-3', 'old-2', 'old-1', 'old-0'], 'the oldest below');
      const ends = lines.map((line) => line.getAttribute('points').split(' ').map((point) => Number(point.split(',')[0]) / 100));
      same([ends[4][0], ends[4].at(-1), ends[3][0], ends[3].at(-1)], [19, 16, 16, 12], 'each from where the one before ends');
      targets.show([], null);
    },

    'methods that are compared are drawn beside the target, of the moment shown'() {
      const compared = (sent, x, change = {}) => ({sent: new Date(sent).toISOString(), compared:
        {...location(sent).location, event_id: `${sent}-spotfi`, kind: 'LOCATION_KIND_SNAPSHOT', track_state: '',
          position: {x, y: 2, z: 1}, accuracy_m: 0.5, quality: {method: 'spotfi'}, ...change}});
      const {model, tell} = begin([location(NOW - 3000), compared(NOW - 3000, 2), location(NOW)]);
      tell(NOW, [compared(NOW, 3), compared(NOW, 9, {target: {mac: '02:00:00:00:00:09'}})]);
      same(model.at(NOW).map(({target}) => target.key), ['02:00:00:00:00:01'], 'of targets that the site\'s method knows');
      const targets = new Targets();
      const drawn = (time) => {
        targets.show(model.at(time), VIEW);
        return [...document.querySelectorAll('#compared > g > g')].map((one) => [one.getAttribute('class'),
          one.querySelector('g').getAttribute('transform'), one.querySelector('text').textContent]);
      };
      same(drawn(NOW), [], 'before the methods are named');
      targets.methods.show(['rayloc', 'spotfi']);
      const legend = document.querySelector('#methods');
      same([legend.hidden, [...legend.children].map((one) => one.textContent.trim().split(',')[0])], [false, ['rayloc', 'spotfi']], 'the legend');
      same(drawn(NOW), [['compared m0', 'translate(300 200)', 'spotfi']], 'now');
      same(drawn(NOW - 2900), [['compared m0', 'translate(200 200)', 'spotfi']], 'under review');
      same(drawn(NOW + 5000)[0][0], 'compared m0 stale', 'later');
      same(document.querySelector('tr[data-target]').textContent.includes('spotfi: 3.00, 2.00 (2.00 m away)'), true, 'in the list');
      tell(NOW + 100, [compared(NOW + 100, 3, {position: undefined})]);
      same(drawn(NOW + 100), [], 'without a place');
      targets.methods.show(['rayloc']);
      same([legend.hidden, legend.children.length], [true, 0], 'of one method');
      targets.show([], null);
    },

    'names do not cover one another'() {
      const text = (content) => {
        const made = document.createElementNS('http://www.w3.org/2000/svg', 'text');
        made.textContent = content;
        document.querySelector('#names').append(made);
        return made;
      };
      const labels = new Labels({unit: 1, width: 400, height: 400});
      const [a, b, c] = ['first', 'second', 'third'].map(text);
      same(labels.place(a, [[100, 100]]), [100, 100], 'the first');
      same(labels.place(b, [[105, 105], [100, 300]]), [100, 300], 'the next free one');
      same(labels.place(c, [[100, 105]], false), null, 'none is free');
      same(labels.place(c, [[399, 50], [200, 200]]), [200, 200], 'not over the edge');
      for (const one of [a, b, c]) one.remove();
    },

    'zones that are near to one another are told apart'() {
      const zone = (x) => ({polygon: [[x, 0], [x + 1, 0], [x + 1, 1]]});
      same(colouredZones([zone(0), zone(1.5), zone(3), zone(1)]).map(({kind}) => kind), ['z0', 'z1', 'z0', 'z2'], 'kinds');
    },

    'furniture is named as a whole'() {
      const area = (x) => [[x, 0], [x + 1, 0], [x + 1, 1], [x, 1]];
      const piece = (name, x, kind = 'furniture') => ({kind, name, area: area(x)});
      same(furnitureOf([piece('chair0_seat', 0), piece('chair0_back', 1), piece('side_table', 5), piece('side_lamp', 9),
        piece('wall', 0, 'cut'), piece('cabinet', 12, 'cut furniture')]).map(({name, low, high}) => [name, low[0], high[0]]),
        [['chair0', 0, 2], ['side table', 5, 6], ['side lamp', 9, 10], ['cabinet', 12, 13]], 'the largest first');
      same(wholeNames([{name: 'chair0_seat', at: [0, 0, 0.4]}, {name: 'chair0_back', at: [0.2, 0, 0.9]}, {name: 'desk_lamp', at: [9, 0, 1]}]),
        [{name: 'chair0', at: [0.2, 0, 0.9]}, {name: 'desk lamp', at: [9, 0, 1]}], 'in three dimensions');
    },

    'who sits outweighs who passes, and both are seen'() {
      same([1, 4, 60, 3600].map((stay) => shadeOf(stay, 3600)), [0, 0, 2, 4], 'shades');
      same([0, 0.5].map((longest) => shadeOf(longest, longest)), [4, 4], 'of hardly anything');
    },

    'doors swing into the room'() {
      const [, swing, leaf] = drawnOpening({kind: 'door', area: [[0, 0], [0.9, 0], [0.9, 0.2], [0, 0.2]]});
      same(leaf.getAttribute('d'), 'M0 0 L0 -0.9', 'the leaf');
      same(swing.getAttribute('d'), 'M0 -0.9 A0.9 0.9 0 0 1 0.9 0', 'the way that it swings');
      same(drawnOpening({kind: 'window', area: [[0, 0], [1, 0], [1, 0.2], [0, 0.2]]}).at(-1).getAttribute('d'), 'M0 0.1 L1 0.1', 'a pane');
    },

    'the solid view stands on the floor of the plan'() {
      const view = new View(document.querySelector('#map'), () => {});
      view.turn('solid');
      const box = view.element.getBoundingClientRect();
      const [x, y] = view.toPixel(1.5, -2);
      same(view.toWorld(box.left + x, box.top + y).map((v) => Math.round(1000 * v) / 1000), [1.5, -2], 'and back');
      const [east, north, up] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((one) => view.toPixel(...one).map((v, i) => Math.sign(Math.round(v - view.toPixel(0, 0)[i]))));
      same([east, north, up], [[1, -1], [-1, -1], [0, -1]], 'to the right, to the left, up');
      view.element.style.removeProperty('--tall');
    },

    'a pixel is where its place of the world is drawn'() {
      const view = new View(document.querySelector('#map'), () => {});
      const box = view.element.getBoundingClientRect();
      const [x, y] = view.toPixel(1.5, -2);
      same(view.toWorld(box.left + x, box.top + y).map((v) => Math.round(1000 * v) / 1000), [1.5, -2], 'the place');
    },

    'what is undone comes back, until something else is drawn'() {
      let changes = 0;
      const draft = new Draft({zones: []}, () => { changes += 1; });
      const add = (name) => draft.change(({zones}) => zones.push(name));
      add('a');
      draft.change(() => {});  // of nothing: no step
      add('b');
      draft.undo();
      same([draft.content.zones, draft.isChanged], [['a'], true], 'undone');
      draft.redo();
      same(draft.content.zones, ['a', 'b'], 'done again');
      draft.undo();
      add('c');
      draft.redo();
      same(draft.content.zones, ['a', 'c'], 'there is nothing to be done again');
      for (let i = 0; i < 5; i += 1) draft.undo();
      same([draft.content.zones, draft.isChanged, changes], [[], false, 8], 'all undone');
      same(freeName('zone', ['zone1', 'zone3']), 'zone2', 'a name that nobody has');
    },

    'what is told again after a reconnection counts once'() {
      const {model, tell} = begin([location(NOW)]);
      tell(NOW + 100, [location(NOW), location(NOW + 100)]);
      same([...model.targets.values()][0].past.map(({sent}) => sent), [NOW, NOW + 100], 'estimates');
    },
  };
  for (const [name, check] of Object.entries(checks)) {
    try {
      await check();
    } catch (error) {
      throw new Error(`${name}: ${error.stack}`);
    }
  }
  return Object.keys(checks);
})()
