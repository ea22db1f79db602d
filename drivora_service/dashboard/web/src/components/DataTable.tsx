import { useVirtualizer } from "@tanstack/react-virtual";
import { type ReactNode, useMemo, useRef, useState } from "react";
import { useKeys } from "../shell/keys";

export interface Column<Row> {
  readonly id: string;
  readonly title: string;
  /** CSS width: `120px`, or `minmax(160px, 1fr)`. */
  readonly width: string;
  readonly numeric?: boolean;
  readonly cell: (row: Row) => ReactNode;
  readonly hint?: string;
  /** How the list is sorted by this column; with `onSort` its header changes that. */
  readonly sorted?: "ascending" | "descending" | undefined;
  readonly onSort?: () => void;
}

export interface DataTableProps<Row> {
  readonly label: string;
  readonly columns: readonly Column<Row>[];
  readonly rows: readonly Row[];
  readonly idOf: (row: Row) => string;
  readonly onOpen?: (row: Row) => void;
  /** Ids of selected rows; without `onSelect` rows cannot be selected. */
  readonly selected?: ReadonlySet<string>;
  readonly onSelect?: (ids: ReadonlySet<string>) => void;
  readonly onCompare?: (ids: readonly string[]) => void;
  /** Called when the end of the loaded rows comes into sight. */
  readonly onEnd?: () => void;
  readonly height?: string;
  /** Called with the row under the pointer or the keyboard, and `undefined` when it is left. */
  readonly onPoint?: (row: Row | undefined, element: HTMLElement | undefined) => void;
  /** Called with the row that `j` and `k` go to. */
  readonly onCurrent?: (row: Row) => void;
  /** Called when the pointer comes over the rows, and when it leaves: rows stay in between. */
  readonly onHold?: (held: boolean) => void;
  /** Ids of rows that the list would not have any more; they are shown dimmed. */
  readonly left?: ReadonlySet<string>;
}

const ROW_PX = 28;
const BEFORE_END = 20;

