// The modules of the map, each by itself, in a page of a raylocd that publishes nothing (map_test.py).
// Evaluates to the names of the checks; the first that fails is thrown.
(async () => {
  const {Model} = await import('/map/model.js');

  const {Targets} = await import('/map/targets.js');
  const {showChannel} = await import('/map/panels.js');
  const {showSources} = await import('/map/sources.js');

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

  const begin = (messages) => {
    const said = [];
    const model = new Model((text) => said.push(text), () => {});
    const tell = (now, list) => model.update({now: new Date(now).toISOString(), messages: list});
    model.snapshot({now: new Date(NOW).toISOString(), epoch: '1', messages});
    return {model, said, tell};
  };

  const checks = {
    'a device that was lost long ago is no news'() {
      const {model, said} = begin([location(NOW - 5 * HOUR), location(NOW - 1000, person('7'))]);
      same(said, ['person 7 appeared'], 'announced');
      same(model.at(NOW).map(({target}) => target.name), ['person 7'], 'shown');
      same(model.first, NOW - 1000, 'what can be reviewed begins');
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
        quality: {no_fix_reason: 'nobody seen'}};
      const {model, said, tell} = begin([location(NOW, person('7', empty))]);
      same([model.at(NOW).length, said], [0, []], 'shown and announced');
      same(model.absence(), 'Nobody is located: nobody seen.', 'said');
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
        targets.show(model.at(NOW), {scale: 100, toPixel: (x, y) => [100 * x, 100 * y]});
        return [text('.target'), text('tr').replace('confirmed1.00, 2.00', '')];
      };
      same(show({}), [key, key], 'of one that is sure');
      same(show({quality: {warnings: ['beside the transmitter'], ambiguous: true}}),
        [`beside the transmitter; another place is nearly as likely${key}, doubtful`,
          `${key}beside the transmitter; another place is nearly as likely`], 'of one that is not');
      same(show({position: undefined, quality: {warnings: ['beside the transmitter'], no_fix_reason: 'moved'}}),
        [`${key}: no fix`, `${key}no fixmoved`], 'of one without a place');
      targets.show([], null);
    },

    'ellipses are of the likeliest place'() {
      const targets = new Targets();
      const drawn = (hypotheses) => {
        // Of both places together: 2 m.
        const {model} = begin([location(NOW, {position_covariance: [4, 0, 0, 0, 0.04, 0, 0, 0, 0], hypotheses})]);
        targets.show(model.at(NOW), {scale: 100, toPixel: (x, y) => [100 * x, 100 * y]});
        const [outer, inner] = document.querySelectorAll('#regions ellipse');
        return [outer, inner].map((one) => [Math.round(one.getAttribute('rx')), one.getAttribute('transform').split(')')[0],
          one.textContent]);
      };
      const place = (x, weight, sigma) => ({position: {x, y: 2, z: 1}, weight,
        position_covariance: [sigma * sigma, 0, 0, 0, sigma * sigma, 0, 0, 0, 0]});
      const of = ' of the likeliest place, which has 60 %';
      same(drawn([place(1.5, 0.6, 0.1), place(5, 0.4, 0.2)]),
        [[24, 'translate(150 200', `region of 95 %${of}`], [12, 'translate(150 200', `region of 50 %${of}`]], 'of two');
      same(document.querySelectorAll('#ghosts circle').length, 1, 'other places');
      for (const one of [[place(1, 1, 0.1)], undefined]) {
        same(drawn(one), [[490, 'translate(100 200', 'region of 95 %'], [235, 'translate(100 200', 'region of 50 %']], 'of one');
      }
      targets.show([], null);
    },

    'why a source failed is said'() {
      const {model} = begin([{sent: new Date(NOW).toISOString(), source: {
        access_point: 'ap9', status: 'SOURCE_STATUS_FAILED', detail: 'torn file', counters: {
          frames_complete: '0', frames_partial: '0', kernel_drops: '0', ring_dropped: '0', late: '0', frames_dropped: '0'}}}]);
      showSources(model);
      // The page itself takes the row away again: it knows no such source.
      same(document.querySelector('tr[data-source=ap9] td').textContent, 'failed: torn file', 'state');
    },

    'who is in a zone is what its last event said, at each time'() {
      const device = {mac: '02:00:00:00:00:01', track: '1'};
      const zone = (sent, kind, change) => ({sent: new Date(sent).toISOString(),
        zone: {event_id: `${kind}${sent}`, kind: `ZONE_EVENT_KIND_${kind}`, zone: 'desk', target: device, ...change}});
      const {model, tell} = begin([
        // Hardly inside any more, and not yet said to have left.
        location(NOW - 5000, {zones: [{zone: 'desk', probability: 0.4}]}),
        zone(NOW - 4000, 'ENTERED', {inside: [device, {track: '7'}]}),
        zone(NOW - 1000, 'DWELLED', {dwell: '3s', inside: [device]})]);
      same(model.at(NOW)[0].zones, ['desk'], 'inside');
      same(model.inside(NOW - 2000).get('desk').size, 2, 'inside, then');
      const left = zone(NOW + 100, 'LEFT', {dwell: '4.100s', reason: 'it was seen outside'});
      tell(NOW + 200, [left, location(NOW + 150, {zones: [{zone: 'desk', probability: 0.6}]}), left]);
      same(model.at(NOW + 200)[0].zones, [], 'inside, after it left');
      same(model.at(NOW)[0].zones, ['desk'], 'inside, in review');
      const name = device.mac;
      same(model.events.map(({text}) => text), [`${name} left desk after 4.1 s (it was seen outside)`,
        `${name} has been in desk for 3.0 s`, `${name} entered desk`], 'events');
    },

    'a channel is shown with its age'() {
      const channel = (time) => ({target: 'phone', time: new Date(time).toISOString(), tones: [-1, 1], access_points: [
        {id: 'ap1', correlation: 0.8, antennas: [{measured: [1, 1], simulated: [1, 0.9]}]}]});
      const said = () => document.querySelector('#csi-text').textContent.split(':')[0];
      const {model} = begin([]);
      showChannel([channel(NOW - 7000)], null, model);
      same(said(), 'phone, heard 7 s ago', 'live');
      showChannel([channel(NOW - HOUR)], 'laptop', model);
      same(said(), 'Of laptop no channel is known. phone, heard 3600 s ago', 'when another one is selected');
      showChannel([channel(Date.parse('2020-01-01T00:01:07Z'))], 'phone', begin([playing(NOW, 1)]).model);
      same(document.querySelector('#csi-text').textContent.startsWith('phone, 1:07.0 into the recording: '), true, 'of a recording');
      same(document.querySelectorAll('#csi-charts svg').length, 1, 'charts');
      showChannel([], null, model);
      same(document.querySelectorAll('#csi-charts svg').length, 0, 'charts of nothing');
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
