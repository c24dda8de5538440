"use strict";
// Puts the page together: the slider moves the marker on the curve and the bodies, a click on the curve the slider.
fissura.problem = function (node, error) {
  node.replaceChildren(Object.assign(document.createElement("p"), { className: "message", textContent: error }));
};

fissura.run = async function (data) {
  const slider = document.getElementById("step"), told = document.getElementById("step-told");
  const states = data.scene ? data.scene.states.map((state) => state.number) : [];
  const steps = states.length ? states : Array.from(data.curve.steps).slice(1);
  const parts = (fissura.parts = {});
  const show = (at) => {
    slider.value = at;
    told.textContent = parts.curve ? parts.curve.told(at) : `${steps[at]}`;
    return Promise.all([parts.curve?.show(at), parts.view?.show(at)]);
  };
  slider.max = steps.length - 1;
  slider.addEventListener("input", () => show(Number(slider.value)));
  const node = document.getElementById("curve");
  try {
    parts.curve = new fissura.RunCurve(node, await fissura.library("Plotly"), data, steps);
    await parts.curve.start(show);
  } catch (error) {
    fissura.problem(node, `The curve cannot be shown here: ${error.message}`);
    delete parts.curve;
  }
  await show(steps.length - 1);
  parts.view = await fissura.started(data.scene);
  await show(Number(slider.value));
};

// The 3D view, or undefined where there is none or it cannot be shown.
fissura.started = async function (scene) {
  const node = document.getElementById("view");
  if (!node || !scene) return undefined;
  try {
    const view = new fissura.View(node, scene);
    await view.start(await fissura.library("K3D-jupyter"));
    return view;
  } catch (error) {
    fissura.problem(node, `The 3D view cannot be shown here: ${error.message}`);
    return undefined;
  }
};

fissura.ensemble = async function (data) {
  const node = document.getElementById("curve");
  if (node && data.lines) {
    try {
      const curve = new fissura.Curve(node, await fissura.library("Plotly"));
      const show = ({ traces, x, y }) =>
        curve.draw(traces, fissura.escaped(x), fissura.escaped(y), { showlegend: true });
      document.getElementById("curve-view")?.addEventListener("input", (event) => show(data.lines.views[event.target.value]));
      await show(data.lines.views[0]);
    } catch (error) {
      fissura.problem(node, `The curves cannot be shown here: ${error.message}`);
    }
  }
  fissura.parts = { view: await fissura.started(data.scene) };
};

fissura.ready = fissura.data().then((data) => fissura[data.kind](data)).then(() => {
  document.documentElement.dataset.ready = "yes";
});