/** Rows of which only the visible are drawn; `j` `k` move, `enter` opens, `x` selects, `c` compares. */
export function DataTable<Row>(props: DataTableProps<Row>) {
  const { columns, rows, idOf, onOpen, selected, onSelect, onCompare, onEnd } = props;
  const frame = useRef<HTMLDivElement>(null);
  // By its id: rows may be inserted before it.
  const [currentId, setCurrentId] = useState<string>();
  const current = useMemo(
    () => (currentId === undefined ? -1 : rows.findIndex((row) => idOf(row) === currentId)),
    [rows, idOf, currentId],
  );
  const virtual = useVirtualizer({
    count: rows.length,
    getScrollElement: () => frame.current,
    estimateSize: () => ROW_PX,
    overscan: 12,
    onChange: (instance) => {
      const last = instance.getVirtualItems().at(-1);
      if (last && last.index >= rows.length - BEFORE_END) onEnd?.();
    },
  });
  const move = (by: number) => {
    const next = Math.min(Math.max(current + by, 0), rows.length - 1);
    const row = rows[next];
    if (row === undefined) return;
    setCurrentId(idOf(row));
    props.onCurrent?.(row);
    virtual.scrollToIndex(next);
    // `enter` opens the row then, and not the button that was pressed before.
    frame.current?.focus({ preventScroll: true });
    if (props.onPoint)
      requestAnimationFrame(() => {
        const found = frame.current?.querySelector<HTMLElement>(`tr[aria-rowindex="${next + 1}"]`);
        props.onPoint?.(row, found ?? undefined);
      });
  };
  const toggle = (row: Row | undefined) => {
    if (!row || !onSelect) return;
    const next = new Set(selected);
    if (!next.delete(idOf(row))) next.add(idOf(row));
    onSelect(next);
  };
  const open = (row: Row | undefined) => {
    if (row) onOpen?.(row);
  };
  useKeys([
    { keys: "j", does: "next row", run: () => move(1) },
    { keys: "k", does: "previous row", run: () => move(-1) },
    ...(onOpen ? [{ keys: "enter", does: "open the row", run: () => open(rows[current]) }] : []),
    ...(onSelect ? [{ keys: "x", does: "select the row", run: () => toggle(rows[current]) }] : []),
    ...(onCompare
      ? [
          {
            keys: "c",
            does: "compare the selected rows",
            run: () => (selected?.size ?? 0) > 1 && onCompare([...(selected ?? [])]),
          },
        ]
      : []),
  ]);
  const template = [...(onSelect ? ["28px"] : []), ...columns.map(({ width }) => width)].join(" ");
  /** Everything between the last selected row and this one. */
  const lastTicked = useRef<string>(undefined);
  const tick = (index: number, withRange: boolean) => {
    const row = rows[index];
    if (row === undefined || !onSelect) return;
    const last = lastTicked.current;
    const from = last === undefined ? -1 : rows.findIndex((one) => idOf(one) === last);
    lastTicked.current = idOf(row);
    if (!withRange || from < 0) return toggle(row);
    const range = rows.slice(Math.min(from, index), Math.max(from, index) + 1);
    onSelect(new Set([...(selected ?? []), ...range.map(idOf)]));
  };
  return (
    <div
      ref={frame}
      className="table"
      // biome-ignore lint/a11y/noNoninteractiveTabindex: a part that scrolls is reached by keyboard
      tabIndex={0}
      style={{ maxHeight: props.height ?? "72vh" }}
      onPointerEnter={() => props.onHold?.(true)}
      onPointerLeave={() => {
        props.onHold?.(false);
        props.onPoint?.(undefined, undefined);
      }}
    >
      <table
        aria-label={props.label}
        aria-rowcount={rows.length}
        style={{ minWidth: leastWidth(template) }}
      >
        <thead>
          <tr style={{ gridTemplateColumns: template }}>
            {onSelect && (
              <th scope="col" className="tick">
                <span className="hidden-visually">Selected</span>
              </th>
            )}
            {columns.map((column) => (
              <th
                key={column.id}
                scope="col"
                className={column.numeric ? "number" : undefined}
                title={column.hint}
                aria-sort={column.sorted}
              >
                {column.onSort ? (
                  <button type="button" className="plain" onClick={column.onSort}>
                    {column.title}
                    {column.sorted && (column.sorted === "ascending" ? " ↑" : " ↓")}
                  </button>
                ) : (
                  column.title
                )}
              </th>
            ))}
          </tr>
        </thead>
        <tbody style={{ height: virtual.getTotalSize() }}>
          {virtual.getVirtualItems().map(({ index, start }) => {
            const row = rows[index];
            if (row === undefined) return null;
            const id = idOf(row);
            return (
              <tr
                key={id}
                data-id={id}
                data-current={index === current}
                data-opens={onOpen !== undefined}
                data-left={props.left?.has(id)}
                onPointerEnter={(event) => props.onPoint?.(row, event.currentTarget)}
                aria-rowindex={index + 1}
                aria-selected={onSelect ? (selected?.has(id) ?? false) : undefined}
                style={{ gridTemplateColumns: template, transform: `translateY(${start}px)` }}
                onClick={(event) => {
                  setCurrentId(id);
                  if (event.target instanceof Element && event.target.closest("a, button, input"))
                    return;
                  if (onSelect && (event.metaKey || event.ctrlKey)) toggle(row);
                  else open(row);
                }}
              >
                {onSelect && (
                  <td className="tick">
                    <input
                      type="checkbox"
                      aria-label={`Select ${id}`}
                      checked={selected?.has(id) ?? false}
                      onClick={(event) => tick(index, event.shiftKey)}
                      onChange={() => undefined}
                    />
                  </td>
                )}
                {columns.map((column) => (
                  <td key={column.id} className={column.numeric ? "number" : undefined}>
                    {column.cell(row)}
                  </td>
                ))}
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}

/** Returns the width below which the table scrolls: every row has the same columns then. */
export function leastWidth(template: string): number {
  return [...template.matchAll(/(minmax\(\s*)?(\d+)px/g)].reduce(
    (sum, found) => sum + Number(found[2]),
    0,
  );
}
