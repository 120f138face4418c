/* What is seen of a scan: a slice with its walls, histogram, void ratio by the threshold, edge response and scanner. */
const scans = (function () {
  'use strict';
  const {add, known, number, quantity, size, table, chart, map, zip, span, again} = tosui;
  const wall = {line: '#ff7a00', lineWidth: 1.5};

  /* A slice as a map `m` with `distance` to its walls, which can be switched off. */
  function slice(parent, title, caption, m) {
    Object.assign(m, wall, {palette: 'grey'});
    const figure = map(parent, title, caption, m);
    const box = add(add(figure.querySelector('.tools'), 'label'), 'input', {type: 'checkbox', checked: ''});
    box.after(' walls');
    box.addEventListener('change', () => {
      m.line = box.checked ? wall.line : null;
      again();
    });
  }

  /* Both charts of `curves`, each {name, threshold, counts, void_ratio}; marks: {threshold, otsu, pore, grain, measured}. */
  function greys(histogram, calibration, curves, marks, most) {
    const grey = {colour: '--soft'}, threshold = {x: marks.threshold, name: 'threshold', colour: '--c1'};
    const {threshold: t, counts} = curves[0], all = counts.reduce((sum, n) => sum + n, 0);
    let above = all; /* a few bright voxels would take half of the axis */
    const last = t.find((_, i) => (above -= counts[i]) < 0.002 * all) || t[t.length - 1];
    chart(histogram, 'Histogram of grey values', 'Grey value', 'Voxels (of the most)',
          curves.map(c => ({name: c.name, points: zip(t, c.counts.map(n => n / Math.max(...c.counts)))})),
          {lines: [threshold, {x: marks.otsu, name: 'Otsu', ...grey}, {x: marks.pore, name: 'pore', ...grey},
                   {x: marks.grain, name: 'grain', ...grey}].filter(l => known(l.x)),
           dygraph: {includeZero: true, dateWindow: [t[0], t[0] + 1.05 * (last - t[0])]}});
    chart(calibration, 'Void ratio by the threshold', 'Grey threshold', 'Void ratio (-)',
          curves.map(c => ({name: c.name, points: zip(t, c.void_ratio).filter(p => known(p[1]) && p[1] < most)})),
          {lines: [threshold, known(marks.measured) && {y: marks.measured, name: 'measured'}].filter(l => l), dygraph: {includeZero: true}});
    return at => {
      threshold.x = at;
      again();
    };
  }

  /* Grey against the distance from walls (m), with a Gaussian of `blur` (m) less `fringe` times its curvature. */
  function edge(parent, distance, response, blur, fringe) {
    const bell = u => Math.exp(-u * u / 2) / Math.sqrt(2 * Math.PI);
    /* The normal integral by Abramowitz, Stegun 26.2.17. */
    const integral = u => {
      const w = 1 / (1 + 0.2316419 * Math.abs(u));
      const q = bell(u) * [1.330274429, -1.821255978, 1.781477937, -0.356563782, 0.31938153].reduce((sum, c) => (sum + c) * w, 0);
      return u > 0 ? 1 - q : q;
    };
    const points = zip(distance.map(d => 1e6 * d), response).filter(p => p[1] !== null);
    const model = d => integral(-d / blur) - fringe * d / blur * bell(d / blur);
    const misfit = shift => points.reduce((sum, [d, v]) => sum + Math.pow(model(1e-6 * d - shift) - v, 2), 0);
    const shift = span(misfit, -blur, blur, 80).reduce((best, p) => (p[1] < best[1] ? p : best))[0];
    chart(parent, 'Edge response', 'Distance from the wall, into the pore (µm)', 'Grey (0 pore, 1 grain)',
          [{name: 'scan', points: points, dots: true},
           {name: `Gaussian of ${number(1e6 * blur)} µm` + (fringe > 0 ? `, edge enhancement ${number(fringe, 2)}` : ''), colour: 1,
            points: span(d => model(1e-6 * d - shift), points[0][0], points[points.length - 1][0], 120)}]);
  }

  /* Rows of a table: s of a scanner in metres, as a model's file names them. */
  const rows = (s, voxel) => [
    ['Blur (standard deviation)', quantity(1e6 * s.blur, 1.96e6 * s.blur_uncertainty, 'µm') + ` = ${number(s.blur / voxel)} voxels`],
    ['Resolution (10 % of the contrast remain)', size(s.resolution)], ['Contrast over noise', number(s.contrast_to_noise)],
    ['Noise, correlation length', size(s.noise_correlation)],
    known(s.fringe) && ['Edge enhancement (phase contrast)', number(s.fringe, 2)]];

  return {slice, greys, edge, rows};
})();
