// What the page needs functions for: isotherms that are dragged, and access without a mouse.
document.documentElement.lang = "en";
window.elastomdr = (() => {
  // Makes a chart as wide as its place, and its isotherms follow the pointer where they may be dragged
  function ready(id, dragged) {
    const chart = document.getElementById(`c${id}`);
    const { Plotly } = getElement(id) ?? {};
    if (!Plotly || !chart?._fullLayout?.xaxis) {
      if (chart) setTimeout(() => ready(id, dragged), 50);
      return;
    }
    if (chart.ready) return;
    chart.ready = true;
    // not NiceGUI's way, which asks plotly for charts that are hidden as well: an error
    new ResizeObserver(() => chart.offsetParent && Plotly.Plots.resize(chart)).observe(chart);
    if (dragged) drag(chart, Plotly);
  }

  // Lets an isotherm of a master curve be dragged along its axis; the server hears of it as it moves and at the end
  function drag(chart, Plotly) {
    const isIsotherm = ({ mode, name }) => mode === "markers" && / °C$/.test(name);
    let held = null;
    let told = 0;

    // The places of the pointer and of a point, in pixels from the corner of the axes
    function pointer({ clientX, clientY }) {
      const { left, top } = chart.getBoundingClientRect();
      const { xaxis, yaxis } = chart._fullLayout;
      return [clientX - left - xaxis._offset, clientY - top - yaxis._offset];
    }

    // The isotherm with a point within a few pixels
    function near(event) {
      const [left, top] = pointer(event);
      const { xaxis, yaxis } = chart._fullLayout;
      let [name, least] = [null, 12];
      for (const trace of chart.data.filter(isIsotherm))
        trace.x.forEach((x, i) => {
          const distance = Math.hypot(xaxis.d2p(x) - left, yaxis.d2p(trace.y[i]) - top);
          if (distance < least) [name, least] = [trace.name, distance];
        });
      return name;
    }
    const place = (event) => Math.log10(chart._fullLayout.xaxis.p2d(pointer(event)[0]));
    const tell = (end) => emitEvent("isotherm", { name: held.name, decades: held.decades, end });

    // before plotly hears of it, which draws a box to zoom into
    const begin = (event) => {
      const name = near(event);
      if (!name) return;
      event.stopPropagation();
      event.preventDefault();
      const traces = chart.data.flatMap((trace, i) => (isIsotherm(trace) && trace.name === name ? [i] : []));
      held = { name, start: place(event), decades: 0, traces, x: traces.map((i) => chart.data[i].x) };
    };
    const move = (event) => {
      if (!held) return;
      held.decades = place(event) - held.start;
      Plotly.restyle(chart, { x: held.x.map((all) => all.map((x) => x * 10 ** held.decades)) }, held.traces);
      if (Date.now() - told < 100) return;
      told = Date.now();
      tell(false);
    };
    const release = () => {
      if (held?.decades) tell(true);
      held = null;
    };
    chart.addEventListener("mousedown", begin, true);
    addEventListener("mousemove", move);
    addEventListener("mouseup", release);
  }

  // Scrolls to what is wrong, once it is there
  const look = (id) => setTimeout(() => getHtmlElement(id)?.scrollIntoView({ block: "center" }), 300);

  // Each screen is a step of the browser's history
  const at = (screen) => history.state?.screen === screen || history.pushState({ screen }, "");
  addEventListener("popstate", ({ state }) => state?.screen && emitEvent("screen", state.screen));

  return { ready, look, at };
})();

// Quasar's loading bar has no name, and it has the field of an uploader within a button, which screen readers cannot tell; the field alone is one
new MutationObserver(() => {
  document.querySelector(".q-loading-bar:not([aria-label])")?.setAttribute("aria-label", "Loading");
  for (const input of document.querySelectorAll(".q-uploader__input:not([aria-label])")) {
    const uploader = input.closest(".q-uploader");
    input.setAttribute("aria-label", uploader.getAttribute("aria-label"));
    input.tabIndex = 0;
    const button = input.closest("a");
    button.removeAttribute("role");
    button.removeAttribute("tabindex");
  }
}).observe(document, { childList: true, subtree: true });
