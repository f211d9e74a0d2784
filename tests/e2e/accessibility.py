"""Accessibility of a page for people who use no mouse, no eyes, or weak ones. Each check raises an
AssertionError that names what is wrong."""

# Contrast of text to the nearest opaque colour behind it (WCAG 2.1, 1.4.3).
CONTRAST = """(() => {
  const linear = (c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const parse = (text) => { const n = text.match(/[0-9.]+/g).map(Number); return n.length < 4 ? [...n, 1] : n; };
  const behind = (e) => {
    for (; e; e = e.parentElement) {
      const c = parse(getComputedStyle(e).backgroundColor);
      if (c[3] === 1) return c;
    }
    return [255, 255, 255, 1];
  };
  const ratio = (a, b) => { const [h, l] = [luminance(a), luminance(b)].sort((x, y) => y - x); return (h + 0.05) / (l + 0.05); };
  const found = [];
  for (const e of document.querySelectorAll('body *:not(svg *)')) {
    const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
    if (!own || !e.checkVisibility() || e.tagName === 'NOSCRIPT') continue;
    found.push([e.id || e.className || e.tagName, ratio(parse(getComputedStyle(e).color), behind(e))]);
  }
  return found;
})()"""

# Contrast of the marks on the map, by the computed style with all its opacities, to each ground that they may be on.
# Drawn in addition to the present marks: targets of every colour, live and stale, with other places, the marks of
# three compared methods, a dot of each step, and a zone of each kind. A mark counts by its outline or its filling,
# the one with more contrast; text by its filling. Only the last seconds of a trail count: the rest fades.
DRAWN = """(async () => {
  const {Targets} = await import('/map/targets.js');
  const {dotOf} = await import('/map/fits.js');
  const place = (x, weight) => ({position: {x, y: 0}, weight, position_covariance: [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0]});
  const location = {position: {x: 0, y: 0}, accuracy_m: 1, accuracy_confidence: 0.95, track_state: '', quality: {},
    hypotheses: [place(0, 0.4), place(1, 0.4), place(2, 0.1)]};
  const view = {scale: 100, unit: 1, toPixel: (x, y) => [100 * x, 100 * y]};
  view.mark = view.flat = (x, y) => `translate(${100 * x} ${100 * y})`;
  const sample = new Targets();
  sample.methods.names = ['own', 'a', 'b', 'c'];
  const compared = ['a', 'b', 'c'].map((method) => ({method, location, stale: null}));
  sample.show(Array.from({length: 16}, (_, i) => ({target: {key: `sample ${i}`, name: 'sample', colour: i % 8},
    location, stale: i < 8 ? null : 1, trail: [{x: 0, y: 0}, {x: 1, y: 1}], zones: [], compared: i ? [] : compared})), view);
  const dots = [0.1, 0.3, 0.5, 0.7, 0.9].map((share) => dotOf({share}));
  document.querySelector('#residuals').append(...dots);
  const {svg} = await import('/map/draw.js');
  const zones = [0, 1, 2, 3].map((i) => svg('g', {class: `z${i}`}, [svg('polygon', {class: `zone z${i}`}),
    svg('rect', {class: 'zone-tag'}), svg('text', {class: 'zone-name'}, ['sample'])]));
  document.querySelector('#zones').append(...zones);
  const linear = (c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const ratio = (a, b) => { const [h, l] = [luminance(a), luminance(b)].sort((x, y) => y - x); return (h + 0.05) / (l + 0.05); };
  const parse = (text) => { const n = (text.match(/[0-9.]+/g) || []).map(Number); return n.length < 3 ? null : n.length < 4 ? [...n, 1] : n; };
  const root = getComputedStyle(document.documentElement);
  const ground = (name) => { const v = root.getPropertyValue(name).trim(); return [1, 3, 5].map((i) => parseInt(v.slice(i, i + 2), 16)); };
  const grounds = ['--page', '--floor', '--furniture'].map(ground);
  const opacity = (e) => { let all = 1; for (; e && e.id !== 'map'; e = e.parentElement) all *= Number(getComputedStyle(e).opacity); return all; };
  const seen = (colour, alpha, on) => {
    const c = parse(colour);
    if (!c) return 1;
    const a = c[3] * alpha;
    return ratio([0, 1, 2].map((i) => a * c[i] + (1 - a) * on[i]), on);
  };
  const least = (e, what, on) => {
    const style = getComputedStyle(e);
    if (what === 'stroke' && !(parseFloat(style.strokeWidth) >= 1)) return 1;
    return Math.min(...on.map((one) => seen(style[what], opacity(e) * Number(style[`${what}Opacity`]), one)));
  };
  const found = [];
  for (const e of document.querySelectorAll('#map :is(circle, ellipse, line, path, polygon, polyline, rect, text)')) {
    const style = getComputedStyle(e);
    if (style.display === 'none' || e.matches('.floor, .ceiling') || e.closest('#solid') || e.matches('.old-1, .old-2, .old-3, .old-4') || e.getAttribute('visibility') === 'hidden') continue;
    const text = e.tagName === 'text';
    const on = e.matches('.furniture') ? grounds.slice(0, 2) : grounds;  // that is a ground itself
    const name = [e.tagName, e.getAttribute('class') || e.parentElement.getAttribute('class') || ''].join(' ').trim();
    found.push([name, text ? 4.5 : 3, text ? least(e, 'fill', on) : Math.max(least(e, 'fill', on), least(e, 'stroke', on))]);
  }
  sample.show([], null);
  [...dots, ...zones].forEach((one) => one.remove());
  return found;
})()"""
MARKS = ("circle dot", "circle region outer", "ellipse region part", "ellipse ghost", "circle ghost",
         "polyline old-0", "polygon furniture", "path leaf", "path pane", "text zone-name", "text object-name", "path", "text", "circle residual fit-0",
         "circle residual fit-4", "path shape", "line tie", "circle ring")


