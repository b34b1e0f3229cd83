import { create } from '../dom';

/** A table with a heading per row and per column; empty headings are plain corners. */
export function table(caption: string, head: readonly string[], rows: readonly (readonly string[])[]): HTMLTableElement {
  const cells = (row: readonly string[], header: boolean): HTMLTableRowElement => {
    const line = create('tr');
    row.forEach((text, k) => {
      const heads = text !== '' && (header || k === 0);
      const cell = create(heads ? 'th' : 'td', { textContent: text });
      if (heads) cell.setAttribute('scope', header ? 'col' : 'row');
      line.append(cell);
    });
    return line;
  };
  return create(
    'table',
    {},
    create('caption', { textContent: caption }),
    create('thead', {}, cells(head, true)),
    create('tbody', {}, ...rows.map((row) => cells(row, false))),
  );
}
