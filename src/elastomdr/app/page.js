// What the page needs functions for: charts, whose options name them (chart.py), and access without a mouse.
document.documentElement.lang = "en";
window.elastomdr = (() => {
  const raised = (power) => [...String(power)].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit] ?? "⁻").join("");

  // A number of so many digits, as a text
  function number(value, digits = 4) {
    if (value === null || value === undefined || Number.isNaN(value)) return "";
    const size = Math.abs(value);
    if (size === 0 || (size >= 1e-3 && size < 1e5)) return String(Number(value.toPrecision(digits)));
    const [factor, power] = value.toExponential(digits - 1).split("e");
    const short = Number(factor);
    return (short === 1 ? "10" : `${short}·10`) + raised(Number(power));
  }

  // The label of a tick on a logarithmic axis
  function tick(value) {
    const power = Math.log10(Math.abs(value));
    return Number.isInteger(power) && (power < -2 || power > 3) ? "10" + raised(power) : number(value, 3);
  }

  // The band of a curve, or a bar: one polygon of all points of the series
  const polygon = (opacity) => (params, api) => {
    if (params.dataIndexInside > 0) return;
    const points = [];
    for (let i = 0; i < params.dataInsideLength; i++) points.push(api.coord([api.value(0, i), api.value(1, i)]));
    return {
      type: "polygon",
      silent: true,
      shape: { points },
      style: { fill: api.visual("color"), opacity },
    };
  };

  const escaped = (text) => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;");

  // What is said of the points at the pointer: x once, then each curve with its value and band
  const said = (x, y) => (params) => {
    const all = (Array.isArray(params) ? params : [params]).filter((each) => each.value && each.value[1] !== null);
    if (!all.length) return "";
    const rows = new Map();
    for (const { marker, seriesName, value } of all) {
      const band = value.length > 3 ? ` (${number(value[2], 3)} to ${number(value[3], 3)})` : "";
      const row = `${marker} ${escaped(seriesName)}: <b>${number(value[1])}</b>${band}`;
      if (!rows.has(seriesName) || value.length > 3) rows.set(seriesName, row);
    }
    return [`${escaped(x)}: <b>${number(all[0].value[0])}</b>`, escaped(y), ...rows.values()].join("<br>");
  };

  // Places of the labels on a logarithmic axis: decades, of few decades 1, 2 and 5 as well
  function places(low, high) {
    const decades = Math.log10(high / low);
    const step = Math.max(1, Math.ceil(decades / 7));
    const factors = decades < 0.8 ? [1, 1.5, 2, 3, 4, 5, 6, 8] : decades < 3 ? [1, 2, 5] : [1];
    const found = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++)
      if (power % step === 0) found.push(...factors.map((factor) => Number(`${factor}e${power}`)));
    return found.filter((value) => value >= low && value <= high);
  }

  // Labels logarithmic axes, now and whenever the chart is zoomed; ECharts has whole decades only
  function label(id) {
    const chart = getElement(id)?.chart;
    if (!chart?.getOption()?.series) {
      if (document.getElementById(`c${id}`)) setTimeout(() => label(id), 50);
      return;
    }
    const set = () => {
      const axes = {};
      for (const name of ["xAxis", "yAxis"]) {
        const axis = chart.getModel().getComponent(name).axis;
        if (axis.type !== "log") continue;
        const customValues = places(...axis.scale.getExtent());
        axes[name] = {
          axisLabel: { customValues, showMinLabel: true, showMaxLabel: true },
          axisTick: { customValues },
          splitLine: { customValues },
        };
      }
      chart.setOption(axes);
    };
    set();
    if (chart.labelled) return;
    chart.labelled = true;
    for (const event of ["datazoom", "restore"]) chart.on(event, set);
  }

  // Lets an isotherm of a master curve be dragged along its axis; the server hears of it as it moves and at the end
  function drag(id) {
    const chart = getElement(id)?.chart;
    if (!chart?.getOption()?.series) {
      if (document.getElementById(`c${id}`)) setTimeout(() => drag(id), 50);
      return;
    }
    if (chart.draggable) return;
    chart.draggable = true;
    const zr = chart.getZr();
    const axes = { xAxisIndex: 0, yAxisIndex: 0 };
    const isIsotherm = ({ type, name }) => type === "scatter" && / °C$/.test(name);
    let held = null;
    let told = 0;

    // The isotherm with a point within a few pixels
    function near({ offsetX, offsetY }) {
      let [name, least] = [null, 12];
      for (const series of chart.getOption().series.filter(isIsotherm))
        for (const point of series.data) {
          const [x, y] = chart.convertToPixel(axes, point);
          const distance = Math.hypot(x - offsetX, y - offsetY);
          if (distance < least) [name, least] = [series.name, distance];
        }
      return name;
    }
    const place = (event) => Math.log10(chart.convertFromPixel(axes, [event.offsetX, event.offsetY])[0]);
    const tell = (end) => emitEvent("isotherm", { name: held.name, decades: held.decades, end });

    zr.on("mousedown", (event) => {
      const name = near(event);
      if (name) held = { name, start: place(event), decades: 0, series: chart.getOption().series };
    });
    zr.on("mousemove", (event) => {
      if (!held) return void zr.setCursorStyle(near(event) ? "ew-resize" : "default");
      held.decades = place(event) - held.start;
      const moved = ([x, ...rest]) => [x * 10 ** held.decades, ...rest];
      const isHeld = (series) => isIsotherm(series) && series.name === held.name;
      chart.setOption({ series: held.series.map((each) => (isHeld(each) ? { data: each.data.map(moved) } : {})) });
      if (Date.now() - told < 100) return;
      told = Date.now();
      tell(false);
    });
    const release = () => {
      if (held?.decades) tell(true);
      held = null;
    };
    zr.on("mouseup", release);
    zr.on("globalout", release);
  }

  return { tick, polygon, said, label, drag };
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
