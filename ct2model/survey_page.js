/* Fills survey_page.html from the JSON in it. A slider moves the threshold: in the slice, whose wall is drawn anew, in the
 * histogram and along the curve of the void ratio. */
(function () {
  'use strict';
  const {data, by, add, known, number, percent, quantity, size, table, note, tools, map, again, start} = tosui;
  const slices = data.pictures.slices, sweep = data.sweep, t = sweep.threshold, voxel = data.voxel_size_m, low = t[0], high = t[t.length - 1];
  const length = n => (voxel ? size(n * voxel[0]) : `${n} voxels`);
  const measured = data.void_ratio_measured, begin = data.threshold_original, side = data.dark_grains ? -1 : 1;

  /* The void ratio at a threshold, linear between the rows of the curve. */
  function voidRatio(at) {
    const i = Math.min(Math.max(t.findIndex(v => v >= at), 1), t.length - 1), part = Math.min(Math.max((at - t[i - 1]) / (t[i] - t[i - 1]), 0), 1);
    const [a, b] = [sweep.void_ratio[i - 1], sweep.void_ratio[i]];
    return known(a) && known(b) ? a + part * (b - a) : NaN;
  }

  /* The word of a shell that stands for a text. */
  const quoted = text => (/^[\w./,+:=@%-]+$/.test(text) ? text : `'${text.replace(/'/g, '\'\\\'\'')}'`);
  /* This command as one that builds a model. */
  function command(at) {
    const words = ['ct2model', 'build', ...data.inputs], given = name => new RegExp(`--${name}[ =]('[^']*'|\\S+)`).exec(data.command_line);
    const error = data.void_ratio_measured_uncertainty;
    if (known(measured)) words.push('--void-ratio', measured + (known(error) ? '+-' + error : ''));
    if (!known(measured) || Math.abs(at - begin) > 0.002 * (high - low)) words.push('--threshold', String(Number(at.toPrecision(4))));
    ['voxel-size', 'raw', 'crop', 'roi', 'grain', 'denoise', 'correct', 'axis', 'scale-peak'].forEach(name => {
      const value = given(name);
      if (value) words.push(`--${name}`, value[1].replace(/^'|'$/g, ''));
    });
    return [...words, '-o', 'model.hdf'].map(quoted).join(' ');
  }

  const m = {size: slices.size, spacing: voxel ? voxel[0] : 1, low: low, high: high, axes: voxel ? 'x across, y down' : ''};
  const greys = slices.grey.map(f => pictures.upright(f, slices.size)), number_of = by('number'), slider = by('threshold'), value = by('value'), height = by('height');
  let move, waits = false;

  /* What depends on the sliders; once for each picture of the screen. */
  function show() {
    waits = false;
    const at = Number(slider.value), e = voidRatio(at), grey = greys[Number(height.value)];
    m.value = grey;
    m.distance = grey.map(v => side * (at - v) / (high - low) * 10);
    by('state').replaceChildren(`Void ratio ${known(e) ? number(e) : 'not defined'}`,
      add(null, 'span', {class: 'interval'}, (known(e) ? `, porosity ${number(e / (1 + e))}` : '') + `, at threshold ${number(at)}` +
        (known(measured) ? `; measured: ${quantity(measured, data.void_ratio_measured_uncertainty || 0, '').trim()}` : '')));
    number_of.textContent = slices.number[Number(height.value)];
    if (!data.labels) by('command').textContent = command(at);
    move(at);
  }
  const later = () => {
    if (!waits) requestAnimationFrame(show);
    waits = true;
  };
  function set(at) {
    slider.value = at;
    value.value = Number(Number(slider.value).toPrecision(4));
    later();
  }

  function controls() {
    Object.assign(slider, {min: low, max: high, step: 'any'});
    height.max = greys.length - 1;
    height.value = Math.floor(greys.length / 2);
    if (greys.length < 2) by('heights').remove();
    slider.addEventListener('input', () => set(slider.value));
    value.addEventListener('change', () => set(value.value));
    height.addEventListener('input', later);
    [[known(measured) ? 'Measured void ratio' : '', begin], ['Otsu', data.threshold_otsu], ['Least between the peaks', data.threshold_valley]].forEach(([name, at]) => {
      if (name && known(at)) add(by('marks'), 'button', {type: 'button'}, name).addEventListener('click', () => set(at));
    });
  }

  function facts() {
    const n = data.size_original, s = data.scanner, beam = data.beam_hardening;
    table(by('facts'), [
      ['Voxels', n.join(' × ')], ['Size', voxel && n.map((k, d) => size(k * voxel[d])).join(' × ')],
      ['Voxel', voxel ? size(voxel[2]) : 'not known'],
      ['Void ratio, measured on the specimen', known(measured) && quantity(measured, data.void_ratio_measured_uncertainty || 0, '').trim()],
      known(measured) && ['Threshold that gives it', quantity(begin, data.threshold_uncertainty || 0, '').trim()],
      ['Otsu\u2019s threshold', known(data.threshold_otsu) && `${number(data.threshold_otsu)}: void ratio ${number(voidRatio(data.threshold_otsu))}`],
      ['Peaks of pore and grain', known(data.pore_peak) && `${number(data.pore_peak)} and ${number(data.grain_peak)}`],
      ['Specific surface', known(data.specific_surface_per_m) && number(1e-3 * data.specific_surface_per_m) + ' 1/mm of bulk volume'],
      ['Grain, from the middle to the rim', known(beam) && `${number(100 * beam, 2)} % of the contrast (beam hardening)`],
      ['Rings', known(data.rings) && `${number(100 * data.rings, 2)} % of the contrast`],
      ...(s && known(s.blur_m) ? scans.rows({blur: s.blur_m, blur_uncertainty: s.blur_uncertainty_m, resolution: s.resolution_m, fringe: s.fringe,
                                            contrast_to_noise: s.contrast_to_noise, noise_correlation: s.noise_correlation_m}, voxel[0]) : [])],
          'What was found');
    if (data.labels)
      table(by('labels'), data.labels.map(l => [String(l.label), percent(l.fraction)]), 'An image of labels: how much each fills', ['Label', 'Volume']);
    if (data.edge) scans.edge(by('edge'), data.edge.distance_m, data.edge.response, s.blur_m, s.fringe || 0);
    const whole = data.pictures.whole;
    if (whole)
      map(by('whole'), 'The whole slice', `The middle slice in its whole width, each ${whole.every}th voxel; above, its middle ${slices.size.join(' × ')} voxels.`,
          {size: whole.size, spacing: m.spacing * whole.every, value: upright(whole.grey, whole.size), low: low, high: high, palette: 'grey', axes: m.axes});
  }

  function words() {
    const name = data.inputs[0].replace(/\/+$/, '').replace(/.*\//, '');
    document.title = `${name} - survey of a scan`;
    by('title').textContent = name;
    by('subtitle').append(`Survey of a scan of ${data.size_original.join(' × ')} voxels` + (voxel ? ` of ${size(voxel[2])}` : '') + ', before a model is made.');
    by('advice').append(data.labels ? 'The image holds labels, not greys: build it with --segmented, which says what is pore.' :
      known(measured) ? 'The threshold is to give the void ratio that was measured on the specimen; its wall is to lie on the edges of the grains in every slice. Then:' :
      'No void ratio was given: measure it on the specimen if you can, as a threshold chosen by eye changes k by more than anything else. Then:');
    if (data.labels) by('command').remove();
    by('made').append(`Made by ct2model of Tosui ${data.version} with `, add(null, 'code', {}, data.command_line), '. Curves: dygraphs (MIT licence).');
  }

  controls();
  scans.slice(by('slice'), 'Slice', `Grey values of the scan, and the wall at the threshold (orange): ${slices.size.join(' × ')} voxels, ` +
              `${slices.size.map(length).join(' × ')}`, m);
  move = scans.greys(by('histogram'), by('curve'), [{name: 'scan', threshold: t, counts: sweep.histogram, void_ratio: sweep.void_ratio}],
                     {threshold: begin, otsu: data.threshold_otsu, pore: data.pore_peak, grain: data.grain_peak, measured: measured},
                     3 * (known(measured) ? measured : Math.max(voidRatio(begin), 0.3)));
  facts();
  words();
  document.querySelectorAll('figure:empty, .charts:empty, .pair > div:empty, .columns > div:empty').forEach(e => e.remove());
  m.value = greys[Number(height.value)];
  m.distance = m.value;
  start();
  set(begin);
})();
