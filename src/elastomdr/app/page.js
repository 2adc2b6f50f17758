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

  return { tick, polygon, said, label };
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
