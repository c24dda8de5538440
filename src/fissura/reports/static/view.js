"use strict";
// Bodies and cracks in 3D by K3D, which has the objects "skin", "edges" and "cracks" to be filled at each step.
fissura.View = class {
  constructor(node, scene) {
    this.node = node;
    this.scene = scene;
    this.states = scene.states.map((state) => state.number);
    this.cache = new Map();
    this.turn = Promise.resolve();
  }

  async start(k3d) {
    if (!document.createElement("canvas").getContext("webgl2")) throw new Error("this browser has no WebGL");
    this.k3d = await k3d.CreateK3DAndLoadBinarySnapshot(this.scene.plot, this.node);
    const known = Object.values(this.k3d.getWorld().ObjectsListJson);
    this.objects = Object.fromEntries(known.map((one) => [one.name, one]));
    this.signs = known.filter((one) => one.name === "sign");
    this.controls();
    this.paint();
    this.lookFromFront();
    fissura.onScheme(() => this.paint());
    new ResizeObserver(() => { this.k3d.resizeHelper(); this.k3d.render(); }).observe(this.node);
    if (!this.states.length) await this.k3d.removeObject(this.objects.edges.id);
  }

  // Colours of the page behind it, and of its grid.
  paint() {
    const number = (name) => parseInt(fissura.colour(name).slice(1), 16);
    this.k3d.setClearColor(number("back"));
    this.k3d.setGridColor(number("line"));
    this.k3d.setLabelColor(number("soft"));
  }

  // So far away that the specimen fills the view.
  lookFromFront() {
    const [low, high] = this.scene.bounds, [right, up, eye] = this.scene.sight;
    const middle = low.map((value, k) => (value + high[k]) / 2);
    const half = (axis) => axis.reduce((sum, part, k) => sum + Math.abs(part) * (high[k] - low[k]) / 2, 0);
    const slope = Math.tan(this.scene.angle * Math.PI / 360);
    const aspect = this.node.clientWidth / Math.max(this.node.clientHeight, 1);
    const far = half(eye) + 1.2 * Math.max(half(up), half(right) / aspect) / slope;
    this.k3d.setCamera([...middle.map((value, k) => value + far * eye[k]), ...middle, ...up]);
    this.k3d.render();
  }

  controls() {
    const by = (name) => document.getElementById(`view-${name}`);
    this.by = by;
    for (const name of ["bodies", "opacity", "cracks", "wide", "magnify"]) {
      by(name)?.addEventListener("input", () => this.show(this.at));
    }
    for (const name of ["cut", "at", "other"]) by(name).addEventListener("input", () => this.cut());
    by("signs").addEventListener("input", () => this.showSigns());
    by("grid").addEventListener("input", () => this.k3d.setGridVisible(by("grid").checked));
    by("reset").addEventListener("click", () => this.lookFromFront());
    this.colours();
  }

  cut() {
    const axis = this.by("cut").value, whole = axis === "";
    this.by("at").disabled = this.by("other").disabled = whole;
    this.by("at-told").textContent = "";
    if (whole) return this.k3d.setClippingPlanes([]);
    const [low, high] = this.scene.bounds.map((corner) => corner[axis]);
    const at = low + this.by("at").value * (high - low), sign = this.by("other").checked ? 1 : -1;
    const plane = [0, 0, 0, -sign * at];
    plane[axis] = sign;
    this.by("at-told").textContent = `${"xyz"[axis]} = ${fissura.told(at, "mm")}`;
    this.k3d.setClippingPlanes([plane]);
  }

  showSigns() {
    const shown = this.by("signs").checked;
    this.k3d.setHiddenObjectIds(shown ? [] : this.signs.map((one) => one.id));
    for (const one of this.signs) {
      const drawn = this.k3d.getObjectById(one.id);
      if (drawn) drawn.visible = shown;
    }
    this.k3d.render();
  }

  // Positions, displacements, triangles and edges of the polygons of a state.
  geometry(at, kind) {
    const key = `${at} ${kind}`;
    if (this.cache.has(key)) return this.cache.get(key);
    const stored = this.scene.states[at][kind], sizes = stored.sizes;
    const axes = stored.points.map(fissura.values);
    const found = {
      sizes, axes, by: stored.moved ? stored.moved.map(fissura.values) : axes.map((axis) => new Float32Array(axis.length)),
      stored,
    };
    this.cache.set(key, found);
    return found;
  }

  // Corners of the polygons where they are, moved, and values at all corners of a polygon.
  mesh(found, factor, values, wanted) {
    const points = [], triangles = [], edges = [], attribute = [];
    let first = 0, count = 0;
    found.sizes.forEach((size, k) => {
      if (wanted(k)) {
        for (let c = 0; c < size; c++) {
          for (let axis = 0; axis < 3; axis++) points.push(found.axes[axis][first + c] + factor * found.by[axis][first + c]);
          attribute.push(values[k]);
          edges.push(count + c, count + (c + 1) % size);
          if (c > 1) triangles.push(count, count + c - 1, count + c);
        }
        count += size;
      }
      first += size;
    });
    const shaped = (data, width) => ({ data, shape: width > 1 ? [data.length / width, width] : [data.length] });
    return {
      vertices: shaped(new Float32Array(points), 3), indices: shaped(new Uint32Array(triangles), 3),
      attribute: shaped(new Float32Array(attribute), 1), edges: shaped(new Uint32Array(edges), 2), count,
    };
  }

  settings() {
    const number = (name) => Number(this.by(name).value);
    // Small openings take most of the way of their slider.
    return {
      bodies: this.by("bodies").value, cracks: this.by("cracks").value, opacity: number("opacity"),
      widest: number("wide") ** 2 * this.scene.widest, factor: number("magnify") * this.scene.magnify,
    };
  }

  // Shows a state; what is asked for meanwhile waits, and only the last of it is drawn.
  show(at) {
    if (!this.states.length) return this.turn;
    this.at = at;
    this.colours();
    this.wanted = (this.wanted || 0) + 1;
    const number = this.wanted;
    this.turn = this.turn.then(() => (number === this.wanted ? this.drawn(at) : null));
    return this.turn;
  }

  async drawn(at) {
    const set = this.settings(), skin = this.geometry(at, "skin"), torn = this.geometry(at, "cracks");
    const colour = set.bodies === "fine" ? skin.stored.fine
      : fissura.values(skin.stored.stress).map((value) => value / this.scene.stress);
    await this.put("skin", this.mesh(skin, set.factor, colour, () => true), set.bodies, set.opacity);
    const opening = fissura.values(torn.stored.opening), most = this.scene.widest || 1;
    const shade = set.cracks === "damage" ? fissura.values(torn.stored.damage)
      : opening.map((value) => Math.sqrt(value / most));
    await this.put("cracks", this.mesh(torn, set.factor, shade, (k) => opening[k] >= set.widest), set.cracks, 1);
    this.k3d.render();
    this.node.dataset.step = this.states[at];
  }

  async put(name, mesh, map, opacity) {
    const { vertices, indices, attribute, edges, count } = mesh;
    const colours = this.scene.maps[map];
    const look = { color_map: { data: new Float32Array(colours), shape: [colours.length / 4, 4] }, color_range: [0, 1] };
    const visible = count > 0 && opacity > 0;
    await this.k3d.reload({ ...this.objects[name], ...look, vertices, indices, attribute, opacity, visible }, null);
    if (name === "skin") await this.k3d.reload({ ...this.objects.edges, vertices, indices: edges, visible }, null);
  }

  // What colours mean, beside the view.
  colours() {
    const box = document.getElementById("view-colours"), scene = this.scene, parts = [];
    const map = (name, low, high, title) => {
      const stops = scene.maps[name], rgb = [];
      for (let k = 0; k < stops.length; k += 4) {
        rgb.push(`rgb(${stops.slice(k + 1, k + 4).map((part) => Math.round(255 * part)).join(" ")}) ${100 * stops[k]}%`);
      }
      const bar = document.createElement("i");
      bar.className = "map";
      bar.style.background = `linear-gradient(to right, ${rgb.join(", ")})`;
      const line = document.createElement("span");
      line.append(`${title}: ${low}`, bar, high);
      parts.push(line);
    };
    if (this.states.length) {
      const set = this.settings();
      if (set.bodies === "fine") map("fine", "coarse", "fine", "bodies");
      else map("stress", "0", `${fissura.told(scene.stress, "MPa")} and more`, "largest principal stress");
      if (set.cracks === "damage") map("damage", "0", "1", "damage");
      else map("opening", "0", fissura.told(scene.widest, "µm"), "opening, by its square root");
      this.by("opacity-told").textContent = `${Math.round(100 * set.opacity)} %`;
      this.by("wide-told").textContent = fissura.told(set.widest, "µm");
      this.by("magnify-told").textContent = `× ${set.factor.toPrecision(3)}`;
    }
    if (scene.marks) map("stress", fissura.told(scene.marks.low), fissura.told(scene.marks.high), scene.marks.name);
    box.replaceChildren(...parts);
  }
};
