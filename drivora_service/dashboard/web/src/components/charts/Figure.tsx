import { type ReactNode, useLayoutEffect, useRef, useState } from "react";
import { csvOf, type Numbers, pngOf, store, svgOf } from "./export";

export interface FigureProps {
  readonly title: string;
  /** Level of the title among the headings of the screen. */
  readonly level?: 2 | 3;
  /** One sentence that says what the figure shows. */
  readonly note?: ReactNode;
  /** Name of stored files, without an ending. */
  readonly file: string;
  readonly numbers: Numbers;
  /** Draws the figure in this many pixels of width. */
  readonly children: (width: number) => ReactNode;
}

/** A drawing with its title, its numbers as a table, and its files: SVG, PNG and CSV. */
export function Figure({ title, level = 3, note, file, numbers, children }: FigureProps) {
  const room = useRef<HTMLDivElement>(null);
  const [width, setWidth] = useState(0);
  useLayoutEffect(() => {
    const element = room.current;
    if (!element) return;
    const watch = new ResizeObserver(() => setWidth(Math.floor(element.clientWidth)));
    watch.observe(element);
    setWidth(Math.floor(element.clientWidth));
    return () => watch.disconnect();
  }, []);
  const drawing = () => room.current?.querySelector("svg");
  const files = {
    SVG: () => {
      const svg = drawing();
      if (svg) store(new Blob([svgOf(svg)], { type: "image/svg+xml" }), `${file}.svg`);
    },
    PNG: () => {
      const svg = drawing();
      if (svg) void pngOf(svg).then((blob) => store(blob, `${file}.png`));
    },
    CSV: () => store(new Blob([csvOf(numbers)], { type: "text/csv" }), `${file}.csv`),
  };
  return (
    <figure className="figure">
      <figcaption>
        {level === 2 ? <h2>{title}</h2> : <h3>{title}</h3>}
        {note && <p>{note}</p>}
        <div className="files">
          {Object.entries(files).map(([name, save]) => (
            <button
              key={name}
              type="button"
              className="plain"
              aria-label={`${name} of ${title}`}
              onClick={save}
            >
              {name}
            </button>
          ))}
        </div>
      </figcaption>
      <div ref={room} className="drawing">
        {width > 0 && children(width)}
      </div>
      <details>
        <summary>Numbers</summary>
        <NumbersTable title={title} numbers={numbers} />
      </details>
    </figure>
  );
}

const SHOWN_ROWS = 500;

function NumbersTable({ title, numbers }: { readonly title: string; readonly numbers: Numbers }) {
  const rows = numbers.rows.slice(0, SHOWN_ROWS);
  return (
    <div className="numbers">
      <table aria-label={title}>
        <thead>
          <tr>
            {numbers.columns.map((column) => (
              <th key={column} scope="col">
                {column}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((row, place) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: rows of a table that is drawn whole
            <tr key={place}>
              {row.map((value, column) => (
                // biome-ignore lint/suspicious/noArrayIndexKey: columns never move
                <td key={column} className={typeof value === "number" ? "number" : undefined}>
                  {typeof value === "number" ? Number(value.toPrecision(5)) : value}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      {rows.length < numbers.rows.length && (
        <p className="quiet">
          The first {rows.length} of {numbers.rows.length} rows; the CSV has all.
        </p>
      )}
    </div>
  );
}
