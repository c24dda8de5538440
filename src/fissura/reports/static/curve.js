"use strict";
// Curves by Plotly. Colours named as "--ink" are those of the page, also when the scheme changes.
fissura.Curve = class {
  constructor(node, Plotly) {
    this.node = node;
    this.Plotly = Plotly;
    this.config = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d"] };
    fissura.onScheme(() => this.last && this.draw(...this.last));
  }

  draw(traces, x, y, more) {
    this.last = [traces, x, y, more];
    const ink = fissura.colour("ink"), line = fissura.colour("line");
    const axis = { gridcolor: line, zerolinecolor: line, linecolor: line, automargin: true };
    const layout = {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink },
      margin: { l: 50, r: 15, t: 30, b: 55 }, modebar: { bgcolor: "rgba(0,0,0,0)", color: line, activecolor: ink }, hovermode: "closest", showlegend: false, autosize: true,
      legend: { orientation: "h", y: -0.2 }, xaxis: { ...axis, title: { text: x, standoff: 10 } },
      yaxis: { ...axis, title: { text: y, standoff: 10 } }, uirevision: `${x} ${y}`, ...more,
    };
    return this.Plotly.react(this.node, this.themed(traces), layout, this.config);
  }

  themed(value) {
    if (typeof value === "string" && value.startsWith("--")) return fissura.colour(value.slice(2));
    if (Array.isArray(value)) return value.map((one) => this.themed(one));
    if (value && value.constructor === Object) {
      return Object.fromEntries(Object.entries(value).map(([key, one]) => [key, this.themed(one)]));
    }
    return value;
  }
};

// The curve of one run: any column over any other, and where the slider stands.
fissura.RunCurve = class {
  constructor(node, Plotly, data, steps) {
    this.data = data.curve;
    this.measured = data.measured;
    this.curve = new fissura.Curve(node, Plotly);
    this.rows = steps.map((step) => this.data.steps.indexOf(step));
    this.axes = ["x", "y"].map((axis) => {
      const select = document.getElementById(`curve-${axis}`);
      for (const column of this.data.columns) select.add(new Option(column.title, column.name));
      select.value = this.data[axis];
      select.addEventListener("change", () => this.draw());
      return select;
    });
  }

  async start(onStep) {
    await this.draw();
    this.curve.node.on("plotly_click", (event) => {
      const step = this.data.steps[event.points[0].customdata ?? 0];
      const far = this.rows.map((row) => Math.abs(this.data.steps[row] - step));
      onStep(far.indexOf(Math.min(...far)));
    });
  }

  column(name) {
    return this.data.columns.find((column) => column.name === name);
  }

  show(at) {
    this.at = at;
    return this.draw();
  }

  draw() {
    const [x, y] = this.axes.map((select) => this.column(select.value));
    const part = (rows) => ({
      x: rows.map((row) => x.values[row]), y: rows.map((row) => y.values[row]), customdata: rows,
      text: rows.map((row) => `step ${this.data.steps[row]}`),
      hovertemplate: "%{text}<br>%{x:.4g}, %{y:.4g}<extra></extra>",
    });
    const all = Array.from(this.data.steps, (_, row) => row);
    const now = this.at === undefined ? [] : [this.rows[this.at]];
    const traces = [
      { ...part(all), mode: "lines+markers", line: { color: "--accent", width: 2 }, marker: { size: 4 } },
      { ...part(this.rows), mode: "markers",
        marker: { symbol: "circle-open", size: 9, color: "--accent", line: { width: 1.5 } } },
      { ...part(now), mode: "markers",
        marker: { size: 13, color: "--second", line: { color: "--back", width: 2 } } },
    ];
    const band = this.measured;
    if (band && x.name === "gauge_m" && y.name === "load_N") {
      const edge = { mode: "lines", line: { color: "--soft", width: 1 }, hoverinfo: "skip" };
      traces.unshift(
        { ...edge, x: band.x, y: band.lower },
        { ...edge, x: band.x, y: band.upper, fill: "tonexty", fillcolor: "rgba(128,128,128,0.25)" },
      );
    }
    return this.curve.draw(traces, fissura.escaped(x.title), fissura.escaped(y.title));
  }

  told(at) {
    const row = this.rows[at], parts = [`${this.data.steps[row]} of ${this.data.steps.at(-1)}`];
    for (const name of [this.data.x, this.data.y, "dissipated_J", "bodies"]) {
      const column = this.column(name);
      const value = column.values[row], short = column.title.replace(/ \[.*\]$/, "");
      if (Number.isFinite(value)) {
        parts.push(`${short} ${column.unit ? fissura.told(value, column.unit) : value}`);
      }
    }
    return parts.join(", ");
  }
};

// Plotly takes marks of HTML in its text for what they are.
fissura.escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
