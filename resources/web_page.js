"use strict";
// Shows the stored positions of a machine: nothing is computed here but where each lies on the page.
const kindyna = (() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const SVG = "http://www.w3.org/2000/svg";
  const count = Math.max(...data.machines.map(machine => machine.angles.length));
  const step = 360 / count;
  let index = 0, playing = false, last = 0, gone = 0;

  const make = (tag, attributes, parent) => {
    const made = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    if (parent) parent.appendChild(made);
    return made;
  };
  const html = (tag, text, parent) => {
    const made = document.createElement(tag);
    if (text) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
  };
  const path = (points, closed) => "M" + points.map(([x, y]) => x + " " + y).join("L") + (closed ? "Z" : "");
  const put = (group, x, y, turn) => group.setAttribute("transform", `translate(${x} ${y}) rotate(${turn})`);

  // The stored position of a machine that belongs to one of the page: its own angle lags behind by its phase.
  const own = (machine, at) => {
    const n = machine.angles.length;
    if (!machine.whole) return Math.min(at, n - 1);
    return ((Math.round(at - machine.phase / 360 * n)) % n + n) % n;
  };

  // Where everything of one machine stands: places of bodies and of their points in mm, angles in degrees.
  const pose = (machine, i) => {
    const bodies = {};
    for (const body of machine.bodies) {
      const turn = body.turn[i] * Math.PI / 180, c = Math.cos(turn), s = Math.sin(turn), points = {};
      for (const [name, x, y] of body.points) points[name] = [body.x[i] + c * x - s * y, body.y[i] + s * x + c * y];
      bodies[body.name] = points;
    }
    const cam = machine.cam && {turn: machine.sense * machine.angles[i], face: [machine.cam.face.x[i], machine.cam.face.y[i]]};
    return {angle: machine.angles[i], bodies, cam};
  };

  const box = machine => {
    const xs = [], ys = [];
    const add = (x, y, r) => { xs.push(x - r, x + r); ys.push(y - r, y + r); };
    for (let i = 0; i < machine.angles.length; i += 8) {
      for (const points of Object.values(pose(machine, i).bodies)) for (const [x, y] of Object.values(points)) add(x, y, 0);
      if (machine.cam) {
        const face = machine.cam.face, turn = face.turn[i] * Math.PI / 180, c = Math.cos(turn), s = Math.sin(turn);
        for (const [x, y] of face.outline) add(face.x[i] + c * x - s * y, face.y[i] + s * x + c * y, 0);
        for (const roller of machine.cam.rollers) add(roller.x[i], roller.y[i], roller.radius);
      }
    }
    if (machine.space) {
      add(...machine.space.at, machine.space.radii[0]);
      for (const [x, y] of machine.space.poses[0][0]) add(x, y, 0);
    }
    if (machine.cam) for (const flank of machine.cam.flanks) for (const [x, y] of flank) add(0, 0, Math.hypot(x, y));
    const room = 0.06 * Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys)) || 1;
    return [Math.min(...xs) - room, Math.min(...ys) - room, Math.max(...xs) + room, Math.max(...ys) + room];
  };

  // Draws a machine once; gives the function that moves it.
  const drawn = machine => {
    const [left, low, right, high] = box(machine), unit = Math.hypot(right - left, high - low) / 110, moved = [];
    const figure = html("figure", "", document.getElementById("machines"));
    const sheet = make("svg", {class: "machine", viewBox: `${left} ${-high} ${right - left} ${high - low}`, tabindex: 0, role: "img"}, figure);
    sheet.setAttribute("aria-label", machine.name || data.name);
    if (machine.name) html("figcaption", machine.name, figure);
    const up = make("g", {transform: "scale(1 -1)"}, sheet);
    for (const pin of machine.fixed) {
      if (pin.guide) make("path", {class: "guide", d: path(pin.guide, false)}, up);
      else make("path", {class: "ground", d: path([pin.at, [pin.at[0] - 2 * unit, pin.at[1] - 3.4 * unit], [pin.at[0] + 2 * unit, pin.at[1] - 3.4 * unit]], true)}, up);
    }
    if (machine.cam) {
      const group = make("g", {"data-body": "cam"}, up);
      machine.cam.flanks.slice().reverse().forEach((flank, n, all) => make("path", {class: n === all.length - 1 || all.length === 1 ? "cam" : "line", d: path(flank, true)}, group));
      for (const radius of machine.cam.circles) make("circle", {class: "line", r: radius}, group);
      if (machine.cam.keyway.length) make("path", {class: "line", d: path(machine.cam.keyway, true)}, group);
      make("path", {class: "line", d: `M${-2 * unit} 0H${2 * unit}M0 ${-2 * unit}V${2 * unit}`}, group);
      moved.push(i => put(group, 0, 0, machine.sense * machine.angles[i]));
    }
    if (machine.space) {
      const {at, start, radii, poses} = machine.space, end = make("g", {"data-body": "cam"}, up);
      make("circle", {class: "cam", r: radii[0]}, end);
      make("circle", {class: "line", r: radii[1]}, end);
      make("path", {class: "line", d: `M${0.76 * radii[1]} 0H${radii[0]}`}, end);
      moved.push(i => put(end, at[0], at[1], start + machine.sense * machine.angles[i]));
      const side = make("path", {class: "cam", "data-body": "cam-side"}, up), edges = make("path", {class: "line"}, up);
      moved.push(i => {
        const [outline, ...lines] = poses[Math.floor(i * poses.length / machine.angles.length)];
        side.setAttribute("d", path(outline, true));
        edges.setAttribute("d", lines.map(line => path(line, false)).join(""));
      });
    }
    for (const body of machine.bodies) {
      if (body.fixed) continue;
      const group = make("g", {"data-body": body.name}, up), corners = body.points.map(([, x, y]) => [x, y]);
      const apart = corners.filter(([x, y], n) => corners.findIndex(([a, b]) => Math.hypot(a - x, b - y) < 1e-6) === n);
      if (body.stem) for (const [name, width] of [["rim", 2.4], ["bar", 2]]) make("path", {class: name, d: path([[0, 0], body.stem], false), "stroke-width": width * unit}, group);
      else if (body.slides) make("rect", {class: "body", x: -2.2 * unit, y: -1.5 * unit, width: 4.4 * unit, height: 3 * unit}, group);
      for (const [name, width] of [["rim", 2], ["bar", 1.6]]) if (apart.length > 1) make("path", {class: name, d: path(apart, apart.length > 2), "stroke-width": width * unit}, group);
      for (const roller of body.rollers) make("path", {class: "body", d: path(roller, true)}, group);
      for (const [x, y] of apart) make("circle", {class: "pin", cx: x, cy: y, r: 0.6 * unit}, group);
      moved.push(i => put(group, body.x[i], body.y[i], body.turn[i]));
    }
    if (machine.cam) {
      const face = make("g", {"data-body": "face"}, up);
      make("path", {class: "body", d: path(machine.cam.face.outline, true)}, face);
      moved.push(i => put(face, machine.cam.face.x[i], machine.cam.face.y[i], machine.cam.face.turn[i]));
      for (const roller of machine.cam.rollers) {
        const round = make("circle", {class: "body", r: roller.radius}, up);
        moved.push(i => put(round, roller.x[i], roller.y[i], 0));
      }
    }
    // Turned by hand: about the cam's centre, of a cam in space that of its end view, else about the first pin on the frame.
    const pins = machine.fixed.filter(pin => !pin.guide), centre = machine.space ? machine.space.at : machine.cam || !pins.length ? [0, 0] : pins[0].at;
    const bearing = event => {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(sheet.getScreenCTM().inverse());
      return Math.atan2(-at.y - centre[1], at.x - centre[0]) * 180 / Math.PI;
    };
    let from = null, start = 0;
    sheet.addEventListener("pointerdown", event => { from = bearing(event); start = index; stop(); sheet.setPointerCapture(event.pointerId); });
    sheet.addEventListener("pointermove", event => {
      if (from === null) return;
      const now = bearing(event), moved = ((now - from) % 360 + 540) % 360 - 180;
      start += machine.sense * moved / step;
      from = now;
      show(start);
    });
    for (const name of ["pointerup", "pointercancel"]) sheet.addEventListener(name, () => { from = null; });
    sheet.addEventListener("keydown", event => {
      const by = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 20, PageDown: -20}[event.key];
      if (by) { event.preventDefault(); stop(); show(index + by); }
    });
    return at => { const i = own(machine, at); for (const move of moved) move(i); };
  };

  // Draws a curve once; gives the function that moves its cursor.
  const plotted = (machine, curve) => {
    const figure = html("figure", "", document.getElementById("plots"));
    figure.className = "plot";
    const caption = html("figcaption", "", figure);
    html("span", (machine.name ? machine.name + ": " : "") + curve.label + (curve.symbol ? " " + curve.symbol : ""), caption);
    const value = html("output", "", caption), n = curve.values.length;
    const most = Math.max(...curve.values), least = Math.min(...curve.values), room = 0.06 * (most - least) || 1;
    const sheet = make("svg", {viewBox: `0 0 ${n} 100`, preserveAspectRatio: "none", role: "img"}, figure);
    sheet.setAttribute("aria-label", `${curve.label}, ${least} to ${most} ${curve.unit}`);
    const down = y => 100 * (most + room - y) / (most - least + 2 * room);
    if (least < 0 && most > 0) make("path", {class: "zero", d: `M0 ${down(0)}H${n}`}, sheet);
    make("path", {class: "curve", d: path(curve.values.map((y, i) => [i, down(y).toFixed(3)]), false)}, sheet);
    const cursor = make("path", {class: "cursor", d: "M0 0V100"}, sheet), scale = html("div", "", figure);
    scale.className = "scale";
    html("span", `${least} … ${most} ${curve.unit}`, scale);
    const go = event => {
      const frame = sheet.getBoundingClientRect(), at = Math.round((event.clientX - frame.left) / frame.width * n);
      stop();
      show(machine.whole ? at + Math.round(machine.phase / step) : at);
    };
    let held = false;
    sheet.addEventListener("pointerdown", event => { held = true; sheet.setPointerCapture(event.pointerId); go(event); });
    sheet.addEventListener("pointermove", event => { if (held) go(event); });
    for (const name of ["pointerup", "pointercancel"]) sheet.addEventListener(name, () => { held = false; });
    return {figure, move: at => {
      const i = own(machine, at);
      cursor.setAttribute("transform", `translate(${i} 0)`);
      value.textContent = `${curve.values[i]} ${curve.unit}`;
    }};
  };

  const machines = data.machines.map(drawn), plots = new Map();
  const chosen = (machine, curve, on) => {
    const key = machine.name + "\n" + curve.slug;
    if (on && !plots.has(key)) plots.set(key, plotted(machine, curve));
    if (!on && plots.has(key)) { plots.get(key).figure.remove(); plots.delete(key); }
  };
  for (const machine of data.machines) for (const curve of machine.curves) {
    const line = html("label", "", document.getElementById("choice")), box = html("input", "", line);
    box.type = "checkbox";
    box.checked = curve.shown;
    line.append(" " + (machine.name ? machine.name + ": " : "") + curve.label);
    box.addEventListener("change", () => { chosen(machine, curve, box.checked); show(index); });
    if (curve.shown) chosen(machine, curve, true);
  }

  const turn = document.getElementById("turn"), play = document.getElementById("play"), whole = data.machines.every(machine => machine.whole);
  turn.max = whole ? count - 1 : data.machines[0].angles.length - 1;
  const show = at => {
    const most = Number(turn.max);
    index = whole ? (Math.round(at) % count + count) % count : Math.max(0, Math.min(most, Math.round(at)));
    for (const move of machines) move(index);
    for (const plot of plots.values()) plot.move(index);
    turn.value = index;
    const shown = data.machines.length > 1 ? index * step : data.machines[0].angles[index];
    document.getElementById("angle").textContent = `${data.angle} ${shown.toFixed(1)}°`;
  };
  const stop = () => { playing = false; play.textContent = "Play"; };
  const frame = now => {
    if (!playing) return;
    gone += (now - last) / 1000 * Number(document.getElementById("speed").value) / data.seconds * count;
    last = now;
    show(whole ? gone : Math.abs((gone / 2 % Number(turn.max)) * 2 - Number(turn.max)));
    requestAnimationFrame(frame);
  };
  play.addEventListener("click", () => {
    playing = !playing;
    play.textContent = playing ? "Pause" : "Play";
    if (playing) { gone = index; last = performance.now(); requestAnimationFrame(frame); }
  });
  turn.addEventListener("input", () => { stop(); show(Number(turn.value)); });
  document.getElementById("theme").addEventListener("click", () => {
    const dark = getComputedStyle(document.documentElement).colorScheme === "dark"
      || (getComputedStyle(document.documentElement).colorScheme !== "light" && matchMedia("(prefers-color-scheme: dark)").matches);
    document.documentElement.dataset.theme = dark ? "light" : "dark";
  });
  show(Number(location.hash.slice(1)) / step || 0);
  return {data, show, at: () => index, pose: (number, i) => pose(data.machines[number], own(data.machines[number], i))};
})();
