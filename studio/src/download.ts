// PNG and CSV of every figure.
export function save(name: string, content: Blob): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
export function saveText(name: string, text: string, type = 'text/plain'): void {
  save(name, new Blob([text], {type}));
}
function cell(value: unknown): string {
  const text = value === null || value === undefined ? '' : String(value);
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
export function saveCsv(name: string, rows: unknown[][]): void {
  saveText(name, rows.map((row) => row.map(cell).join(',')).join('\n') + '\n', 'text/csv');
}
export function saveCanvas(name: string, canvas: HTMLCanvasElement): void {
  canvas.toBlob((blob) => blob && save(name, blob), 'image/png');
}
export function saveSideBySide(name: string, canvases: HTMLCanvasElement[]): void {
  const all = document.createElement('canvas');
  all.width = canvases.reduce((w, c) => w + c.width, 0);
  all.height = Math.max(1, ...canvases.map((c) => c.height));
  const context = all.getContext('2d')!;
  let left = 0;
  for (const canvas of canvases) {
    if (canvas.width && canvas.height) context.drawImage(canvas, left, 0);
    left += canvas.width;
  }
  saveCanvas(name, all);
}

/** A canvas at twice the size of `width` x `height`, with the page's colours and its letters. */
function sheet(width: number, height: number): {canvas: HTMLCanvasElement; context: CanvasRenderingContext2D; ink: string} {
  const canvas = document.createElement('canvas');
  canvas.width = 2 * width;
  canvas.height = 2 * height;
  const context = canvas.getContext('2d')!;
  const style = getComputedStyle(document.body);
  context.scale(2, 2);
  context.fillStyle = style.backgroundColor;
  context.fillRect(0, 0, width, height);
  context.font = `13px ${style.fontFamily}`;
  context.textBaseline = 'middle';
  const ink = style.color;
  context.fillStyle = ink;
  return {canvas, context, ink};
}

/** Horizontal bars; `mark` is a line across them. */
export function saveBars(name: string, title: string, rows: {name: string; value: number}[], mark?: number): void {
  const {canvas, context, ink} = sheet(480, 34 + 22 * rows.length);
  const style = getComputedStyle(document.body);
  const most = Math.max(mark ?? 0, ...rows.map((r) => r.value || 0), 1e-12);
  context.fillText(title, 10, 15);
  rows.forEach((row, i) => {
    const y = 40 + 22 * i;
    context.fillStyle = ink;
    context.fillText(row.name, 10, y, 120);
    context.fillText(Number.isFinite(row.value) ? row.value.toPrecision(3) : '–', 425, y);
    context.fillStyle = style.getPropertyValue('--bar');
    context.fillRect(140, y - 6, (270 * Math.max(0, row.value || 0)) / most, 12);
    context.fillStyle = style.getPropertyValue('--mark');
    if (mark !== undefined) context.fillRect(140 + (270 * mark) / most, y - 9, 2, 18);
  });
  saveCanvas(name, canvas);
}

/** A chart with its title above and what its lines are below. */
export function saveChart(name: string, title: string, chart: HTMLCanvasElement,
                          lines: {label: string; colour: string}[]): void {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [chart.width / ratio, chart.height / ratio];
  const {canvas, context, ink} = sheet(width, height + 34 + 20 * lines.length);
  context.fillText(title, 10, 15);
  context.drawImage(chart, 0, 26, width, height);
  lines.forEach((line, i) => {
    const y = height + 40 + 20 * i;
    context.fillStyle = line.colour;
    context.fillRect(20, y - 2, 24, 4);
    context.fillStyle = ink;
    context.fillText(line.label, 52, y);
  });
  saveCanvas(name, canvas);
}

/** An SVG figure as PNG, with the colours it has on the page. */
export function saveSvg(name: string, svg: SVGSVGElement): void {
  const copy = svg.cloneNode(true) as SVGSVGElement;
  const from = [svg, ...svg.querySelectorAll('*')];
  const to = [copy, ...copy.querySelectorAll('*')];
  from.forEach((node, i) => {
    const style = getComputedStyle(node);
    for (const key of ['fill', 'stroke', 'stroke-width', 'font', 'opacity'])
      (to[i] as SVGElement).style.setProperty(key, style.getPropertyValue(key));
  });
  const box = svg.getBoundingClientRect();
  copy.setAttribute('width', String(box.width));
  copy.setAttribute('height', String(box.height));
  const image = new Image();
  image.onload = () => {
    const canvas = document.createElement('canvas');
    canvas.width = 2 * box.width;
    canvas.height = 2 * box.height;
    const context = canvas.getContext('2d')!;
    context.fillStyle = getComputedStyle(document.body).backgroundColor;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(image, 0, 0, canvas.width, canvas.height);
    saveCanvas(name, canvas);
  };
  image.src =
    'data:image/svg+xml;charset=utf-8,' +
    encodeURIComponent(new XMLSerializer().serializeToString(copy));
}
