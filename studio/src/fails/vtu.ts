// The surface as a VTK file (ASCII), for other programs; the whole body lies in the run folder.
import {quantitiesOf, type Surface} from './surface';

function data(name: string, components: number, values: ArrayLike<number>, type = 'Float32'): string {
  const list = Array.from(values, (v) => (Number.isFinite(v) ? v : 'nan')).join(' ');
  return `<DataArray type="${type}" Name="${name}" NumberOfComponents="${components}" format="ascii">${list}</DataArray>\n`;
}

export function surfaceVtu(s: Surface): string {
  const nodes = s.rest.length / 3;
  const cells = s.triangles.length / 3;
  return `<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="${nodes}" NumberOfCells="${cells}">
<Points>
${data('Points', 3, s.rest)}</Points>
<Cells>
${data('connectivity', 1, s.triangles, 'Int32')}${data('offsets', 1, Array.from({length: cells}, (_, i) => 3 * (i + 1)), 'Int32')}${data('types', 1, new Array(cells).fill(5), 'UInt8')}</Cells>
<PointData>
${data('displacement', 3, s.displacement)}${quantitiesOf(s)
    .filter((q) => q !== 'displacement')
    .map((q) => data(q, 1, s.scalars[q]))
    .join('')}</PointData>
</Piece></UnstructuredGrid></VTKFile>
`;
}
