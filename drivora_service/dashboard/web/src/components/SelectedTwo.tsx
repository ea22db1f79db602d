/** What can be done with the selected rows: two of them are compared. */
export function SelectedTwo({
  number,
  what,
  onCompare,
  onClear,
}: {
  readonly number: number;
  /** What is selected, such as `runs`. */
  readonly what: string;
  readonly onCompare: () => void;
  readonly onClear: () => void;
}) {
  const words =
    number === 0
      ? "Compare selected"
      : number === 2
        ? `Compare 2 ${what}`
        : `${number} selected: choose two to compare`;
  return (
    <>
      <button
        type="button"
        className={number > 0 ? "primary" : undefined}
        disabled={number !== 2}
        title={number === 2 ? "Compare (c)" : `Select two ${what} with x, or with Ctrl and a click`}
        onClick={onCompare}
      >
        {words}
      </button>
      {number > 0 && (
        <button type="button" onClick={onClear} aria-label={`Select no ${what}`}>
          ×
        </button>
      )}
    </>
  );
}