def show_theme(page, theme):
    for _ in range(3):
        if page.ask("document.documentElement.dataset.theme") == theme and \
                theme in page.ask("document.querySelector('#theme').textContent"):
            break
        page.ask("document.querySelector('#theme').click()")
    assert page.ask("document.documentElement.dataset.theme") == theme


def check_texts(page, theme, least):
    """The texts, more than `least` of them, in the theme that is shown."""
    texts = page.ask(CONTRAST)
    assert len(texts) > least, texts
    for name, ratio in texts:
        assert ratio >= 4.5, f"{theme}: the text of {name} has a contrast of {ratio:.2f}"


def check_contrast(page, theme):
    """Text 4.5, whatever is drawn 3, in that theme."""
    show_theme(page, theme)
    page.ask("document.querySelectorAll('details').forEach(d => { d.open = true; })")
    check_texts(page, theme, 40)
    drawn = page.ask(DRAWN)
    for mark in MARKS:
        assert any(name.startswith(mark) for name, _, _ in drawn), f"no {mark} is drawn"
    for name, wanted, ratio in drawn:
        assert ratio >= wanted, f"{theme}: {name} is drawn with a contrast of {ratio:.2f}"


# Elements that a screen reader reads out by itself when they change.
LIVE = """[...document.querySelectorAll('[aria-live], output, [role=status], [role=alert], [role=log]')]
  .filter((e) => e.ariaLive !== 'off').map((e) => e.id)"""


def check_tree(page, buttons=7):
    """Every control has a name, every region and table what a screen reader needs."""
    page.ask("document.querySelectorAll('details').forEach(d => { d.open = true; })")
    page.call("Accessibility.enable")
    nodes = page.call("Accessibility.getFullAXTree")["nodes"]
    page.call("Accessibility.disable")
    by_role = {}
    for node in nodes:
        if not node["ignored"]:
            by_role.setdefault(node["role"]["value"], []).append(
                node.get("name", {}).get("value", "").strip())
    controls = ("button", "slider", "combobox", "checkbox", "link", "application", "region", "table",
                "DisclosureTriangle", "status")
    for role in controls:
        for name in by_role.get(role, []):
            assert name or role in ("status", "table"), f"a {role} without a name"
    for role, least in (("button", buttons), ("slider", 1), ("combobox", 1), ("application", 1),
                        ("columnheader", 9), ("rowheader", 4), ("main", 1), ("banner", 1),
                        ("heading", 6), ("list", 1), ("status", 1)):
        assert len(by_role.get(role, [])) >= least, f"{len(by_role.get(role, []))} of role {role}"
    assert page.ask("document.documentElement.lang") == "en"
    assert sorted(page.ask(LIVE)) == ["announcer", "connection", "playback-error"], page.ask(LIVE)
    assert page.ask("document.querySelector('#announcer').textContent") != "", "nothing was announced"
    doubled = page.ask("(() => { const ids = [...document.querySelectorAll('[id]')].map(e => e.id);"
                       "return ids.filter((id, i) => ids.indexOf(id) !== i); })()")
    assert not doubled, f"ids used twice: {doubled}"


