/* Pictures from the fields in a page's JSON: maps of planes on a canvas.
 * A field is {low, high, bytes}: a byte a value, 0 at low, 254 at high, 255 for none. */
const pictures = (function () {
  'use strict';
  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const field = f => f && Float32Array.from(bytes(f.bytes), b => (b === 255 ? NaN : f.low + b / 254 * (f.high - f.low)));
  /* The first row of a file is at the top, as in Fiji; maps have theirs at the bottom. */
  function upright(f, [nx, ny]) {
    const greys = field(f), turned = greys && new Float32Array(greys.length);
    for (let y = 0; greys && y < ny; y++) turned.set(greys.subarray(y * nx, (y + 1) * nx), (ny - 1 - y) * nx);
    return turned;
  }
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  /* Dark blue over green to yellow (after viridis), blue over white to red, dry to wet, and grey. */
  const palettes = {
    speed: ['#440154', '#472c7a', '#3b518b', '#2c718e', '#21908d', '#27ad81', '#5cc863', '#aadc32', '#fde725'],
    pressure: ['#053061', '#2e79b5', '#78b2d5', '#c8dfee', '#f7f7f7', '#fad4c1', '#eb9171', '#c13d3e', '#670020'],
    water: ['#d6e6f4', '#abcfe5', '#6aaed6', '#3787c0', '#105ba4', '#08306b'],
    saturation: ['#f2e3c6', '#dcd9b8', '#a9cdbb', '#6aaed6', '#2f79b5', '#08306b'],
    grey: ['#000000', '#ffffff']
  };
  const rgb = hex => [1, 3, 5].map(i => parseInt(hex.substr(i, 2), 16));
  function colours(name) {
    const stops = palettes[name].map(rgb), table = new Uint8Array(3 * 256);
    for (let i = 0; i < 256; i++) {
      const s = i / 255 * (stops.length - 1), k = Math.min(Math.floor(s), stops.length - 2);
      for (let c = 0; c < 3; c++) table[3 * i + c] = stops[k][c] + (s - k) * (stops[k + 1][c] - stops[k][c]);
    }
    return table;
  }

  const clamp = (v, n) => Math.min(Math.max(v, 0), n - 1);
  /* Bilinear and cubic (Catmull, Rom 1974) value at a point; for outlines the latter. */
  function linear(f, size, x, y, step, offset) {
    x = clamp(x, size[0]);
    y = clamp(y, size[1]);
    const i = Math.floor(x), j = Math.floor(y), a = Math.min(i + 1, size[0] - 1), b = Math.min(j + 1, size[1] - 1);
    const at = (k, l) => f[step * (l * size[0] + k) + offset], p = x - i, q = y - j;
    return (1 - q) * ((1 - p) * at(i, j) + p * at(a, j)) + q * ((1 - p) * at(i, b) + p * at(a, b));
  }
  const catmull = (t, k) => (k === 0 ? 0.5 * t * (-1 + t * (2 - t)) : k === 1 ? 0.5 * (2 + t * t * (-5 + 3 * t)) :
    k === 2 ? 0.5 * t * (1 + t * (4 - 3 * t)) : 0.5 * t * t * (t - 1));
  function cubic(f, size, x, y) {
    x = clamp(x, size[0]);
    y = clamp(y, size[1]);
    const i = Math.floor(x), j = Math.floor(y);
    let value = 0;
    for (let l = 0; l < 4; l++) {
      const row = clamp(j + l - 1, size[1]) * size[0], v = catmull(y - j, l);
      for (let k = 0; k < 4; k++) value += catmull(x - i, k) * v * f[row + clamp(i + k - 1, size[0])];
    }
    return value;
  }

  /* A field with what two rounds of means of the four neighbours put where it has no value: interpolation near walls needs it. */
  function spread(f, size) {
    for (let round = 0; f && round < 2; round++) {
      const old = f.slice();
      old.forEach((v, i) => {
        const x = i % size[0];
        const near = [x > 0 ? old[i - 1] : NaN, x + 1 < size[0] ? old[i + 1] : NaN, old[i - size[0]], old[i + size[0]]].filter(n => n === n && n !== undefined);
        if (v !== v && near.length > 0) f[i] = near.reduce((sum, n) => sum + n, 0) / near.length;
      });
    }
    return f;
  }

  /* The lines f = 0 of a plane, by marching squares on cells of so many pixels. */
  function outline(context, m, scale, width, height) {
    const cell = 3, row = [], corner = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]];
    const at = (x, y) => cubic(m.distance, m.size, x / scale - 0.5, (height - y) / scale - 0.5);
    context.beginPath();
    for (let y = 0; y < height; y += cell)
      for (let x = 0, n = 0; x < width; x += cell, n++) {
        const above = row[n] === undefined || y === 0 ? at(x, y) : row[n];
        const next = row[n + 1] === undefined || y === 0 ? at(x + cell, y) : row[n + 1];
        const v = [above, next, at(x + cell, y + cell), n === 0 ? at(x, y + cell) : row.last, above], cross = [];
        for (let k = 0; k < 4; k++) {
          if ((v[k] > 0) === (v[k + 1] > 0)) continue;
          const t = v[k] / (v[k] - v[k + 1]);
          cross.push([0, 1].map(d => corner[k][d] + t * (corner[k + 1][d] - corner[k][d])));
        }
        for (let k = 0; k + 1 < cross.length; k += 2) {
          context.moveTo(x + cell * cross[k][0], y + cell * cross[k][1]);
          context.lineTo(x + cell * cross[k + 1][0], y + cell * cross[k + 1][1]);
        }
        row[n] = v[3];
        row.last = v[2];
        if (x + cell >= width) row[n + 1] = v[2];
      }
    context.stroke();
  }

  /* Evenly spaced streamlines in a plane (Jobard, Lefer 1997): a line ends where it would come too close to another one. */
  function streamlines(context, m, scale, width, height) {
    const apart = 12, step = 2, cells = [width, height].map(n => Math.ceil(2 * n / apart) + 1), owner = new Int32Array(cells[0] * cells[1]);
    const cell = (x, y) => clamp(Math.floor(2 * y / apart), cells[1]) * cells[0] + clamp(Math.floor(2 * x / apart), cells[0]);
    const direction = (x, y) => {
      const i = x / scale - 0.5, j = (height - y) / scale - 0.5;
      if (x < 0 || y < 0 || x > width || y > height || linear(m.distance, m.size, i, j, 1, 0) < 0.1) return null;
      const v = [0, 1].map(c => linear(m.direction, m.size, i, j, 2, c)), speed = Math.hypot(v[0], v[1]);
      return speed > 0.01 ? [v[0] / speed, -v[1] / speed] : null;
    };
    const crowded = (x, y, line) => {
      for (let k = 0; k < 9; k++) {
        const other = owner[cell(x + (k % 3 - 1) * apart / 2, y + (Math.floor(k / 3) - 1) * apart / 2)];
        if (other !== 0 && other !== line) return true;
      }
      return false;
    };
    const trace = (x, y, sign, line) => {
      const points = [];
      for (let v = direction(x, y); v && points.length < 400 && !crowded(x, y, line); v = direction(x, y)) {
        points.push([x, y]);
        const middle = direction(x + sign * step / 2 * v[0], y + sign * step / 2 * v[1]);
        if (!middle) break;
        x += sign * step * middle[0];
        y += sign * step * middle[1];
      }
      return points;
    };
    context.beginPath();
    for (let y = 0, line = 1; y < height; y += 0.6 * apart)
      for (let x = 0; x < width; x += 0.6 * apart, line++) {
        const points = trace(x, y, -1, line).reverse().concat(trace(x, y, 1, line).slice(1));
        if (points.length * step < 26) continue;
        points.forEach((p, i) => {
          owner[cell(p[0], p[1])] = line;
          if (i === 0) context.moveTo(p[0], p[1]);
          else context.lineTo(p[0], p[1]);
        });
        const tip = points[(points.length >> 1) + 1], tail = points[points.length >> 1]; /* an arrow */
        if (!tip || points.length < 20) continue;
        const a = 2 * (tip[0] - tail[0]), b = 2 * (tip[1] - tail[1]);
        context.moveTo(tip[0] - a + 0.6 * b, tip[1] - b - 0.6 * a);
        context.lineTo(tip[0], tip[1]);
        context.lineTo(tip[0] - a - 0.6 * b, tip[1] - b + 0.6 * a);
      }
    context.stroke();
  }

  /* For each of n pixels: the two points beside it, the share of the second, and the nearest. */
  function between(n, size, mirrored) {
    const low = new Int32Array(n), high = new Int32Array(n), part = new Float32Array(n), nearest = new Int32Array(n);
    for (let i = 0; i < n; i++) {
      const x = clamp(((mirrored ? n - i - 1 : i) + 0.5) * size / n - 0.5, size);
      low[i] = Math.floor(x);
      high[i] = Math.min(low[i] + 1, size - 1);
      part[i] = x - low[i];
      nearest[i] = Math.round(x);
    }
    return {low: low, high: high, part: part, nearest: nearest};
  }

  /* Colours of the pixels of a map: its values, grains where the distance is negative, soil hatched, and kinds of cells. */
  function paint(context, m, width, height, ratio) {
    const w = Math.round(width * ratio), h = Math.round(height * ratio), nx = m.size[0], every = Math.round(7 * ratio);
    const image = context.createImageData(w, h), pixels = new Uint32Array(image.data.buffer);
    const packed = c => (0xff000000 | c[2] << 16 | c[1] << 8 | c[0]) >>> 0, table = colours(m.palette), shades = new Uint32Array(256);
    for (let i = 0; i < 256; i++) shades[i] = packed(table.subarray(3 * i, 3 * i + 3));
    const [grain, hatch, nothing, wall] = ['#d9d3c7', '#b08968', css('--card'), '#8a8378'].map(c => packed(rgb(c)));
    const across = between(w, nx, false), up = between(h, m.size[1], true);
    for (let j = 0; j < h; j++) {
      const a = up.low[j] * nx, b = up.high[j] * nx, q = up.part[j], line = up.nearest[j] * nx;
      for (let i = 0; i < w; i++) {
        const k = across.low[i], l = across.high[i], p = across.part[i], nearest = line + across.nearest[i];
        const at = f => (1 - q) * ((1 - p) * f[a + k] + p * f[a + l]) + q * ((1 - p) * f[b + k] + p * f[b + l]);
        const value = m.smooth ? at(m.value) : m.value[nearest], kind = m.kinds ? m.kinds[nearest] : 1;
        let inside = false;
        if (m.fillGrains) { /* near a wall as the outline has it */
          const d = at(m.distance);
          inside = Math.abs(d) > 0.7 ? d < 0 : cubic(m.distance, m.size, k + p, up.low[j] + q) <= 0;
        }
        pixels[j * w + i] = inside ? grain : kind === 3 ? wall : kind === 0 || value !== value ? (m.ground && m.ground[nearest] ? grain : nothing) :
          (m.soil ? m.soil[nearest] > 0.5 : kind === 2 && m.hatch) && (i + j) % every < ratio ? hatch :
          shades[Math.round(255 * Math.min(Math.max((value - m.low) / (m.high - m.low), 0), 1))];
      }
    }
    context.putImageData(image, 0, 0);
  }

  /* A length of 1, 2 or 5 times a power of ten of at most a third of the width. */
  function roundLength(metres) {
    const power = Math.pow(10, Math.floor(Math.log10(metres)));
    return power * (metres / power >= 5 ? 5 : metres / power >= 2 ? 2 : 1);
  }
  const length = metres => {
    const [scale, unit] = metres < 0.9995e-3 ? [1e6, 'µm'] : metres < 0.9995 ? [1e3, 'mm'] : [1, 'm'];
    return Number((scale * metres).toPrecision(3)) + ' ' + unit;
  };

  function scales(context, m, width, height) {
    context.fillStyle = css('--ink');
    context.font = '12px system-ui, sans-serif';
    if (m.axes) {
      const metres = roundLength(m.size[0] / 3 * m.spacing), long = metres / m.spacing * width / m.size[0];
      context.fillRect(0, height + 8, long, 3);
      context.fillText(length(metres), long + 6, height + 14);
      context.textAlign = 'right';
      context.fillText(m.axes, Math.max(width, 200), height + (width < 200 ? 30 : 14));
      context.textAlign = 'left';
    }
    if (!m.unit) return;
    const table = colours(m.palette), tall = Math.min(height, 260) - 24, x = width + 10;
    for (let i = 0; i < tall; i++) {
      const k = 3 * Math.round(255 * (1 - i / tall));
      context.fillStyle = `rgb(${table[k]},${table[k + 1]},${table[k + 2]})`;
      context.fillRect(x, 20 + i, 12, 1.5);
    }
    context.fillStyle = css('--ink');
    context.fillText(m.unit.name, x, 11);
    for (let i = 0; i <= 4; i++)
      context.fillText((m.open && i === 4 ? '≥ ' : '') + Number((m.unit.factor * (m.low + (m.high - m.low) * i / 4)).toPrecision(2)),
                       x + 17, 24 + tall * (1 - i / 4));
  }

  /* Draws a map on a canvas as wide as its place; `m`: size, spacing (m), value, low, high, palette, axes, and as they are
   * there distance, direction, soil, kinds, unit {name, factor}, line (colour of the walls). */
  function map(canvas, m) {
    const beside = m.unit ? 72 : 0, room = Math.min(canvas.parentNode.clientWidth || 480, m.most || 560) - beside;
    const width = Math.round(Math.min(room, Math.max(40, 620 * m.size[0] / m.size[1])));
    const height = Math.round(width * m.size[1] / m.size[0]), below = m.axes ? (width < 200 ? 34 : 20) : 0, ratio = Math.max(2, window.devicePixelRatio || 1);
    const whole = Math.max(width + beside, m.axes ? 200 : 0);
    canvas.width = whole * ratio;
    canvas.height = (height + below) * ratio;
    canvas.style.width = whole + 'px';
    const context = canvas.getContext('2d');
    context.fillStyle = css('--paper');
    context.fillRect(0, 0, canvas.width, canvas.height);
    paint(context, m, width, height, ratio);
    context.scale(ratio, ratio);
    context.save();
    context.rect(0, 0, width, height);
    context.clip();
    const scale = width / m.size[0];
    if (m.direction) {
      context.strokeStyle = 'rgba(255,255,255,0.8)';
      context.lineWidth = 1;
      streamlines(context, m, scale, width, height);
    }
    if (m.distance && m.line) {
      context.strokeStyle = m.line;
      context.lineWidth = m.lineWidth || 1.2;
      outline(context, m, scale, width, height);
    }
    context.restore();
    scales(context, m, width, height);
  }

  return {field, upright, spread, bytes, map};
})();
