// Files of figures: CSV, and canvases and SVG as PNG (pictures.ts puts letters to them).
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
/** An SVG figure as pixels, with the colours it has on the page. */
export async function drawnSvg(svg: SVGSVGElement): Promise<HTMLCanvasElement> {
  const copy = svg.cloneNode(true) as SVGSVGElement;
  const from = [svg, ...svg.querySelectorAll('*')];
  const to = [copy, ...copy.querySelectorAll('*')];
  from.forEach((node, i) => {
    const style = getComputedStyle(node);
    // Attributes, not styles: a picture may be under the page's policy, which allows no inline style.
    for (const key of ['fill', 'stroke', 'stroke-width', 'font-family', 'font-size', 'font-weight', 'opacity'])
      to[i].setAttribute(key, style.getPropertyValue(key));
  });
  const box = svg.getBoundingClientRect();
  copy.setAttribute('width', String(box.width));
  copy.setAttribute('height', String(box.height));
  const image = new Image();
  image.src =
    'data:image/svg+xml;charset=utf-8,' +
    encodeURIComponent(new XMLSerializer().serializeToString(copy));
  await image.decode();
  const canvas = document.createElement('canvas');
  canvas.width = 2 * box.width;
  canvas.height = 2 * box.height;
  const context = canvas.getContext('2d')!;
  context.fillStyle = getComputedStyle(document.body).backgroundColor;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  return canvas;
}