FOCUS = """(() => {
  const e = document.activeElement;
  const seen = e.matches(':focus-visible') && parseFloat(getComputedStyle(e).outlineWidth) >= 2;
  return [e === document.body ? '' : e.id || e.textContent.trim() || e.className, seen];
})()"""


def check_by_keyboard(page, target):
    """Everything can be reached and used by keys alone, and shows where the focus is."""
    page.ask("document.activeElement.blur(); window.scrollTo(0, 0)")
    reached = []
    for _ in range(60):
        page.press("Tab")
        name, seen = page.ask(FOCUS)
        if not name:  # past the last one
            break
        assert name not in reached, f"the focus comes back to {name}: {reached}"
        assert seen, f"no visible focus at {name}"
        reached.append(name)
        use(page, name, target)
    wanted = ["Skip to the list of targets", "theme", "map", "zoom-in", "zoom-out", "fit", "solid-look", "heat-look", "play",
              "scrubber", "speed", "live", target, "event-list", CHANNEL, CALIBRATION,
              "show-residuals", "fits", "Legend"]
    missing = [name for name in wanted if name not in reached]
    assert not missing, f"not reached by Tab: {missing} (reached: {reached})"


CHANNEL, CALIBRATION = "Channel: measured and simulated", "Calibration"
TIME_SHOWN = "document.querySelector('#time-shown').textContent"
DOTS = "document.querySelectorAll('#residuals circle').length"


def use(page, name, target):
    """The effect of a key on this control, if it is one of those to try."""
    if name == "map":
        use_map(page)
    elif name == target:
        chosen = f"document.querySelector('tr[data-target=\"{target}\"] button').ariaPressed"
        page.press("Enter")
        page.wait(f"{chosen} === 'true'")
        page.press("Escape")
        page.wait(f"{chosen} === 'false'")
    elif name == "solid-look":
        page.press("Enter")
        page.wait("document.querySelectorAll('#solid polygon').length > 30 && getComputedStyle(document.querySelector('#plan')).display === 'none'")
        page.press(" ")
        page.wait("getComputedStyle(document.querySelector('#solid')).display === 'none'")
    elif name == "heat-look":
        page.press("Enter")
        page.wait("document.querySelectorAll('#heat rect').length > 0 && "
                  "/^Presence in the last 24 h/.test(document.querySelector('#heat-text').textContent)")
        page.press(" ")
        page.wait("!document.querySelector('#heat-text').checkVisibility()")
    elif name == "theme":
        before = page.ask("document.querySelector('#theme').textContent")
        page.press("Enter")
        page.wait(f"document.querySelector('#theme').textContent !== '{before}'")
    elif name == "scrubber":
        page.press("ArrowLeft")  # only then there is a way back to tab to
        page.wait(f"{TIME_SHOWN}.includes('ago')")
    elif name == "live":
        page.press("Enter")
        page.wait(f"{TIME_SHOWN} === 'live'")
        assert page.ask("document.activeElement.id") == "play", "the focus is lost with the button"
        for _ in ("scrubber", "speed"):
            page.press("Tab")
    elif name in (CHANNEL, CALIBRATION, "Legend"):
        page.press("Enter")
        page.wait("document.activeElement.parentElement.open")
    elif name == "show-residuals":
        page.press(" ")
        page.wait(f"{DOTS} > 0")
        page.press(" ")
        page.wait(f"{DOTS} === 0")


def use_map(page):
    transform = "document.querySelector('#plan').getAttribute('transform')"
    fitting = page.wait(transform)
    for key in ("ArrowLeft", "+", "ArrowUp", "-"):
        before = page.ask(transform)
        page.press(key)
        page.wait(f"{transform} !== '{before}'")
    page.press("0")
    page.wait(f"{transform} === '{fitting}'")
